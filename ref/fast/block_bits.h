/* Numbers of up to 32 bits in the words of small and tiny blocks, lowest bits first. As kernels do,
 * a reader may read a word beyond the number, which a tree has behind its last block. */
#ifndef BLOCK_BITS_H
#define BLOCK_BITS_H

#include <stdint.h>

/* The low bits of a word, 0 to 32 of them. */
static inline uint32_t low_bits(uint32_t width)
{
    return (uint32_t)((UINT64_C(1) << width) - 1);
}

/* Bits that numbers up to `most` take: 0 to 32. */
static inline uint32_t width_for(uint32_t most)
{
    uint32_t width = 0;
    while (width < 32 && most >> width)
        width++;
    return width;
}

/* Up to 32 bits from a bit on. Reads the word that has the first bit, and the next one. */
static inline uint32_t block_bits(const uint32_t *word, uint32_t first, uint32_t width)
{
    const uint32_t *at = word + (first >> 5);
    const uint64_t both = at[0] | (uint64_t)at[1] << 32;
    return (uint32_t)(both >> (first & 31u)) & low_bits(width);
}

/* Adds bits at a place in words that are zero, and moves it behind them. */
static inline void block_add_bits(uint32_t *word, uint32_t *first, uint32_t bits, uint32_t width)
{
    const uint64_t both = (uint64_t)bits << (*first & 31u);
    if ((uint32_t)both)
        word[*first >> 5] |= (uint32_t)both;
    if (both >> 32)
        word[(*first >> 5) + 1] |= (uint32_t)(both >> 32);
    *first += width;
}

#endif
