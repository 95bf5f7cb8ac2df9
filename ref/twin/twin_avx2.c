/* Twins by vectors of 4 doubles. */
#include "ref/base/base.h"

#if defined(__x86_64__)

#define LANES         4
#define VECTOR_BYTES  32
#define KERNEL_TARGET __attribute__((target("avx2")))
#include "ref/twin/twin_vector.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx2");
}

const struct twin_kernel twin_avx2 = {"avx2", runs, evaluate_lanes};

#endif
