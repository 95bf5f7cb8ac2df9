/* Hints about an engine whose tree is not accessible: which known box tests reject the bounds of
 * the very triangle that was lost. A box of any tree that ends where the triangle ends is rejected
 * likewise. No proof: the engine's boxes are unknown. */
#ifndef EXPLAIN_OUTSIDE_H
#define EXPLAIN_OUTSIDE_H

#include "ref/explain/repair.h"
#include "ref/explain/slabs.h"
#include "ref/scene/scene.h"

struct outside_hint {
    enum cause cause;
    const char *text;
};

#define OUTSIDE_HINTS 4

/* Fills in the hints for the ray that lost `prim`; returns how many. */
size_t explain_outside(const struct scene *scene, const struct ray *ray, uint32_t prim,
                       struct outside_hint out[OUTSIDE_HINTS]);

#endif
