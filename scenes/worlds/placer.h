/* Shared by the generators of worlds: meshes and instances of a world of known size, and matrices
 * made by + - * / and bit patterns alone, so that they are the same on every machine. */
#ifndef PLACER_H
#define PLACER_H

#include "ref/base/rng.h"
#include "scenes/worlds.h"

/* Largest number of instances of a generator. */
#define PLACER_INSTANCES_MOST (1u << 20)

/* A world being drawn. A generator must not add more than it passed to placer_start (asserted). */
struct placer {
    struct world *world;
    struct rng rng; /* seeded by the user's seed */
    uint32_t mesh_room, instance_room;
};

/* Rows of M. */
struct linear {
    double m[3][3];
};

/* Makes room. Errors: STATUS_LIMIT more than PLACER_INSTANCES_MOST instances; STATUS_MEMORY. */
enum status placer_start(struct placer *placer, uint32_t meshes, uint32_t instances,
                         struct reason *reason) MUST_USE;

/* Adds a mesh of one opaque geometry. The scene is moved, also on error. Errors: STATUS_MEMORY. */
enum status placer_mesh(struct placer *placer, struct scene *scene, struct reason *reason) MUST_USE;

/* Adds the scene that a generator makes of `value`. Errors: as of generator_make. */
enum status placer_generated(struct placer *placer, const char *generator, const double *value,
                             uint64_t seed, struct reason *reason) MUST_USE;

/* Adds a closed box of 12 triangles, from 0 to 1 along each axis, facing outward. */
enum status placer_box(struct placer *placer, struct reason *reason) MUST_USE;

/* Adds an instance at M p + T, each number rounded to float, with mask 0xFF, and returns it. */
struct instance *placer_add(struct placer *placer, uint32_t mesh, const struct linear *m,
                            const double t[3]);

/* 2^k, -126 <= k <= 127. */
double placer_power(int k);

/* Draws a transform of a kind for instance i: M, and T where it is not what t holds before. */
typedef struct linear placed_draw(struct placer *placer, uint32_t i, double t[3]);

/* Kinds of transforms, each that of the generator "placed-NAME"; ends at one without a name. */
struct placed_kind {
    const char *name;
    placed_draw *draw;
};
extern const struct placed_kind placed_kinds[];

struct linear linear_diagonal(double x, double y, double z);
/* What is placed by b, then by a. */
struct linear linear_multiply(const struct linear *a, const struct linear *b);
/* A random rotation: of a quaternion of random numbers, divided by its squared length, so that no
 * angle is a round one. */
struct linear placer_rotation(struct placer *placer);

#endif
