/* Making scenes and rays of hard cases. No memory sets part.failed and is told by hard_make, so
 * that recipes read as recipes. */
#ifndef HARD_PARTS_H
#define HARD_PARTS_H

#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "tests/hard/hard.h"

/* A new empty part; at most HARD_PARTS_MOST. */
struct hard_part *part_add(struct hard_made *made, const char *label, ...) PRINTF_LIKE(2, 3);

/* A new part with a generator's scene, see scene_open; seed 1. */
struct hard_part *part_open(struct hard_made *made, const char *spec);

/* A copy of part `from`'s scene. */
void part_copy_scene(struct hard_part *part, const struct hard_part *from);

uint32_t part_vertex(struct hard_part *part, float x, float y, float z);
/* Returns the triangle's index. */
uint32_t part_tri(struct hard_part *part, uint32_t a, uint32_t b, uint32_t c);
uint32_t part_tri_of(struct hard_part *part, const float v[3][3]);

/* n x n cells of two triangles at up = height, axis up = 0, 1, 2: the corner (i, j) lies at
 * i * cell on axis up + 1 and j * cell on axis up + 2, offset by `from`. Cell (i, j) has triangle
 * 2 (i + n j), where the first coordinate is the larger, and the next, where it is the smaller. */
void part_grid(struct hard_part *part, uint32_t n, int up, float height, float cell, float from);
/* The triangle of that grid at (x, y), which is inside one. */
uint32_t grid_tri(uint32_t n, float x, float y);

/* The closed cube [0, size]^3 + from, 12 triangles, faces outward. */
void part_cube(struct hard_part *part, const float from[3], float size);

/* Multiplies every vertex by `factor`. */
void part_scale(struct hard_part *part, float factor);

/* A ray with tmin 0 and tmax RAY_TMAX. */
static inline struct ray ray_of(float ox, float oy, float oz, float dx, float dy, float dz)
{
    return (struct ray){{ox, oy, oz}, 0.0f, {dx, dy, dz}, RAY_TMAX};
}

/* From `from` to `to`; t is about 1 there. */
struct ray ray_at(const float from[3], const float to[3]);

static inline struct ray ray_between(struct ray ray, float tmin, float tmax)
{
    ray.tmin = tmin;
    ray.tmax = tmax;
    return ray;
}

/* Adds a ray that nothing is wanted of but to be judged; the want can be filled in until the next
 * ray is added. Never NULL. */
struct hard_want *part_ray(struct hard_part *part, struct ray ray);

/* Adds wants to a want. */
void want(struct hard_want *want, enum hard_scope scope, unsigned what);
void want_id(struct hard_part *part, struct hard_want *want, enum hard_scope scope, uint32_t id);
void want_ids(struct hard_part *part, struct hard_want *want, enum hard_scope scope, uint32_t count,
              const uint32_t *id);
void want_t(struct hard_want *want, enum hard_scope scope, float t);
/* t = 2^shift * t of ray `like` - add. */
void want_like(struct hard_want *want, enum hard_scope scope, size_t like, int shift, float add);

/* A point inside triangle `prim`: weights from `rng`, none below 1/8. */
void part_point(const struct hard_part *part, struct rng *rng, uint32_t prim, float p[3]);
/* The rounded middle of the edge between corners c and c + 1 of `prim`. */
void part_edge(const struct hard_part *part, uint32_t prim, int c, float p[3]);

#endif
