/* Vertex normals for scenes that have none. */
#ifndef NORMALS_H
#define NORMALS_H

#include "ref/scene/scene.h"

/* Returns a unit normal for every vertex: the sum, normalized, of the unit normals of the triangles
 * around it, each weighted by its angle there. Where that is nothing (a vertex of no triangle, of
 * triangles without area, or between two that face each other) it is (0, 1, 0); never NaN.
 * The scene has passed scene_check. Computed in double. NULL without memory; caller frees.
 * Source: RTRS's construct, which works in float and leaves NaN there. */
float *scene_normals(const struct scene *scene) MUST_USE;

/* The same; `none`, vertex_count bytes, becomes 1 for every vertex where the sum is nothing and so
 * RTRS's would be NaN, else 0. */
float *scene_normals_told(const struct scene *scene, uint8_t *none) MUST_USE;

#endif
