/* Hashes and weights of a trial's numbers; for fuzz/play/trial*.c. */
#ifndef FUZZ_TRIAL_WEIGHT_H
#define FUZZ_TRIAL_WEIGHT_H

#include "ref/base/base.h"

/* FNV-1a of the bytes of a word, the lowest first. */
static inline uint64_t trial_mix_u32(uint64_t hash, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        hash = (hash ^ (word >> (8 * i) & 0xFF)) * 0x100000001B3u;
    return hash;
}

static inline uint64_t trial_mix_float(uint64_t hash, float x)
{
    return trial_mix_u32(hash, float_bits(x));
}

/* 0 for 0, 1 for 1 and -0, 2 for 2, 1.5 and -1: how long its text is. */
uint64_t trial_float_weight(float x);

#endif
