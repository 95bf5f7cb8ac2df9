/* World boxes: the box of each instance, which contains every vertex M v + T of its mesh exactly.
 * The usual ways do not: corners of the mesh's box placed by float32 arithmetic, or its centre and
 * |M| times its half widths, lack some units in the last place. */
#ifndef WORLD_BOXES_H
#define WORLD_BOXES_H

#include "ref/world/world.h"

/* What the box of an instance is made from. */
enum world_boxes {
    /* Vertices as long as the instances have at most WORLD_BOXES_VERTICES of them together, which
     * takes about a second; else corners. */
    WORLD_BOXES_AUTO,
    /* All vertices that triangles of its mesh use: the least box of float32 numbers. */
    WORLD_BOXES_OF_VERTICES,
    /* The corners of its mesh's box, which take as long for any mesh. The box contains the least
     * one, and is the same where M only scales and exchanges axes. Turned, the sphere's has 2.2
     * times the area, that of random triangles 1.25 times. */
    WORLD_BOXES_OF_CORNERS,
};

#define WORLD_BOXES_VERTICES (1u << 25)

/* Returns "auto", "vertices" or "corners". */
const char *world_boxes_name(enum world_boxes how);

/* True if rays can meet the instance: it has a mesh with triangles, and a mask. */
bool world_is_active(const struct world *world, uint32_t instance);

/* True if the boxes of the world's instances are made from vertices. */
bool world_boxes_are_of_vertices(const struct world *world, enum world_boxes how);

/* Makes the boxes of all instances, instance_count of them; box_empty() for those that are not
 * active. Caller frees *out. Errors: STATUS_LIMIT an instance reaches beyond float32;
 * STATUS_MEMORY. */
enum status world_boxes_make(const struct world *world, enum world_boxes how, struct box **out,
                             struct reason *reason) MUST_USE;

#endif
