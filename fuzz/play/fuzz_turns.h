/* Contestants that take turns: those that differ only in how their shaders read memory do the same
 * operations in the same order, so one of them is enough for a trial. Each plays some blocks of
 * trials, the first the most. */
#ifndef FUZZ_TURNS_H
#define FUZZ_TURNS_H

#include "fuzz/play/player.h"

#define FUZZ_TURNS 8u /* blocks until it is the first one's turn again as in the beginning */

/* Sets whose turns are shared: contestants of one layout whose engines are alike. Returns how many
 * of them share their turns with another; 0: none do, and all play all trials. The first of
 * those that share plays all blocks of FUZZ_TURNS but one for each of the others. More than
 * FUZZ_TURNS that are alike make two groups, and so on. */
size_t fuzz_turns_share(struct fuzz_field *field,
                        bool (*alike)(const struct engine *a, const struct engine *b));

/* The contestants that have no turn in a block of trials, as a mask of 1u << contestant. A pure
 * function of both. */
uint32_t fuzz_turns_waiting(const struct fuzz_field *field, uint64_t block);

#endif
