/* What a ray meets of a world, in any order. For the oracle's own files. */
#ifndef ORACLE_WORLD_WALK_H
#define ORACLE_WORLD_WALK_H

#include "ref/oracle/oracle_world.h"
#include "ref/oracle/pair.h"

/* Receives what is met. */
struct world_visitor {
    double reach; /* no triangle whose t is above this is needed; `take` may lower it */
    struct oracle_stats stats;
    /* A triangle that counts, of class INSIDE, EDGE, VERTEX or IN_PLANE, in range, ends included;
     * each at most once. What this returns, but for STATUS_OK, ends the walk. */
    enum status (*take)(struct world_visitor *visitor, const struct ray *ray, struct decided *pair);
};

/* Hands the triangles that the ray meets to the visitor; `brute` visits every triangle. The ray is
 * one that oracle_takes takes and does not stand still. The caller has entered the floating-point
 * environment. Returns what `take` does. */
enum status world_walk(const struct oracle *oracle, const struct ray *ray, struct ray_mode mode,
                       bool brute, struct world_visitor *visitor);

/* As oracle_admit, of a decided pair. */
enum oracle_admission admission_of(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, const struct decided *pair);

#endif
