/* Exact test of a triangle against a box, by the separating axis theorem (Gottschalk, Lin, Manocha
 * 1996) on the 13 axes of a box and a triangle. Signs are decided in double if a bound of the
 * rounding errors allows it, else in integers.
 *
 * Sides of a box may be open. A half-open box meets a convex set exactly if, for all small enough e
 * > 0, the closed box meets it whose open sides are moved inward by e. All axes but the box's own
 * are linear in the corners. So a corner on the separating plane is beyond it as soon as it is
 * moved, that is, if it is on an open side across which the axis has a component. The theorem also
 * holds for boxes without thickness and triangles without area: a box grown by e on all sides meets
 * a compact set for all e > 0 only if the box itself does, and it has the same axes. */
#ifndef COVER_EXACT_H
#define COVER_EXACT_H

#include "ref/scene/scene.h"

/* A box whose sides may be open: bit k for lo[k], bit 3 + k for hi[k]. */
struct cover_part {
    struct box box;
    unsigned open;
};

#define COVER_OPEN_LO(k) (1u << (k))
#define COVER_OPEN_HI(k) (8u << (k))

/* True if the part is empty; a NaN bound makes it empty. */
bool cover_part_empty(const struct cover_part *part);

/* True if the triangle `v`, including its edges and vertices, has a point in `part`. All numbers
 * must be finite, and the rounding mode to nearest. */
bool cover_meets(float v[3][3], const struct cover_part *part);

/* Number of times integers were needed so far in this thread; for tests. */
unsigned long long cover_integers(void);

#endif
