/* What the scene generators share: drawing into a scene of known size. */
#ifndef PEN_H
#define PEN_H

#include "ref/base/rng.h"
#include "scenes/scenes.h"

/* No generator makes more triangles. */
#define GENERATOR_TRI_MAX (1u << 24)

/* A scene being drawn. Drawing more than pen_start allocated is a bug in the generator. */
struct pen {
    const struct generator *generator;
    struct scene *scene;
    struct rng rng;        /* of the seed */
    uint32_t vertex_count; /* drawn so far */
    uint32_t tri_count;
    int32_t material; /* of the triangles to come; kept only if the scene has material_of */
};

/* Allocates the scene. Materials, lights and camera stay empty.
 * Errors: STATUS_LIMIT more than GENERATOR_TRI_MAX triangles or 3 times as many vertices;
 * STATUS_MEMORY. */
enum status pen_start(struct pen *pen, uint64_t vertex_count, uint64_t tri_count,
                      struct reason *reason) MUST_USE;

/* Gives the scene copies of materials and lights, room for the triangles' materials, and an
 * orbiting camera at (0, 0, eye) that looks at the origin. Errors: STATUS_MEMORY. */
enum status pen_furnish(struct pen *pen, const struct material *material, uint32_t material_count,
                        const struct light *light, uint32_t light_count, float eye,
                        struct reason *reason) MUST_USE;

/* Adds a vertex, each coordinate rounded to float, and returns its index. */
uint32_t pen_vertex(struct pen *pen, double x, double y, double z);

/* Adds a triangle of three drawn vertices. */
void pen_tri(struct pen *pen, uint32_t a, uint32_t b, uint32_t c);

/* Adds the parallelogram origin, origin + e1, origin + e2 as n x n cells of two triangles, facing
 * e1 x e2: PEN_QUAD_VERTICES(n) vertices and 2 n^2 triangles. */
void pen_quad(struct pen *pen, const double origin[3], const double e1[3], const double e2[3],
              uint32_t n);
#define PEN_QUAD_VERTICES(n) (((uint64_t)(n) + 1) * ((uint64_t)(n) + 1))

/* Adds a closed sphere, facing outward: the octahedron with every edge cut in n parts, its lattice
 * points i + j + k = n pushed onto the sphere. Needs PEN_SPHERE_VERTICES(n) vertices and 8 n^2
 * triangles; n >= 1. Only sqrt is used, so the bytes are the same everywhere. */
void pen_sphere(struct pen *pen, uint32_t n, const double centre[3], double radius);
#define PEN_SPHERE_VERTICES(n) (4 * (uint64_t)(n) * (n) + 2)
#define PEN_SPHERE_TRIS(n)     (8 * (uint64_t)(n) * (n))

/* The corners (+-half, +-half, +-half): bit k of the index is set where axis k is negative. */
void cube_corners(double half, double v[8][3]);
/* Cyclic permutations of (0, +-a, +-b): three rectangles. */
void golden_corners(double a, double b, double v[12][3]);

#endif
