#include "bench/measure/cache_sim.h"

#include <stdlib.h>
#include <string.h>

const struct cache_size cache_sim_usual[CACHE_SIM_LEVELS] = {{64, 12}, {1024, 16}};

enum status cache_sim_make(const struct cache_size size[CACHE_SIM_LEVELS], struct cache_sim *out,
                           struct reason *reason)
{
    *out = (struct cache_sim){.counts = {0}};
    for (int level = 0; level < CACHE_SIM_LEVELS; level++) {
        uint32_t sets = size[level].sets, ways = size[level].ways;
        if (sets == 0 || (sets & (sets - 1)) || ways == 0) {
            cache_sim_free(out);
            return fail(reason, STATUS_INPUT, "cache of %u sets and %u ways: sets are a power of 2",
                        sets, ways);
        }
        out->size[level] = size[level];
        out->tag[level] = alloc_zeroed((size_t)sets * ways, sizeof *out->tag[level]);
        if (!out->tag[level]) {
            cache_sim_free(out);
            return fail(reason, STATUS_MEMORY, "no memory for a cache of %u sets", sets);
        }
    }
    return STATUS_OK;
}

/* Looks up a line in a level and makes it the newest of its set. */
static bool find(struct cache_sim *cache, int level, uint64_t line)
{
    uint32_t ways = cache->size[level].ways;
    uint64_t *set = cache->tag[level] + (line & (cache->size[level].sets - 1)) * ways;
    uint32_t at = 0;
    while (at < ways && set[at] != line + 1)
        at++;
    bool found = at < ways;
    memmove(set + 1, set, (found ? at : ways - 1) * sizeof *set);
    set[0] = line + 1;
    return found;
}

void cache_sim_read(struct cache_sim *cache, uint64_t address, uint64_t bytes)
{
    if (bytes == 0)
        return;
    uint64_t last = (address + bytes - 1) / CACHE_SIM_LINE;
    for (uint64_t line = address / CACHE_SIM_LINE; line <= last; line++) {
        cache->counts.lines++;
        for (int level = 0; level < CACHE_SIM_LEVELS && !find(cache, level, line); level++)
            cache->counts.beyond[level]++;
    }
}

void cache_sim_restart(struct cache_sim *cache)
{
    cache->counts = (struct cache_counts){0};
}

void cache_sim_free(struct cache_sim *cache)
{
    for (int level = 0; level < CACHE_SIM_LEVELS; level++)
        free(cache->tag[level]);
    *cache = (struct cache_sim){.counts = {0}};
}
