/* A trial of a world with steps: its worlds, their trees, and engines that are taken through. */
#ifndef FUZZ_TRIAL_WORLD_LIFE_H
#define FUZZ_TRIAL_WORLD_LIFE_H

#include "fuzz/play/trial_life.h"
#include "ref/two_level/world_life.h"

struct world_job; /* ref/engine.h */

/* The worlds of a trial's life; zero of a trial of a scene, or without steps. */
struct trial_world_life {
    struct trial_meshes meshes[LIFE_STEPS_MOST + 1]; /* as built, and after each step */
    uint32_t count;                                  /* of steps; 0: nothing is made */
};

/* Errors: STATUS_MEMORY; *out is zero then. */
enum status trial_world_life_make(const struct fuzz_trial *trial, struct trial_world_life *out,
                                  struct reason *reason) MUST_USE;
void trial_world_life_free(struct trial_world_life *life); /* a zero one is fine */

/* Makes what is placed what it was before the step that moved it: the vertices of all meshes
 * together, by a motion of vertices, or the instances. Errors: STATUS_MEMORY. */
enum status trial_world_unmove(struct fuzz_trial *trial, const struct step *step,
                               struct reason *reason) MUST_USE;

/* Builds, refits and builds again: out[i] is after step i, of life->count + 1. Errors: as
 * world_life_begin and world_life_step; nothing is to be freed then. */
enum status trial_world_life_trees(const struct fuzz_trial *trial,
                                   const struct trial_world_life *life, const struct layout *layout,
                                   struct world_life *out, struct reason *reason) MUST_USE;

/* As trial_life_prepare, of an engine that traces worlds.
 *   lived  life->count + 1 of them, for an engine that needs packed trees; else NULL
 * Errors: as prepare_world and trace_world; STATUS_MEMORY. */
enum status trial_world_life_prepare(const struct fuzz_trial *trial,
                                     const struct trial_world_life *life,
                                     const struct world_life *lived, const struct engine *engine,
                                     void *self, const struct world_job *last,
                                     struct reason *reason) MUST_USE;

#endif
