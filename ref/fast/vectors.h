/* Vectors as gcc and clang have them on every processor, and what needs no more than them. Expects
 * INLINE. */
#ifndef FAST_VECTORS_H
#define FAST_VECTORS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef float float4 __attribute__((vector_size(16)));
typedef float float8 __attribute__((vector_size(32)));
typedef float float16 __attribute__((vector_size(64)));
typedef int32_t int4 __attribute__((vector_size(16)));
typedef int32_t int8 __attribute__((vector_size(32)));
typedef uint16_t short8 __attribute__((vector_size(16)));

INLINE float8 all8(float x)
{
    return (float8){x, x, x, x, x, x, x, x};
}

/* Sorts the children in `mask`, farthest first, by the bits of their entries, which are at least 0;
 * the lowest three bits of a key are the child's number. Returns how many there are. */
INLINE uint32_t push_each(uint32_t *key, uint32_t *ref, const uint32_t *child, uint32_t mask,
                          float8 entry)
{
    uint32_t bits[8], count = 0;
    memcpy(bits, &entry, sizeof bits);
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask), at = count++;
        uint32_t k = (bits[i] & ~7u) | i;
        for (; at > 0 && key[at - 1] < k; at--)
            key[at] = key[at - 1];
        key[at] = k;
    }
    for (uint32_t i = 0; i < count; i++)
        ref[i] = child[key[i] & 7];
    return count;
}

#endif
