/* What the oriented boxes of a packed tree (layout->oblique) have to contain. */
#ifndef PACKED_OBLIQUE_H
#define PACKED_OBLIQUE_H

#include "ref/packed/packed_walk.h"

/* Along the axes of a node's parent: `lo` the greatest floats that are at most the products of axes
 * and the vertices below the node, `hi` the least that are at least; empty: nothing is known to be
 * below, or no oriented box is stored. */
struct oblique_bounds {
    float lo[3], hi[3];
};

/* Bounds of every visit, of the triangles that leaves below name. The caller frees *out, which is
 * NULL if the layout has no oriented boxes. Errors: STATUS_MEMORY. */
enum status packed_oblique_make(const struct packed *packed, const struct scene *scene,
                                const struct packed_walk *walk,
                                struct oblique_bounds **out) MUST_USE;

/* The axes of a child's oriented box. False if none is stored. */
bool packed_oblique_axes(const struct packed *packed, uint32_t ref, uint32_t child,
                         float axis[3][3]);

/* Whether the stored oriented box of a child contains these bounds; true if none is stored, or if
 * they are empty. A NaN is no bound. *axis is the first that does not. */
bool packed_oblique_holds(const struct packed *packed, uint32_t ref, uint32_t child,
                          const struct oblique_bounds *bounds, uint32_t *axis);

#endif
