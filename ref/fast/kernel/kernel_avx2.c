/* The AVX2 traversal: rows of 16 vertices in two registers, the second of which most leaves do not
 * need. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_AVX2
#define KERNEL_TARGET __attribute__((target("avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE        KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/kernel/walk_group.h"
#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi2");
}

const struct fast_kernel fast_avx2 = {"avx2", runs, closest, any_hit, trace_world};

#endif
