/* A scene moved onto a grid: what a lossy storage of its vertices makes of it, as a scene of its
 * own. Vertices that were shared stay shared, so that a closed mesh stays closed, and what is
 * traced can be judged exactly for the scene that was decoded; how far that one lies from the
 * original is known, to the last bit. */
#ifndef QUANTISE_H
#define QUANTISE_H

#include "ref/scene/scene.h"

#define QUANTISE_BITS_LEAST   8u
#define QUANTISE_BITS_MOST    21u
#define QUANTISE_BITS_DEFAULT 16u

/* Coordinates on a grid are n * step, |n| <= GRID_MOST, so that floats have them exactly. */
#define GRID_MOST ((int32_t)0xFFFFFF)

/* A grid on which coordinates lie: (lo + code) * step per axis, codes of `bits` bits. The step is a
 * power of two that is no subnormal. */
struct grid {
    int32_t lo[3];
    float step[3];
    uint32_t bits;
};

/* What became of the vertices. */
struct quantised {
    struct grid grid;
    double moved[3]; /* the largest |decoded - original| per axis: exact */
    double distance; /* no vertex moved farther than this; rounded up, by no more than 2^-50 of it
                        from the farthest */
    uint32_t flat;   /* triangles of the decoded scene whose vertices lie on a line: never hit */
};

/* Moves each coordinate to the nearest grid point, halves up. The step is the least power of two
 * with which the scene's extents have `bits` bits (QUANTISE_BITS_LEAST to _MOST) and GRID_MOST
 * holds. Deterministic. *out is a copy but for its vertices; negative zeros become zeros.
 * Errors: STATUS_INPUT a number that is not finite, or bits out of range; STATUS_LIMIT a coordinate
 * above half of the largest float, whose neighbour on the grid may be infinite; STATUS_MEMORY. */
enum status scene_quantise(const struct scene *scene, uint32_t bits, struct scene *out,
                           struct quantised *quantised, struct reason *reason) MUST_USE;

/* The coarsest grid on which all vertices lie to the bit. Errors: STATUS_LIMIT there is none of at
 * most QUANTISE_BITS_MOST bits, or a negative zero. */
enum status grid_of_scene(const struct scene *scene, struct grid *out,
                          struct reason *reason) MUST_USE;

/* Of a vertex on the grid: (lo + code) * step has its bits. */
static inline uint32_t grid_code(const struct grid *grid, int k, float x)
{
    return (uint32_t)((int32_t)(x / grid->step[k]) - grid->lo[k]);
}

#endif
