/* A mesh while it is read: positions, and polygons split into triangles as they arrive. */
#ifndef MESH_H
#define MESH_H

#include "ref/scene/scene.h"

/* A polygon with more corners is rejected: no tool writes one, and its fan would be slivers. */
#define MESH_CORNERS_MOST 65536

/* Zero-initialize; free with mesh_free or mesh_finish. */
struct mesh {
    float *vertex;
    uint32_t *index;
    size_t vertex_count, tri_count;
    size_t vertex_capacity, index_capacity;
    uint32_t first, last; /* corners of the current polygon */
    uint32_t corners;
};

void mesh_free(struct mesh *mesh);

/* Appends a position. Errors: STATUS_LIMIT beyond 2^32 - 2 positions; STATUS_MEMORY. */
enum status mesh_vertex(struct mesh *mesh, const float position[3]) MUST_USE;

/* Starts a polygon, then adds one corner at a time: from the third on, each adds the triangle
 * (first corner, corner before, corner), the fan of the polygon.
 * Errors: STATUS_LIMIT beyond MESH_CORNERS_MOST corners or 2^32 - 2 triangles; STATUS_MEMORY. */
void mesh_polygon(struct mesh *mesh);
enum status mesh_corner(struct mesh *mesh, uint32_t vertex) MUST_USE;

/* Moves the mesh into *out, which has passed scene_check; the mesh is zero afterwards. Errors:
 * STATUS_INPUT "NAME: rule", no triangle or an error of scene_check; *out is zero. */
enum status mesh_finish(struct mesh *mesh, const char *name, struct scene *out,
                        struct reason *reason) MUST_USE;

#endif
