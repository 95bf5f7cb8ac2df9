/* The vertices of one geometry, numbered among themselves. */
#ifndef ACCEL_WINDOW_H
#define ACCEL_WINDOW_H

#include "gpu/accel/accel_input.h"

#define WINDOW_MOST 65536u /* vertices that 16-bit indices reach */

struct accel_vertex {
    float at[3];
    uint32_t number; /* of the scene */
    bool nan;        /* its x is NaN instead */
};

struct accel_window {
    struct accel_vertex *vertex; /* those of the scene, then those with NaN */
    uint32_t *corner;            /* 3 * tri_count numbers of these */
    uint32_t vertex_count, real_count, tri_count;
    size_t vertex_capacity, corner_capacity;
    uint32_t *local, *stamp; /* for each vertex of the scene: its number here, and in which fill */
    uint32_t fills;
};

/* Makes an empty window of a scene. Call window_end also on error. */
enum status window_begin(struct accel_window *out, const struct scene *scene,
                         struct reason *reason) MUST_USE;

/* Replaces its content by triangles of the scene, then what the variant adds that is never hit. */
enum status window_fill(struct accel_window *window, const struct scene *scene, uint32_t first,
                        uint32_t count, const struct accel_variant *variant,
                        struct reason *reason) MUST_USE;
void window_end(struct accel_window *window);

/* How many triangles of a kind that is never hit are added to `count`. */
static inline uint32_t window_added(uint32_t count)
{
    return count ? count / 8 + 1 : 0;
}

/* Writes the point that the transform of part `number` takes to `at`. Returns false if it takes it
 * elsewhere, by rounding. */
bool accel_untransform(const struct accel_variant *variant, uint32_t number, const float at[3],
                       float to[3]);

#endif
