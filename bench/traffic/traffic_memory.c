#include "bench/traffic/traffic_memory.h"

#include <stdlib.h>
#include <string.h>

#define ARRAY_SHIFT 40

struct traffic_lines {
    uint64_t set_mask;
    uint32_t ways, line_shift;
    uint64_t *tag; /* ways entries a set, the newest first; 0: empty */
};

/* An entry: the number of the line plus 1, and two bits. */
#define DIRTY     1u
#define PARTIAL   2u /* written in part, the rest was never read */
#define LINE_BITS 2

static bool is_power(uint64_t x)
{
    return x > 0 && (x & (x - 1)) == 0;
}

static uint32_t log2_of(uint64_t power)
{
    uint32_t shift = 0;
    while (power >> shift > 1)
        shift++;
    return shift;
}

static enum status check_cache(int level, const struct traffic_cache_size *size,
                               struct reason *reason)
{
    const char *rule = NULL;
    if (!is_power(size->bytes))
        rule = "a size is a power of two";
    else if (!is_power(size->ways))
        rule = "ways are a power of two";
    else if (!is_power(size->line) || size->line < 4)
        rule = "a line is a power of two, 4 bytes or more";
    else if (size->bytes < size->line)
        rule = "a cache is not smaller than a line";
    else if (size->bytes / size->line < size->ways)
        rule = "a cache is not smaller than its ways of lines";
    if (!rule)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "level %d of %llu bytes, %u ways, lines of %u: %s", level + 1,
                (unsigned long long)size->bytes, size->ways, size->line, rule);
}

enum status traffic_memory_check(const struct traffic_memory_size *size, struct reason *reason)
{
    for (int level = 0; level < TRAFFIC_CACHES; level++) {
        enum status status = check_cache(level, &size->cache[level], reason);
        if (status)
            return status;
    }
    if (size->units == 0)
        return fail(reason, STATUS_INPUT, "there is at least one unit");
    if (!is_power(size->row_bytes) || size->row_bytes < TRAFFIC_BURST)
        return fail(reason, STATUS_INPUT, "rows of %u bytes: a row is a power of two, %u or more",
                    size->row_bytes, TRAFFIC_BURST);
    return STATUS_OK;
}

enum status traffic_memory_make(const struct traffic_memory_size *size, struct traffic_memory *out,
                                struct reason *reason)
{
    *out = (struct traffic_memory){.size = *size};
    enum status status = traffic_memory_check(size, reason);
    if (status)
        return status;
    out->cache = alloc_zeroed((size_t)size->units + 1, sizeof *out->cache);
    for (uint32_t i = 0; out->cache && i <= size->units && !status; i++) {
        const struct traffic_cache_size *of = &size->cache[i == size->units];
        struct traffic_lines *c = &out->cache[i];
        c->line_shift = log2_of(of->line);
        c->ways = of->ways;
        c->set_mask = of->bytes / of->line / of->ways - 1;
        c->tag = alloc_zeroed((size_t)(of->bytes / of->line), sizeof *c->tag);
        status = c->tag ? STATUS_OK : STATUS_MEMORY;
    }
    if (out->cache && !status)
        return STATUS_OK;
    traffic_memory_free(out);
    return fail(reason, STATUS_MEMORY, "no memory for the caches of %u units", size->units);
}

void traffic_memory_free(struct traffic_memory *memory)
{
    for (uint32_t i = 0; memory->cache && i <= memory->size.units; i++)
        free(memory->cache[i].tag);
    free(memory->cache);
    for (int i = 0; i < 4; i++)
        free(memory->seen[i]);
    *memory = (struct traffic_memory){.failed = false};
}

enum traffic_cause traffic_cause_of(enum traffic_array array)
{
    static const enum traffic_cause cause[TRAFFIC_ARRAYS] = {
        [TRAFFIC_AT_NODES] = TRAFFIC_NODES,       [TRAFFIC_AT_ITEMS] = TRAFFIC_TRIANGLES,
        [TRAFFIC_AT_INDICES] = TRAFFIC_TRIANGLES, [TRAFFIC_AT_VERTICES] = TRAFFIC_TRIANGLES,
        [TRAFFIC_AT_STACKS] = TRAFFIC_STACK,      [TRAFFIC_AT_RAYS] = TRAFFIC_RAYS,
        [TRAFFIC_AT_QUEUES] = TRAFFIC_RAYS,       [TRAFFIC_AT_HITS] = TRAFFIC_HITS,
    };
    return cause[array];
}

static inline enum traffic_array array_at(uint64_t address)
{
    return (enum traffic_array)((address >> ARRAY_SHIFT) - 1);
}

/* Bytes from `start` on that arrive at a level. */
static inline void arrive(struct traffic_memory *memory, enum traffic_level level, uint64_t start,
                          uint64_t bytes, bool write)
{
    struct traffic_count *count = &memory->count[level];
    enum traffic_cause cause = traffic_cause_of(array_at(start));
    if (write) {
        count->out[cause] += bytes;
        count->written += bytes;
    } else {
        count->in[cause] += bytes;
        count->read += bytes;
    }
}

/* --- DRAM ------------------------------------------------------------------------------------- */

/* Remembers a burst of the scene's arrays. */
static void see(struct traffic_memory *memory, uint64_t burst)
{
    enum traffic_array array = array_at(burst * TRAFFIC_BURST);
    if (array >= 4)
        return;
    uint64_t at = burst & (((uint64_t)1 << ARRAY_SHIFT) / TRAFFIC_BURST - 1);
    size_t byte = (size_t)(at >> 3);
    if (byte >= memory->seen_bytes[array]) {
        size_t bytes = memory->seen_bytes[array] ? memory->seen_bytes[array] : 4096;
        while (bytes <= byte)
            bytes *= 2;
        uint8_t *grown = realloc(memory->seen[array], bytes);
        if (!grown) {
            memory->failed = true;
            return;
        }
        memset(grown + memory->seen_bytes[array], 0, bytes - memory->seen_bytes[array]);
        memory->seen[array] = grown;
        memory->seen_bytes[array] = bytes;
    }
    uint8_t bit = (uint8_t)(1u << (at & 7));
    if (!(memory->seen[array][byte] & bit)) {
        memory->seen[array][byte] |= bit;
        memory->distinct++;
    }
}

static void dram(struct traffic_memory *memory, uint64_t start, uint64_t end, bool write)
{
    uint64_t last = (end - 1) / TRAFFIC_BURST;
    for (uint64_t burst = start / TRAFFIC_BURST; burst <= last; burst++) {
        uint64_t row = burst / (memory->size.row_bytes / TRAFFIC_BURST);
        uint64_t *open = &memory->open_row[row % TRAFFIC_BANKS];
        arrive(memory, TRAFFIC_DRAM, burst * TRAFFIC_BURST, TRAFFIC_BURST, write);
        if (*open == row + 1)
            memory->row_hits++;
        else
            memory->row_misses++;
        *open = row + 1;
        if (!write)
            see(memory, burst);
    }
}

/* --- caches ----------------------------------------------------------------------------------- */

/* Makes a line the newest of its set. Returns whether it was there with all that is wanted; else
 * *victim is the entry that fell out, if any. `whole`: all of it is written. */
static inline bool look(struct traffic_lines *cache, uint64_t line, bool write, bool whole,
                        uint64_t *victim)
{
    uint64_t *set = cache->tag + (line & cache->set_mask) * cache->ways;
    uint64_t wanted = line + 1;
    uint32_t at = 0;
    while (at < cache->ways && set[at] >> LINE_BITS != wanted)
        at++;
    bool found = at < cache->ways;
    if (!found)
        at = cache->ways - 1;
    uint64_t old = set[at], bits = found ? old & (DIRTY | PARTIAL) : write ? PARTIAL : 0;
    *victim = found ? 0 : old;
    found = found && (write || !(bits & PARTIAL));
    if (!write || whole)
        bits &= ~(uint64_t)PARTIAL;
    memmove(set + 1, set, at * sizeof *set);
    set[0] = wanted << LINE_BITS | bits | (write ? DIRTY : 0);
    return found;
}

static void level_access(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                         uint64_t start, uint64_t end, bool write);

static void next_access(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                        uint64_t start, uint64_t end, bool write)
{
    if (level + 1 == TRAFFIC_DRAM) {
        dram(memory, start, end, write);
        return;
    }
    arrive(memory, level + 1, start, end - start, write);
    level_access(memory, unit, level + 1, start, end, write);
}

static void drop(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                 const struct traffic_lines *cache, uint64_t entry)
{
    if (entry & DIRTY) {
        uint64_t line = (entry >> LINE_BITS) - 1;
        next_access(memory, unit, level, line << cache->line_shift, (line + 1) << cache->line_shift,
                    true);
    }
}

static void level_access(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                         uint64_t start, uint64_t end, bool write)
{
    struct traffic_lines *cache = &memory->cache[level == TRAFFIC_L1 ? unit : memory->size.units];
    uint64_t last = (end - 1) >> cache->line_shift;
    for (uint64_t line = start >> cache->line_shift; line <= last; line++) {
        uint64_t victim, from = line << cache->line_shift, to = (line + 1) << cache->line_shift;
        memory->count[level].lookups++;
        if (look(cache, line, write, start <= from && end >= to, &victim))
            continue;
        memory->count[level].misses++;
        drop(memory, unit, level, cache, victim);
        if (!write)
            next_access(memory, unit, level, from, to, false);
    }
}

void traffic_access(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                    enum traffic_array array, uint64_t offset, uint64_t bytes, bool write)
{
    uint64_t start = ((uint64_t)(array + 1) << ARRAY_SHIFT) + offset;
    if (bytes == 0)
        return;
    if (level == TRAFFIC_DRAM) {
        dram(memory, start, start + bytes, write);
        return;
    }
    arrive(memory, level, start, bytes, write);
    level_access(memory, unit, level, start, start + bytes, write);
}

void traffic_on_chip(struct traffic_memory *memory, enum traffic_array array, uint64_t bytes,
                     bool write)
{
    arrive(memory, TRAFFIC_L1, (uint64_t)(array + 1) << ARRAY_SHIFT, bytes, write);
}

void traffic_flush(struct traffic_memory *memory)
{
    for (uint32_t i = 0; i <= memory->size.units; i++) {
        struct traffic_lines *c = &memory->cache[i];
        enum traffic_level level = i == memory->size.units ? TRAFFIC_L2 : TRAFFIC_L1;
        for (uint64_t at = 0; at < (c->set_mask + 1) * c->ways; at++) {
            drop(memory, i, level, c, c->tag[at]);
            c->tag[at] = 0;
        }
    }
}

bool traffic_conserved(const struct traffic_memory *memory, bool cached)
{
    for (int level = 0; level < TRAFFIC_LEVELS; level++) {
        const struct traffic_count *count = &memory->count[level];
        uint64_t in = 0, out = 0;
        for (int cause = 0; cause < TRAFFIC_CAUSES; cause++) {
            in += count->in[cause];
            out += count->out[cause];
        }
        if (in != count->read || out != count->written)
            return false;
    }
    const struct traffic_count *second = &memory->count[TRAFFIC_L2];
    const struct traffic_count *dram_is = &memory->count[TRAFFIC_DRAM];
    uint32_t line = memory->size.cache[0].line;
    if (cached && (second->read % line || second->written % line ||
                   second->read > memory->count[TRAFFIC_L1].misses * line ||
                   second->written > memory->count[TRAFFIC_L1].misses * line))
        return false;
    return dram_is->read + dram_is->written ==
           (memory->row_hits + memory->row_misses) * TRAFFIC_BURST;
}
