#include "ref/build/keys.h"

#include "ref/build/room.h"

#include <string.h>

#define DIGIT_BITS 11u
#define DIGITS     (1u << DIGIT_BITS)

/* Destination of each thread's digits: place[thread][digit], first counts, then positions. */
static void places_sum(uint32_t *place, uint32_t threads)
{
    uint32_t sum = 0;
    for (uint32_t d = 0; d < DIGITS; d++)
        for (uint32_t t = 0; t < threads; t++) {
            size_t at = (size_t)t * DIGITS + d;
            uint32_t n = place[at];
            place[at] = sum;
            sum += n;
        }
}

/* One stable pass, so that the result does not depend on the number of threads. */
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

enum status keys_sort(uint64_t **key, uint32_t count, uint32_t first_bit, uint32_t threads)
{
    uint64_t *spare = room_make(count, sizeof *spare);
    uint32_t *place = room_make((size_t)threads * DIGITS, sizeof *place);
    bool enough = spare && place;
    for (uint32_t shift = first_bit; shift < 64 && enough; shift += DIGIT_BITS) {
        sort_digit(*key, spare, count, shift, threads, place);
        uint64_t *swap = *key;
        *key = spare;
        spare = swap;
    }
    room_free(spare);
    room_free(place);
    return enough ? STATUS_OK : STATUS_MEMORY;
}
