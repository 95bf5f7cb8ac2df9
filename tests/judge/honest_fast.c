/* The tests of honest_mt.h with -ffast-math and, where the processor has them, fused operations. */
#include "tests/judge/honest_mt.h"

const struct honest honest_fast[HONEST_FAST] = {{"mt fast", mt_by_division},
                                                {"mt fast by reciprocal", mt_by_reciprocal}};

bool honest_fast_runs(void)
{
#if defined(__x86_64__) && defined(__FMA__)
    return __builtin_cpu_supports("fma") != 0;
#else
    return true;
#endif
}
