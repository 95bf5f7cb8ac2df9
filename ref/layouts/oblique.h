/* Oblique axes of layout obb8: a table of rotations, and bounds along all their axes. */
#ifndef OBLIQUE_H
#define OBLIQUE_H

#include "ref/layout.h"

/* Three axes at right angles, of whole numbers of -8 to 7. */
typedef int8_t tilt_axes[3][3];

#define TILTS 17
extern const tilt_axes tilts[TILTS];

/* Bounds along the axes of every rotation: of the products of axes and points. */
struct spans {
    float lo[TILTS][3], hi[TILTS][3];
};

void spans_clear(struct spans *s);
void spans_add(struct spans *s, const struct spans *other);

/* Extends the bounds by a triangle; by the whole box of one whose first vertex is its last, which
 * in the top of a world stands for an instance (ref/two_level/world_trees.h) and elsewhere has no
 * area. Coordinates are at most 2^96 in magnitude. */
void spans_add_triangle(struct spans *s, const struct scene *scene, uint32_t prim);

/* Half the area of the box of rotation `tilt`. */
double spans_area(const struct spans *s, uint32_t tilt);

#endif
