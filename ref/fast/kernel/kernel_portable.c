/* The portable traversal, on vector types of the compiler: SSE2, NEON or scalar code. */
#define KERNEL_TARGET
#define INLINE static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_portable.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/kernel/walk_group.h"
#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return true;
}

const struct fast_kernel fast_portable = {"portable", runs, closest, any_hit, trace_world};
