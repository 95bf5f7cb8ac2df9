/* The portable traversal of tiny trees. */
#define FAST_TINY
#define KERNEL_TARGET
#define INLINE static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_portable.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/tiny_block.h"
#include "ref/fast/kernel/walk_group.h"

/* 15 bits in each lane, and others above them. */
INLINE void triplets(const char *from, group_codes c[3])
{
    for (uint32_t i = 0; i < GROUP; i++) {
        uint32_t all = 0;
        memcpy(&all, from + TINY_CORNERS * i / 8, 3);
        c[0][i] = (int32_t)(all >> TINY_CORNERS * i % 8);
    }
    c[1] = c[0] >> 5;
    c[2] = c[0] >> 10;
}

INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
{
    float v[16];
    float16 out;
    for (uint32_t i = 0; i < 16; i++)
        v[i] = (float)(int32_t)(more + block_bits(block, first + width * i, width));
    memcpy(&out, v, sizeof out);
    return out;
}

INLINE group corners32(const float16 half[2], group_codes code, uint32_t count)
{
    const group low = group_corners(half[0], code, count);
    const group high = group_corners(half[1], code, count);
    const int8 second = (code & 16) != 0;
    return SELECT(float8, int8, second, high, low);
}

#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return true;
}

const struct fast_kernel fast_tiny_portable = {"portable", runs, closest, any_hit, NULL};
