/* raydiff explain of a world: which defect of a tracer gives the engine's answers. Commands only.
 * */
#ifndef CMD_EXPLAIN_WORLD_H
#define CMD_EXPLAIN_WORLD_H

#include "cmd/explain/cmd_explain_inner.h"
#include "ref/explain/world_why.h"

/* An engine's answers to rays in a world, and why they are WRONG. */
struct explain_world {
    const struct explain_options *options;
    struct world *world;         /* borrowed */
    const struct layout *layout; /* of both levels; NULL: the engine has trees of its own */
    struct ray *ray;
    struct ray_mode *mode;
    struct hit *hit;
    uint32_t *tag;
    struct judgement *judgement;
    size_t count;
    struct world_faults faults; /* of the engine's trees, if they are ours */
    struct reason tree_fault;   /* the first of these */
    struct world_why why;
};

/* Traces, judges, explains and prints; *code is the exit code. `trial` has the rays and what they
 * may meet, and world is made of it; NULL: they are made as the options have it. Errors:
 * STATUS_INPUT options that are for scenes; those of world_trees_make, packed_world_make, of the
 * engine; STATUS_MEMORY. */
enum status explain_world(const struct explain_options *options, struct world *world,
                          const struct fuzz_trial *trial, struct pool *pool, int *code,
                          struct reason *reason) MUST_USE;

/* The set of its rays, and their modes; "its own" of a file. */
const char *explain_world_set(const struct explain_world *e);
const char *explain_world_modes(const struct explain_world *e);

/* Writes it as JSON. Errors: as json_write. */
enum status explain_world_json(const struct explain_world *e, int exit_code,
                               struct reason *reason) MUST_USE;

#endif
