/* Shared by the scene generators: drawing into a scene of known size. */
#ifndef PEN_H
#define PEN_H

#include "ref/base/rng.h"
#include "scenes/scenes.h"

/* Largest triangle count of a generator. */
#define GENERATOR_TRI_MAX (1u << 24)

/* A scene being drawn. A generator must not draw more than it passed to pen_start (asserted). */
struct pen {
    const struct generator *generator;
    struct scene *scene;
    struct rng rng;        /* seeded by the user's seed */
    uint32_t vertex_count; /* drawn so far */
    uint32_t tri_count;
    int32_t material; /* of the next triangles; stored only if the scene has material_of */
};

/* Allocates the scene. Materials, lights and camera stay empty.
 * Errors: STATUS_LIMIT more than GENERATOR_TRI_MAX triangles or 3 * GENERATOR_TRI_MAX vertices;
 * STATUS_MEMORY. */
enum status pen_start(struct pen *pen, uint64_t vertex_count, uint64_t tri_count,
                      struct reason *reason) MUST_USE;

/* Copies materials and lights into the scene, allocates material_of, and sets an orbiting camera at
 * (0, 0, eye) that looks at the origin. Errors: STATUS_MEMORY. */
enum status pen_furnish(struct pen *pen, const struct material *material, uint32_t material_count,
                        const struct light *light, uint32_t light_count, float eye,
                        struct reason *reason) MUST_USE;

/* Adds a vertex, each coordinate rounded to float, and returns its index. */
uint32_t pen_vertex(struct pen *pen, double x, double y, double z);

/* Adds a triangle of three vertices already drawn. */
void pen_tri(struct pen *pen, uint32_t a, uint32_t b, uint32_t c);

/* Adds the parallelogram origin, origin + e1, origin + e2 as n x n cells of two triangles, facing
 * e1 x e2. Adds PEN_QUAD_VERTICES(n) vertices and 2 n^2 triangles. */
void pen_quad(struct pen *pen, const double origin[3], const double e1[3], const double e2[3],
              uint32_t n);
#define PEN_QUAD_VERTICES(n) (((uint64_t)(n) + 1) * ((uint64_t)(n) + 1))

/* Adds a closed sphere, facing outward: an octahedron whose edges are cut into n parts, its lattice
 * points i + j + k = n projected onto the sphere. Adds PEN_SPHERE_VERTICES(n) vertices and 8 n^2
 * triangles; n >= 1. Only sqrt is used, so that the bytes are the same on every machine. */
void pen_sphere(struct pen *pen, uint32_t n, const double centre[3], double radius);
#define PEN_SPHERE_VERTICES(n) (4 * (uint64_t)(n) * (n) + 2)
#define PEN_SPHERE_TRIS(n)     (8 * (uint64_t)(n) * (n))

/* Writes the corners (+-half, +-half, +-half): axis k is negative if bit k of the index is set. */
void cube_corners(double half, double v[8][3]);
/* Writes the cyclic permutations of (0, +-a, +-b): three rectangles. */
void golden_corners(double a, double b, double v[12][3]);

#endif
