/* The portable traversal of small trees. */
#define FAST_SMALL
#define KERNEL_TARGET
#define INLINE static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_portable.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/small_block.h"
#include "ref/fast/kernel/walk_group.h"

/* Words of eight codes each, as leaves of up to 8 triangles have them. */
INLINE void triplets(const uint32_t *from, group_codes c[3])
{
    c[0] = c[1] = c[2] = 0;
    for (uint32_t i = 0; i < GROUP; i++) {
        const uint32_t all = block_bits(from, SMALL_CORNERS * i, SMALL_CORNERS);
        for (uint32_t k = 0; k < 3; k++)
            c[k] |= (all >> 4 * k & 15u) << 4 * i;
    }
}

INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t least,
                        uint32_t count)
{
    uint32_t v[16] = {0};
    float16 out;
    for (uint32_t i = 0; i < count; i++)
        v[i] = small_order(least + block_bits(block, first + width * i, width));
    memcpy(&out, v, sizeof out);
    return out;
}

#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return true;
}

const struct fast_kernel fast_small_portable = {"portable", runs, closest, any_hit, NULL};
