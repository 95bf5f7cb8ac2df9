/* The tree of a trial: built of its scene at rest, packed in a layout and the trial's storage, and
 * refitted to the scene as it is traced; for all that play, explain or export trials. */
#ifndef FUZZ_TRIAL_TREE_H
#define FUZZ_TRIAL_TREE_H

#include "fuzz/play/trial.h"
#include "ref/layout.h"

/* What a tree has gone through since it was built. */
enum trial_motion {
    TRIAL_STILL,
    TRIAL_REFITTED,
    TRIAL_REBUILT /* the refit returned STATUS_LIMIT, or a step has it so: it was built again, of
                     the scene as traced */
};

/* What the last step of a life did to a tree. */
enum trial_motion fuzz_trial_motion(enum life_fate fate);

/* Builds the canonical tree of the scene at rest, of a trial with steps of its first scene, on one
 * thread. Errors: as bvh_build. */
enum status fuzz_trial_build(const struct fuzz_trial *trial, struct bvh *out,
                             struct reason *reason) MUST_USE;

/* Packs a tree that fuzz_trial_build made, of a trial that does not move. Errors: as
 * packed_make_stored. */
enum status fuzz_trial_pack(const struct fuzz_trial *trial, const struct layout *layout,
                            const struct bvh *bvh, struct packed *out,
                            struct reason *reason) MUST_USE;

/* Builds, packs, moves and refits, or goes through all steps; *bvh is the tree of what is packed,
 * its bounds those of the scene that is traced. If a refit returns STATUS_LIMIT, the tree is
 * rebuilt: *motion (may be NULL) is then TRIAL_REBUILT. Both are zero on error. Errors: as
 * fuzz_trial_build and fuzz_trial_pack; STATUS_INPUT to be refitted, but what was packed decodes
 * to no tree of the scene. */
enum status fuzz_trial_tree(const struct fuzz_trial *trial, const struct layout *layout,
                            struct bvh *bvh, struct packed *out, enum trial_motion *motion,
                            struct reason *reason) MUST_USE;

#endif
