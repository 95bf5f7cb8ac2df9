/* Moves a scene onto a grid: the scene that a lossy storage of its vertices decodes to. Shared
 * vertices stay shared, so a closed mesh stays closed. Results can be judged exactly for the
 * decoded scene; its distance from the original is known exactly. */
#ifndef QUANTISE_H
#define QUANTISE_H

#include "ref/scene/scene.h"

#define QUANTISE_BITS_LEAST   8u
#define QUANTISE_BITS_MOST    21u
#define QUANTISE_BITS_DEFAULT 16u
#define TRUNCATE_BITS_MOST    23u
#define TRUNCATE_BITS_DEFAULT 8u

/* Coordinates on a grid are n * step, |n| <= GRID_MOST, so that floats represent them exactly. */
#define GRID_MOST ((int32_t)0xFFFFFF)
/* The same of a grid with one step for all axes: signed numbers of 24 bits. */
#define EVEN_MOST      ((int32_t)0x7FFFFF)
#define EVEN_STEP_MOST 0x1p105f

/* A grid that contains the coordinates: (lo + code) * step per axis, codes of `bits` bits. The step
 * is a power of two that is not subnormal. */
struct grid {
    int32_t lo[3];
    float step[3];
    uint32_t bits;
};

/* How far the vertices moved. */
struct quantised {
    struct grid grid;
    double moved[3]; /* the largest |decoded - original| per axis: exact */
    double distance; /* upper bound of the distance that a vertex moved; at most 2^-50 of it above
                        the largest */
    uint32_t flat;   /* triangles of the decoded scene with collinear vertices: never hit; counted
                      on grids alone */
};

/* Moves each coordinate to the nearest grid point, halves up. The step is the least power of two
 * for which the scene's extents fit in `bits` bits (QUANTISE_BITS_LEAST to _MOST) and the limit
 * GRID_MOST is kept. Deterministic. *out is a copy except for its vertices; negative zeros become
 * zeros. Errors: STATUS_INPUT a number that is not finite, or bits out of range; STATUS_LIMIT a
 * coordinate above half of the largest float, whose neighbour on the grid may be infinite;
 * STATUS_MEMORY. */
enum status scene_quantise(const struct scene *scene, uint32_t bits, struct scene *out,
                           struct quantised *quantised, struct reason *reason) MUST_USE;

/* The same with one step for all axes, and numbers n of at most EVEN_MOST in magnitude: the grid of
 * the dense geometry format. */
enum status scene_quantise_even(const struct scene *scene, uint32_t bits, struct scene *out,
                                struct quantised *quantised, struct reason *reason) MUST_USE;

/* Drops the low `bits` bits (1 to TRUNCATE_BITS_MOST) of the fraction of each coordinate: rounds
 * toward zero. Negative zeros stay what they are. Deterministic. *out is as of
 * scene_quantise; of *quantised the grid has only its bits. Errors:
 * STATUS_INPUT a number that is not finite, or bits out of range; STATUS_MEMORY. */
enum status scene_truncate(const struct scene *scene, uint32_t bits, struct scene *out,
                           struct quantised *quantised, struct reason *reason) MUST_USE;

/* A way to lose precision: `move` is one of the functions above, with their errors. */
struct lossy {
    uint32_t bits_least, bits_most, bits_default;
    const char *told; /* what the bits are, for "%u TOLD" */
    enum status (*move)(const struct scene *scene, uint32_t bits, struct scene *out,
                        struct quantised *quantised, struct reason *reason);
};
extern const struct lossy lossy_quantised, lossy_even, lossy_truncated;

/* Finds the coarsest grid that contains all vertices exactly. Errors: STATUS_LIMIT there is none of
 * at most QUANTISE_BITS_MOST bits, or a negative zero. */
enum status grid_of_scene(const struct scene *scene, struct grid *out,
                          struct reason *reason) MUST_USE;

/* Finds the largest step of an even grid that contains all vertices exactly; lo is 0, and `bits` is
 * not set. Errors: STATUS_LIMIT there is none, or a negative zero. */
enum status grid_even_of_scene(const struct scene *scene, struct grid *out,
                               struct reason *reason) MUST_USE;

/* Returns the code of a coordinate on the grid: (lo + code) * step is x to the bit. */
static inline uint32_t grid_code(const struct grid *grid, int k, float x)
{
    return (uint32_t)((int32_t)(x / grid->step[k]) - grid->lo[k]);
}

#endif
