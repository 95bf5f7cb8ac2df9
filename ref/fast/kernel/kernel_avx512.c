/* The AVX-512 traversal: rows of 16 vertices in one register, and children sorted in one. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define KERNEL_TARGET                                                                              \
    __attribute__((target("avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define FAST_PACKETS
#define INLINE KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/vectors_avx512.h"
#include "ref/fast/kernel/walk_group.h"
#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
}

const struct fast_kernel fast_avx512 = {"avx512", runs, closest, any_hit, trace_world};

#endif
