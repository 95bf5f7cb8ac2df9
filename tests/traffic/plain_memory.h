/* A second, plain model of the modelled memory, written from its description: lines are searched
 * for in lists, ages are numbers. For tests. */
#ifndef PLAIN_MEMORY_H
#define PLAIN_MEMORY_H

#include "bench/traffic/traffic_memory.h"

struct plain_line {
    uint64_t number; /* of the line, over all arrays */
    uint64_t used;   /* when */
    bool valid, dirty, whole;
};

struct plain_level {
    struct plain_line *line;
    uint64_t bytes;
    uint32_t ways, line_bytes;
};

/* Owns its lines: free with plain_free. */
struct plain_memory {
    struct traffic_memory_size size;
    struct plain_level *level; /* units, then the shared one */
    uint64_t clock;
    uint64_t in[TRAFFIC_LEVELS][TRAFFIC_ARRAYS], out[TRAFFIC_LEVELS][TRAFFIC_ARRAYS];
    uint64_t missed[TRAFFIC_CACHES];
    uint64_t row_hits, row_misses;
    uint64_t row[TRAFFIC_BANKS];
    bool row_open[TRAFFIC_BANKS];
};

struct plain_memory plain_make(const struct traffic_memory_size *size);
void plain_access(struct plain_memory *memory, uint32_t unit, enum traffic_array array,
                  uint64_t offset, uint64_t bytes, bool write);
void plain_flush(struct plain_memory *memory);
void plain_free(struct plain_memory *memory);

#endif
