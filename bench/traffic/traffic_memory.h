/* The memory of a modelled machine: two levels of caches and DRAM, which count bytes by what they
 * are for. Nothing is timed.
 *
 * Level 1 is private to a unit, level 2 is shared by all. Both are set-associative, replace the
 * least recently used line of a set, are written back, and allocate a line on a write, which is not
 * read then: a line that was written in part is read when something is read from it. A line that is
 * missing is read from the next level. A dirty line that is replaced is written to the next level,
 * as a whole. DRAM moves bursts of 64 bytes and has 16 banks, each with one open row. */
#ifndef TRAFFIC_MEMORY_H
#define TRAFFIC_MEMORY_H

#include "ref/base/base.h"

#define TRAFFIC_CACHES 2
#define TRAFFIC_BURST  64u
#define TRAFFIC_BANKS  16u

/* What bytes are for. */
enum traffic_cause {
    TRAFFIC_NODES,
    TRAFFIC_TRIANGLES, /* items, indices and vertices, or what a storage has instead */
    TRAFFIC_STACK,     /* or the trail */
    TRAFFIC_RAYS,      /* rays and their queues */
    TRAFFIC_HITS,      /* hit records */
    TRAFFIC_CAUSES
};

/* Arrays in memory. The first four are those of enum touch_array. */
enum traffic_array {
    TRAFFIC_AT_NODES,
    TRAFFIC_AT_ITEMS,
    TRAFFIC_AT_INDICES,
    TRAFFIC_AT_VERTICES,
    TRAFFIC_AT_STACKS,
    TRAFFIC_AT_RAYS,
    TRAFFIC_AT_QUEUES,
    TRAFFIC_AT_HITS,
    TRAFFIC_ARRAYS
};

enum traffic_level { TRAFFIC_L1, TRAFFIC_L2, TRAFFIC_DRAM, TRAFFIC_LEVELS };

/* All three are powers of two, line at least 4 and ways * line at most bytes. */
struct traffic_cache_size {
    uint64_t bytes;
    uint32_t ways, line;
};

struct traffic_memory_size {
    struct traffic_cache_size cache[TRAFFIC_CACHES];
    uint32_t units;     /* 1 or more; each has a level 1 */
    uint32_t row_bytes; /* of DRAM: a power of two, at least TRAFFIC_BURST */
};

/* Bytes that arrive at a level: at level 1 those of the accesses, at level 2 lines of level 1, at
 * DRAM bursts. `read` and `written` are their sums, counted apart. */
struct traffic_count {
    uint64_t in[TRAFFIC_CAUSES];  /* read */
    uint64_t out[TRAFFIC_CAUSES]; /* written */
    uint64_t read, written;
    uint64_t lookups, misses; /* lines, of caches */
};

struct traffic_lines; /* a cache */

/* Owns its caches: free with traffic_memory_free. */
struct traffic_memory {
    struct traffic_memory_size size;
    struct traffic_lines *cache; /* `units` of level 1, then level 2 */
    struct traffic_count count[TRAFFIC_LEVELS];
    uint64_t open_row[TRAFFIC_BANKS]; /* plus 1; 0: none */
    uint64_t row_hits, row_misses;    /* bursts */
    uint8_t *seen[4];                 /* a bit for each burst of the first four arrays */
    size_t seen_bytes[4];
    uint64_t distinct; /* bursts of these that were read from DRAM at least once */
    bool failed;       /* no memory for `seen` */
};

/* Returns STATUS_OK, or STATUS_INPUT with the rule that a size breaks: the first of level 1, level
 * 2, units and rows. */
enum status traffic_memory_check(const struct traffic_memory_size *size,
                                 struct reason *reason) MUST_USE;

/* Makes an empty memory. Errors: as traffic_memory_check; STATUS_MEMORY. */
enum status traffic_memory_make(const struct traffic_memory_size *size, struct traffic_memory *out,
                                struct reason *reason) MUST_USE;

void traffic_memory_free(struct traffic_memory *memory);

/* Returns what the bytes of an array are for. */
enum traffic_cause traffic_cause_of(enum traffic_array array);

/* Reads or writes `bytes` bytes from `offset` of an array, by `unit`, beginning at a level: behind
 * TRAFFIC_L1 an access passes the caches before it. 0 bytes are nothing. */
void traffic_access(struct traffic_memory *memory, uint32_t unit, enum traffic_level level,
                    enum traffic_array array, uint64_t offset, uint64_t bytes, bool write);

/* Counts bytes at level 1 that are in a buffer of the unit, and nowhere else. */
void traffic_on_chip(struct traffic_memory *memory, enum traffic_array array, uint64_t bytes,
                     bool write);

/* Writes all dirty lines back and empties the caches. */
void traffic_flush(struct traffic_memory *memory);

/* Bytes of scene data, in bursts, that were read at least once. */
static inline uint64_t traffic_working_set(const struct traffic_memory *memory)
{
    return memory->distinct * TRAFFIC_BURST;
}

/* Returns true if at each level the bytes by cause add up to all bytes, what level 2 receives is
 * whole lines, and what DRAM receives is whole bursts, each a row hit or a miss. `cached`: each
 * access began at level 1, so that level 2 received what level 1 missed. */
bool traffic_conserved(const struct traffic_memory *memory, bool cached);

#endif
