/* Numbers of any width up to 32 in words, the lowest bit first. */
#ifndef BITS_H
#define BITS_H

#include <stdint.h>

/* Reads `width` bits from bit `at` on; `word` must extend to bit at + width. Without width no word
 * is read: there may be none. */
static inline uint32_t bits_get(const uint32_t *word, uint32_t at, uint32_t width)
{
    if (width == 0)
        return 0;
    const uint32_t *from = word + at / 32, shift = at % 32;
    uint32_t value = from[0] >> shift;
    if (shift + width > 32)
        value |= from[1] << (32 - shift);
    return value & (0xFFFFFFFFu >> (32 - width));
}

/* Writes bits that were 0; as above. */
static inline void bits_put(uint32_t *word, uint32_t at, uint32_t width, uint32_t value)
{
    if (width == 0)
        return;
    uint32_t *to = word + at / 32, shift = at % 32;
    to[0] |= value << shift;
    if (shift + width > 32)
        to[1] |= value >> (32 - shift);
}

/* Returns the number of bits needed for `value`. */
static inline uint32_t bits_of(uint32_t value)
{
    uint32_t width = 0;
    while (value >> width)
        width++;
    return width;
}

#endif
