/* The portable traversal, on vector types of the compiler: SSE2, NEON or scalar code. */
#define KERNEL_TARGET
#define INLINE static inline __attribute__((always_inline))
#include "ref/fast/vectors.h"
#include "ref/fast/vectors_portable.h"
#include "ref/fast/push.h"
#include "ref/fast/walk_group.h"
#include "ref/fast/walk.h"

static bool runs(void)
{
    return true;
}

const struct fast_kernel fast_portable = {"portable", runs, closest, any_hit, trace_world};
