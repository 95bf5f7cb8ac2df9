/* Sorts children in scalar code, for kernels that cannot sort lanes. Expects INLINE and
 * ref/fast/kernel/vectors.h. */
#ifndef FAST_PUSH_H
#define FAST_PUSH_H

/* Sorts the children in `mask`, farthest first, by the bits of their entry distances, which are at
 * least 0. The lowest three bits of a key are replaced with the child's index. Returns their
 * number. */
INLINE uint32_t push(uint32_t *key, uint32_t *ref, const uint32_t *child, uint32_t mask,
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

/* Writes all children in `mask` except the last, in order. Returns their number. */
INLINE uint32_t push_any(uint32_t *ref, const uint32_t *child, uint32_t mask)
{
    uint32_t count = 0;
    for (; mask & (mask - 1); mask &= mask - 1)
        ref[count++] = child[__builtin_ctz(mask)];
    return count;
}

#endif
