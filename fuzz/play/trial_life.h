/* A trial with steps: its scenes, its trees, and the trial that ends after one of its steps. */
#ifndef FUZZ_TRIAL_LIFE_H
#define FUZZ_TRIAL_LIFE_H

#include "fuzz/play/trial.h"

struct engine; /* ref/engine.h */
struct job;    /* likewise */

/* The scenes of a trial's life; zero of a world's (fuzz/play/trial_world_life.h). Their triangles
 * are the trial's. */
struct trial_life {
    struct scene scene[LIFE_STEPS_MOST + 1]; /* as built, and after each step */
    uint32_t count;                          /* of steps; 0: nothing is made */
};

/* Errors: STATUS_MEMORY; *out is zero then. */
enum status trial_life_make(const struct fuzz_trial *trial, struct trial_life *out,
                            struct reason *reason) MUST_USE;
void trial_life_free(struct trial_life *life); /* a zero one is fine */

/* Builds, refits and builds again: tree[i] is the tree after step i, of life->count + 1. Errors: as
 * life_begin and life_step; nothing is to be freed then. */
enum status trial_life_trees(const struct fuzz_trial *trial, const struct trial_life *life,
                             const struct layout *layout, struct life_tree *tree,
                             struct reason *reason) MUST_USE;

/* The trial that ends after step `step`, 0 to trial->step_count: its scene is the one traced then,
 * and it has so many steps. Errors: STATUS_MEMORY. */
enum status trial_life_cut(const struct fuzz_trial *trial, uint32_t step, struct fuzz_trial *out,
                           struct reason *reason) MUST_USE;

/* Prepares an engine as all steps of a trial's life do: with the first tree and scene, then at each
 * step by its `move` after a refit, where it has one, else anew. After all steps but the last the
 * rays are traced, and the answers thrown away. A trial without steps: as engine.prepare.
 *   tree  life->count + 1 of them, for an engine that needs packed trees; else NULL
 *   last  the job after the last step: its scene is the trial's, its tree has the last one's bytes
 * Errors: as engine.prepare and engine.trace; STATUS_MEMORY. */
enum status trial_life_prepare(const struct fuzz_trial *trial, const struct trial_life *life,
                               const struct life_tree *tree, const struct engine *engine,
                               void *self, const struct job *last, struct reason *reason) MUST_USE;

/* The same, with scenes and trees made for it, and freed: the engine then borrows from `last`
 * alone. Errors: also those of trial_life_trees. */
enum status trial_life_enter(const struct fuzz_trial *trial, const struct engine *engine,
                             void *self, const struct job *last, struct reason *reason) MUST_USE;

#endif
