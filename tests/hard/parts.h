/* Makes scenes and rays of hard cases. Without memory part.failed is set and hard_make reports it,
 * so that recipes need no error handling. */
#ifndef HARD_PARTS_H
#define HARD_PARTS_H

#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "tests/hard/hard.h"

/* A new empty part; at most HARD_PARTS_MOST. */
struct hard_part *part_add(struct hard_made *made, const char *label, ...) PRINTF_LIKE(2, 3);

/* A new part with a generator's scene, see scene_open; seed 1. */
struct hard_part *part_open(struct hard_made *made, const char *spec);

uint32_t part_vertex(struct hard_part *part, float x, float y, float z);
/* These return the triangle's index. */
uint32_t part_tri(struct hard_part *part, uint32_t a, uint32_t b, uint32_t c);
uint32_t part_tri_of(struct hard_part *part, float v[3][3]);
uint32_t part_triangle(struct hard_part *part, float ax, float ay, float az, float bx, float by,
                       float bz, float cx, float cy, float cz);

/* The triangle (0, 0), (4, 0), (0, 4) in the plane z. */
void part_layer(struct hard_part *part, float z);

/* The triangles of `from`, of which no two share a vertex. */
void part_split(struct hard_part *part, const struct hard_part *from);

/* n x n cells of two triangles at up = height, axis up = 0, 1, 2: the corner (i, j) lies at
 * i * cell on axis up + 1 and j * cell on axis up + 2, offset by `from`. Cell (i, j) has triangle
 * 2 (i + n j), where the first coordinate is the larger, and the next, where it is the smaller. */
void part_grid(struct hard_part *part, uint32_t n, int up, float height, float cell, float from);
/* The triangle of that grid at (x, y), which is inside one. */
uint32_t grid_tri(uint32_t n, float x, float y);

/* A new part with the grid z = height of n x n unit cells from the origin on. */
struct hard_part *part_floor(struct hard_made *made, const char *label, uint32_t n, float height);

/* The closed cube [from, from + size]^3, 12 triangles, faces outward. */
void part_cube(struct hard_part *part, float from, float size);

/* A ray with tmin 0 and tmax RAY_TMAX. */
static inline struct ray ray_of(float ox, float oy, float oz, float dx, float dy, float dz)
{
    return (struct ray){{ox, oy, oz}, 0.0f, {dx, dy, dz}, RAY_TMAX};
}

/* The ray with its x, y and z on the axes up, up + 1 and up + 2. */
struct ray ray_turned(int up, struct ray ray);

/* From `from` to `to`; t is about 1 there. */
struct ray ray_at(const float from[3], const float to[3]);

static inline struct ray ray_between(struct ray ray, float tmin, float tmax)
{
    ray.tmin = tmin;
    ray.tmax = tmax;
    return ray;
}

/* Adds a ray whose answer is judged, with no other expectation yet. */
void part_ray(struct hard_part *part, struct ray ray);

/* Add expectations to the part's last ray. */
void want(struct hard_part *part, enum hard_scope scope, unsigned what);
void want_id(struct hard_part *part, enum hard_scope scope, uint32_t id);
/* One of these triangles, or one of first .. first + count - 1. */
void want_ids(struct hard_part *part, enum hard_scope scope, uint32_t count, const uint32_t *id);
void want_range(struct hard_part *part, enum hard_scope scope, uint32_t first, uint32_t count);
void want_t(struct hard_part *part, enum hard_scope scope, float t);
/* t = 2^shift * t of ray `like` - add. */
void want_like(struct hard_part *part, enum hard_scope scope, size_t like, int shift, float add);

/* Add a ray with one expectation. */
void expect_hit(struct hard_part *part, enum hard_scope scope, struct ray ray);
void expect_miss(struct hard_part *part, enum hard_scope scope, struct ray ray);
void expect_id(struct hard_part *part, enum hard_scope scope, struct ray ray, uint32_t id);
void expect_t(struct hard_part *part, enum hard_scope scope, struct ray ray, float t);

/* A whole number below n. */
static inline float whole(struct rng *rng, uint32_t n)
{
    return (float)rng_below(rng, n);
}

/* A multiple of 1/8 below n that is no whole number. */
static inline float off_lines(struct rng *rng, uint32_t n)
{
    float line = whole(rng, n);
    return line + 0.125f * (1 + whole(rng, 7));
}

/* Three coordinates, each from lo to hi, or up to `reach` away from the centre's. */
void random_point(struct rng *rng, float lo, float hi, float p[3]);
void random_near(struct rng *rng, const float centre[3], float reach, float p[3]);
/* In a random direction, `distance` away from the origin. */
void random_far(struct rng *rng, float distance, float p[3]);

/* The place of a vertex. */
void part_corner(const struct hard_part *part, uint32_t vertex, float p[3]);
/* A point inside triangle `prim`: weights from `rng`, none below 1/8. */
void part_point(const struct hard_part *part, struct rng *rng, uint32_t prim, float p[3]);
/* The rounded middle of the edge between corners c and c + 1 of `prim`. */
void part_edge(const struct hard_part *part, uint32_t prim, int c, float p[3]);

#endif
