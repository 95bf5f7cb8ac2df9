/* Triangles whose determinant is 0 or nearly so, and rays that have to do with them. */
#ifndef TESTS_DEGENERATE_H
#define TESTS_DEGENERATE_H

#include "ref/abi.h"
#include "ref/base/base.h"
#include "ref/base/rng.h"

#include <math.h>
#include <string.h>

enum degenerate {
    ALL_EQUAL,       /* three equal vertices */
    TWO_EQUAL,       /* two, whichever */
    ON_AXIS,         /* on a line along an axis */
    ON_LINE,         /* on a line that is exactly one: multiples of one vector */
    NEAR_LINE,       /* on a line but for rounding */
    EDGE_ON_AXIS,    /* in a plane across an axis, and so is the ray */
    EDGE_ON_PLANE,   /* in a slanted plane that the ray lies in but for rounding */
    EDGE_ON_LATTICE, /* the same, exactly */
    SLIVER,          /* an edge as short as a few last places */
    DEGENERATE_COUNT
};

static const char *const degenerate_names[DEGENERATE_COUNT] = {
    "all_equal",    "two_equal",     "on_axis",         "on_line", "near_line",
    "edge_on_axis", "edge_on_plane", "edge_on_lattice", "sliver"};

static inline float degenerate_whole(struct rng *rng, int most)
{
    return (float)((int)rng_below(rng, (uint32_t)(2 * most + 1)) - most);
}

/* A point of the triangle's plane, or of its line. */
static inline void degenerate_point(struct rng *rng, float v[3][3], double reach, double out[3])
{
    double u = (double)rng_range(rng, -1, 2) * reach, w = (double)rng_range(rng, -1, 2) * reach;
    if (rng_below(rng, 4) == 0)
        u = w = 0; /* a vertex */
    for (int k = 0; k < 3; k++)
        out[k] = (double)v[0][k] + u * ((double)v[1][k] - (double)v[0][k]) +
                 w * ((double)v[2][k] - (double)v[0][k]);
}

/* The triangle. */
static inline void degenerate_triangle(enum degenerate kind, struct rng *rng, float v[3][3])
{
    float size = ldexpf(1, (int)rng_below(rng, 5) - 2);
    bool lattice = kind == EDGE_ON_LATTICE || kind == ON_LINE || rng_below(rng, 3) == 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = lattice ? degenerate_whole(rng, 8) : size * rng_range(rng, -4, 4);
    uint32_t axis = rng_below(rng, 3), one = rng_below(rng, 3);
    float step[3], from[3], at = rng_range(rng, -2, 2);
    for (int k = 0; k < 3; k++) {
        step[k] = degenerate_whole(rng, 3);
        from[k] = degenerate_whole(rng, 8);
    }
    for (int k = 0; k < 3; k++)
        switch (kind) {
        case ALL_EQUAL:
            v[1][k] = v[2][k] = v[0][k];
            break;
        case TWO_EQUAL:
            v[one][k] = v[(one + 1) % 3][k];
            break;
        case ON_AXIS:
            if ((uint32_t)k != axis)
                v[1][k] = v[2][k] = v[0][k];
            break;
        case ON_LINE:
            for (int c = 0; c < 3; c++)
                v[c][k] = from[k] + (float)(c * c) * step[k];
            break;
        case NEAR_LINE:
            v[2][k] = v[0][k] + at * (v[1][k] - v[0][k]);
            break;
        case EDGE_ON_AXIS:
            if ((uint32_t)k == axis)
                v[1][k] = v[2][k] = v[0][k];
            break;
        case SLIVER:
            v[1][k] = nextafterf(v[0][k], v[0][k] + step[k]);
            break;
        case EDGE_ON_PLANE:
        case EDGE_ON_LATTICE:
        case DEGENERATE_COUNT:
            break;
        }
}

/* A ray that lies in the triangle's plane or meets its line, but for rounding. */
static inline struct ray degenerate_ray(enum degenerate kind, struct rng *rng, float v[3][3])
{
    struct ray ray = {.tmin = 0, .tmax = 0x1p60f};
    double from[3], to[3];
    degenerate_point(rng, v, rng_below(rng, 2) ? 8 : 1, from);
    degenerate_point(rng, v, 0.5, to);
    bool line = kind == ALL_EQUAL || kind == TWO_EQUAL || kind == ON_AXIS || kind == ON_LINE ||
                kind == NEAR_LINE || kind == SLIVER;
    for (int k = 0; k < 3; k++) {
        if (line) /* from anywhere to a point of it */
            from[k] = (double)rng_range(rng, -8, 8);
        if (kind == EDGE_ON_LATTICE && rng_below(rng, 2))
            from[k] = floor(from[k]), to[k] = floor(to[k]);
        ray.org[k] = (float)from[k];
        ray.dir[k] = (float)(to[k] - from[k]);
    }
    if (kind == EDGE_ON_LATTICE) /* along edges, from a point of the lattice in the plane */
        for (int k = 0; k < 3; k++) {
            ray.dir[k] = 2 * (v[1][k] - v[0][k]) + (v[2][k] - v[1][k]);
            ray.org[k] = v[0][k] - 2 * (v[1][k] - v[0][k]);
        }
    if (rng_below(rng, 3) == 0) { /* off by a last place */
        uint32_t k = rng_below(rng, 3);
        ray.org[k] = nextafterf(ray.org[k], rng_below(rng, 2) ? 1e9f : -1e9f);
    }
    return ray;
}

#endif
