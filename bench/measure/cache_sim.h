/* A simulated cache: two levels of lines of 64 bytes, each set-associative, the least recently used
 * line of a set replaced; only reads. A line that is not in level 1 is read from level 2, which
 * keeps its own (neither inclusive nor exclusive by force: a line dropped by level 2 may stay in
 * level 1). Nothing is fetched ahead. */
#ifndef CACHE_SIM_H
#define CACHE_SIM_H

#include "ref/base/base.h"

#define CACHE_SIM_LINE   64u
#define CACHE_SIM_LEVELS 2

/* Sizes of a level: bytes = sets * ways * CACHE_SIM_LINE, sets a power of two. */
struct cache_size {
    uint32_t sets, ways;
};

struct cache_counts {
    uint64_t lines;                    /* looked for: one for each line that a read touches */
    uint64_t beyond[CACHE_SIM_LEVELS]; /* of them not found in levels up to this */
};

/* Owns its tags (see cache_sim_free). */
struct cache_sim {
    struct cache_size size[CACHE_SIM_LEVELS];
    uint64_t
        *tag[CACHE_SIM_LEVELS]; /* sets * ways lines plus 1, 0: empty; the newest of a set first */
    struct cache_counts counts;
};

/* 48 KiB of 12 ways and 1 MiB of 16: a core of a processor of these years. */
extern const struct cache_size cache_sim_usual[CACHE_SIM_LEVELS];

/* An empty one. Errors: STATUS_INPUT sets are no power of two, or ways are 0; STATUS_MEMORY. On
 * error *out is zero. */
enum status cache_sim_make(const struct cache_size size[CACHE_SIM_LEVELS], struct cache_sim *out,
                           struct reason *reason) MUST_USE;

/* Reads `bytes` bytes at `address`; 0 bytes touch nothing. */
void cache_sim_read(struct cache_sim *cache, uint64_t address, uint64_t bytes);

/* Counts from 0 again; the lines stay. */
void cache_sim_restart(struct cache_sim *cache);

void cache_sim_free(struct cache_sim *cache);

#endif
