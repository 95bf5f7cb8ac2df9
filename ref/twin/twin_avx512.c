/* Twins by vectors of 8 doubles. */
#include "ref/base/base.h"

#if defined(__x86_64__)

#define LANES         8
#define VECTOR_BYTES  64
#define KERNEL_TARGET __attribute__((target("avx512f")))
#include "ref/twin/twin_vector.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx512f");
}

const struct twin_kernel twin_avx512 = {"avx512", runs, evaluate_lanes};

#endif
