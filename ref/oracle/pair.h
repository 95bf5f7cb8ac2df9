/* One pair, decided: the filter first, integers where it cannot tell. For the oracle's own files.
 */
#ifndef ORACLE_PAIR_H
#define ORACLE_PAIR_H

#include "ref/oracle/exact.h"
#include "ref/oracle/oracle.h"

/* A pair and, once computed, its integers. */
struct decided {
    struct oracle_pair pair;
    struct exact exact; /* if have_exact */
    bool have_exact;
};

/* What a caller wants to know of a pair. */
enum pair_depth {
    PAIR_HITS, /* MISS may be given as soon as it is certain, with nothing else filled in; also of a
                  hit that is certainly out of the range */
    PAIR_FULL,
};

/* Decides triangle `prim` of `scene`, whose area is 0 exactly if `flat`. The floating-point
 * environment is the right one (environment_enter). Adds to *stats what left the filter. */
void pair_decide(const struct scene *scene, bool flat, const struct ray *ray, uint32_t prim,
                 enum pair_depth depth, struct decided *out, struct oracle_stats *stats);

/* Exact t of a hit, computed at the first call. */
const struct fraction *pair_t(const struct scene *scene, const struct ray *ray, uint32_t prim,
                              struct decided *hit);

/* Whether two hits are in one place by their triangles alone, which then have the same t: in a
 * plane across an axis that holds both; or inside the same face, the triangle, edge or vertex that
 * they share, being the vertices whose w is not 0. The line meets each of these in one point, since
 * no D is 0. False tells nothing. */
bool pair_same_place(const struct scene *scene, uint32_t a, const struct oracle_pair *at_a,
                     uint32_t b, const struct oracle_pair *at_b);

/* INSIDE, EDGE or VERTEX. */
static inline bool pair_is_hit(const struct oracle_pair *pair)
{
    return pair->class == ORACLE_INSIDE || pair->class == ORACLE_EDGE ||
           pair->class == ORACLE_VERTEX;
}

/* Whether a hit, or an interval in the plane, counts under `ends`. */
static inline bool pair_in_range(const struct oracle_pair *pair, enum oracle_ends ends)
{
    return pair->range == ORACLE_WITHIN ||
           (ends == ORACLE_CLOSED &&
            (pair->range == ORACLE_AT_TMIN || pair->range == ORACLE_AT_TMAX));
}

#endif
