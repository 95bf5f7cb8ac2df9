/* A simulated cache for reads: two set-associative levels with lines of 64 bytes, which replace the
 * least recently used line of a set. A line missing in level 1 is read from level 2, which keeps
 * its own lines. The levels are neither inclusive nor exclusive by force: a line dropped by level 2
 * may stay in level 1. There is no prefetching. */
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
    uint64_t lines;                    /* lookups: one per line that a read touches */
    uint64_t beyond[CACHE_SIM_LEVELS]; /* lookups that miss in all levels up to this one */
};

/* Owns its tags: free with cache_sim_free. */
struct cache_sim {
    struct cache_size size[CACHE_SIM_LEVELS];
    /* sets * ways entries of line number plus 1; 0: empty. The newest of a set is first. */
    uint64_t *tag[CACHE_SIM_LEVELS];
    struct cache_counts counts;
};

/* 48 KiB with 12 ways and 1 MiB with 16 ways, as in a core of a current processor. */
extern const struct cache_size cache_sim_usual[CACHE_SIM_LEVELS];

/* Makes an empty cache. Errors: STATUS_INPUT sets is no power of two, or ways is 0; STATUS_MEMORY.
 * On error *out is zero. */
enum status cache_sim_make(const struct cache_size size[CACHE_SIM_LEVELS], struct cache_sim *out,
                           struct reason *reason) MUST_USE;

/* Reads `bytes` bytes at `address`; 0 bytes touch no line. */
void cache_sim_read(struct cache_sim *cache, uint64_t address, uint64_t bytes);

/* Resets the counters; the lines stay. */
void cache_sim_restart(struct cache_sim *cache);

void cache_sim_free(struct cache_sim *cache);

#endif
