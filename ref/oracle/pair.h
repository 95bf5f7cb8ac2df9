/* One pair, decided: by the filter, or by integers if it cannot. For the oracle's own files. */
#ifndef ORACLE_PAIR_H
#define ORACLE_PAIR_H

#include "ref/oracle/exact.h"
#include "ref/oracle/oracle.h"

/* Where a triangle is found. */
struct located {
    const struct oracle *mesh;       /* of the scene that has it */
    const struct instance *instance; /* that has placed it; NULL: none, or at the identity */
    uint32_t tri;                    /* of the scene */
};

/* A pair and, once computed, its integers. */
struct decided {
    uint32_t prim;
    struct located at;
    struct oracle_pair pair;
    struct exact exact; /* if have_exact */
    bool have_exact;
};

/* What a caller needs of a pair. */
enum pair_depth {
    PAIR_HITS, /* a miss, and a hit that is certainly out of the range, may be returned as MISS with
                  nothing else filled in */
    PAIR_FULL,
};

/* Where triangle `prim` of the oracle's scene or world is. */
struct located pair_locate(const struct oracle *oracle, uint32_t prim);

/* Decides triangle `prim`, which is `at` a place. The caller has entered the floating-point
 * environment (environment_enter).
 *   stats   may be NULL; pairs that left the filter are added */
void pair_decide(const struct located *at, const struct ray *ray, uint32_t prim,
                 enum pair_depth depth, struct decided *out, struct oracle_stats *stats);

/* Exact t of a hit, computed at the first call. */
const struct fraction *pair_t(const struct ray *ray, struct decided *hit);

/* Sign of t_a - t_b of two hits, exactly. */
int pair_order(const struct ray *ray, struct decided *a, struct decided *b);

/* The number is lo <= x <= hi. */
struct enclosure {
    double lo, hi;
};

/* The weights of vertices 1 and 2 of a hit in double: *u encloses w1 / D and *v w2 / D. Returns
 * whether the filter knows them; else nothing is written. */
bool pair_weights(const struct ray *ray, const struct located *at, struct enclosure *u,
                  struct enclosure *v);

#endif
