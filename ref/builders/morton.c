#include "ref/builders/morton.h"

#include "ref/builders/grow.h"
#include "ref/builders/room.h"

#include <omp.h>
#include <string.h>

#define DIGIT_BITS 11u
#define DIGITS     (1u << DIGIT_BITS)

/* Bit i to bit 3 i, of 21. */
static uint64_t spread(uint32_t x)
{
    uint64_t v = x & 0x1FFFFFu;
    v = (v | v << 32) & 0x001F00000000FFFFu;
    v = (v | v << 16) & 0x001F0000FF0000FFu;
    v = (v | v << 8) & 0x100F00F00F00F00Fu;
    v = (v | v << 4) & 0x10C30C30C30C30C3u;
    return (v | v << 2) & 0x1249249249249249u;
}

static void codes_make(const struct ref *ref, uint32_t count, const struct lane_box *centres,
                       uint32_t threads, uint64_t *key, uint32_t index_bits)
{
    uint32_t axis_bits = (64 - index_bits) / 3 < 21 ? (64 - index_bits) / 3 : 21;
    lanes extent = centres->hi - centres->lo;
    float most = extent[0] > extent[1] ? extent[0] : extent[1];
    most = most > extent[2] ? most : extent[2];
    /* Cubes, not boxes of the scene's shape: they split the longest side first. */
    lanes scale = lanes_all(most > 1e-30f ? (float)(1u << axis_bits) / most : 0);
    lanes last = lanes_all((float)((1u << axis_bits) - 1));
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++) {
        lanes at = lanes_min((ref_centre(&ref[i]) - centres->lo) * scale, last);
        at[3] = 0;
        lanes_int cell = lanes_to_int(at);
        uint64_t code = spread((uint32_t)cell[0]) << 2 | spread((uint32_t)cell[1]) << 1 |
                        spread((uint32_t)cell[2]);
        key[i] = code << index_bits | i;
    }
}

/* Where each thread puts each digit: place[thread][digit], first counted, then summed. */
static void places_sum(uint32_t *place, uint32_t threads)
{
    uint32_t sum = 0;
    for (uint32_t d = 0; d < DIGITS; d++)
        for (uint32_t t = 0; t < threads; t++) {
            uint32_t n = place[(size_t)t * DIGITS + d];
            place[(size_t)t * DIGITS + d] = sum;
            sum += n;
        }
}

/* One pass, stable, so that the result is the same however many threads share it. */
static void sort_digit(const uint64_t *from, uint64_t *to, uint32_t count, uint32_t shift,
                       uint32_t threads, uint32_t *place)
{
    memset(place, 0, (size_t)threads * DIGITS * sizeof *place);
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
    for (uint32_t t = 0; t < threads; t++) {
        uint32_t *mine = place + (size_t)t * DIGITS;
        uint32_t end = (uint32_t)((uint64_t)count * (t + 1) / threads);
        for (uint32_t i = (uint32_t)((uint64_t)count * t / threads); i < end; i++)
            mine[from[i] >> shift & (DIGITS - 1)]++;
    }
    places_sum(place, threads);
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
    for (uint32_t t = 0; t < threads; t++) {
        uint32_t *mine = place + (size_t)t * DIGITS;
        uint32_t end = (uint32_t)((uint64_t)count * (t + 1) / threads);
        for (uint32_t i = (uint32_t)((uint64_t)count * t / threads); i < end; i++)
            to[mine[from[i] >> shift & (DIGITS - 1)]++] = from[i];
    }
}

enum status morton_order(const struct ref *ref, uint32_t count, const struct lane_box *centres,
                         uint32_t threads, uint64_t **out, uint32_t *index_bits)
{
    *index_bits = log2_ceil(count);
    uint64_t *key = room_make(count, sizeof *key), *spare = room_make(count, sizeof *spare);
    uint32_t *place = room_make((size_t)threads * DIGITS, sizeof *place);
    bool enough = key && spare && place;
    *out = NULL;
    if (enough) {
        codes_make(ref, count, centres, threads, key, *index_bits);
        /* The keys are in the order of their indices, which a stable sort keeps. */
        for (uint32_t shift = *index_bits; shift < 64; shift += DIGIT_BITS) {
            sort_digit(key, spare, count, shift, threads, place);
            uint64_t *swap = key;
            key = spare;
            spare = swap;
        }
        *out = key;
        key = NULL;
    }
    room_free(key);
    room_free(spare);
    room_free(place);
    return enough ? STATUS_OK : STATUS_MEMORY;
}
