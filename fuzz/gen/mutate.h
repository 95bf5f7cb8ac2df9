/* Edits of trials. Each changes one thing; what it makes stays a valid trial (fuzz_trial_check).
 * Bytes are the same on every machine, see fuzz/gen/gen_sketch.h. */
#ifndef FUZZ_MUTATE_H
#define FUZZ_MUTATE_H

#include "fuzz/gen/gen.h"
#include "ref/base/rng.h"

enum edit_part {
    EDIT_SCENE, /* vertices and triangles */
    EDIT_RAYS,
    EDIT_TESTS, /* builder, leaf, tests, query */
    EDIT_PARTS
};

struct edit {
    const char *name;
    enum edit_part part;
    /* *changed: whether any bit of the trial is another one. Errors: STATUS_MEMORY; the trial is
     * then unchanged. */
    enum status (*apply)(struct rng *rng, struct fuzz_trial *trial, bool *changed);
};

extern const struct edit edits[]; /* the last one has no name */

/* Applies a random edit of that part (EDIT_PARTS: of any) that changes something, and appends its
 * name to the recipe; does nothing if 32 tries change nothing (a scene without triangles).
 * Errors: STATUS_MEMORY; the trial is then unchanged. */
enum status mutate_once(struct rng *rng, struct fuzz_trial *trial, enum edit_part part,
                        struct reason *reason) MUST_USE;

#endif
