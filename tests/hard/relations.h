/* Metamorphic relations: what may be done to a scene and its rays without changing what is hit.
 * They need no truth, so a fuzzer can use them on any scene. */
#ifndef HARD_RELATIONS_H
#define HARD_RELATIONS_H

#include "tests/hard/hard.h"

/* Makes *out from `from`: the changed scene and rays; a WANT_LIKE on every ray, with the ray of
 * `from` whose answer it must have (out.like is left to the caller); out.prim_of and out.like_bits.
 * Returns false, with *out incomplete, if a coordinate would be rounded, so that nothing can be
 * compared. Deterministic in `seed`. */
struct relation {
    const char *name;
    const char *summary;
    bool (*make)(const struct hard_part *from, uint64_t seed, struct hard_part *out);
};

/* Ends at the first without a name. */
extern const struct relation relations[];

const struct relation *relation_find(const char *name); /* or NULL */

#endif
