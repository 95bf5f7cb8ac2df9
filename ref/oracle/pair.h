/* One pair, decided: by the filter, or by integers if it cannot. For the oracle's own files. */
#ifndef ORACLE_PAIR_H
#define ORACLE_PAIR_H

#include "ref/oracle/exact.h"
#include "ref/oracle/oracle.h"

/* A pair and, once computed, its integers. */
struct decided {
    uint32_t prim;
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

/* Decides triangle `prim` of the oracle's scene. The caller has entered the floating-point
 * environment (environment_enter).
 *   stats   may be NULL; pairs that left the filter are added */
void pair_decide(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                 enum pair_depth depth, struct decided *out, struct oracle_stats *stats);

/* Exact t of a hit, computed at the first call. */
const struct fraction *pair_t(const struct oracle *oracle, const struct ray *ray,
                              struct decided *hit);

/* Sign of t_a - t_b of two hits, exactly. */
int pair_order(const struct oracle *oracle, const struct ray *ray, struct decided *a,
               struct decided *b);

#endif
