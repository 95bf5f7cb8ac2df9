/* What can be said of an engine that keeps its tree to itself: which known box tests turn the ray
 * away from the bounds of the very triangle that was lost. A box of any tree that ends where the
 * triangle ends is turned away likewise. Hints, not proof: the engine's boxes are not seen. */
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

/* Returns how many hints there are for the ray that lost `prim`. */
size_t explain_outside(const struct scene *scene, const struct ray *ray, uint32_t prim,
                       struct outside_hint out[OUTSIDE_HINTS]);

#endif
