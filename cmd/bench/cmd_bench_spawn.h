/* Rays that start on a surface: the results of one block of the benchmark, and functions that print
 * them. For commands only. */
#ifndef CMD_BENCH_SPAWN_H
#define CMD_BENCH_SPAWN_H

#include "cmd/bench/cmd_bench_known.h"
#include "bench/measure/error_measure.h"
#include "bench/measure/spawn.h"

/* The rules that move an origin off the surface, in the order of the table. */
enum spawn_rule {
    RULE_NONE,
    RULE_CONST_5,
    RULE_CONST_4,
    RULE_CONST_3,
    RULE_BOUND,
    RULE_INTEGER,
    RULE_LEAST,
    SPAWN_RULES
};

#define SPAWN_JUDGES 6 /* engines besides the exact answer */

/* Outcomes of the rays of one rule, from the answers of one engine or the oracle. */
struct spawn_count {
    size_t self, beside, skipped;
};

struct spawn_row {
    enum spawn_point point;
    enum spawn_rule rule;
    size_t near;             /* rays with a surface nearer than their origin was moved */
    struct quantiles offset; /* distances of the origins from the exact points */
    struct quantiles steps;  /* only for RULE_LEAST */
    size_t never;            /* RULE_LEAST: rays that no offset frees */
    struct spawn_count exact;
    struct spawn_count engine[SPAWN_JUDGES];
};

/* One scene at one scale and place. */
struct spawn_block {
    const char *scene, *rays;
    double scale, far; /* factor of the size; distance from the origin in sizes */
    uint32_t tri_count;
    size_t ray_count, hit_count;
    size_t undecided; /* hits whose first surface is not known for certain */
    struct spawn_row row[(size_t)SPAWN_POINTS * SPAWN_RULES];
    char judge[SPAWN_JUDGES][40]; /* engine, layout, triangle test */
    size_t judge_count;
};

/* Returns "none", "1e-4", "bound", ... */
const char *spawn_rule_name(enum spawn_rule rule);

/* Prints the block's table and adds its rows to CSV and JSON. */
void spawn_print(struct bench *bench, const struct spawn_block *block);

#endif
