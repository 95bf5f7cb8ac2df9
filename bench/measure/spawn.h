/* Rays that start on a surface: hit points as renderers compute them in float32, the rules by which
 * renderers move the next ray's origin off the surface, and what the exact ray from the exact point
 * would have met. */
#ifndef SPAWN_H
#define SPAWN_H

#include "ref/oracle/oracle.h"
#include "ref/primitives/primitives.h"
#include "ref/base/rng.h"
#include "ref/scene/topology.h"

/* A hit and the ray that leaves it. */
struct spawn_hit {
    struct ray primary;
    struct hit hit; /* answer of a float32 triangle test for the exact nearest triangle */
    double t_err;   /* proven bound on the error of hit.t */
    double at[3];   /* the exact point, to about 2^-40 of its distance */
    double fuzz;    /* bound on the error of each coordinate of `at` */
    /* In float32: the cross product of the edges divided by its length, on the side that the
     * primary ray came from. */
    float normal[3];
    float dir[3]; /* of the next ray: on that side, roughly cosine-distributed */
};

/* Makes a hit of a ray whose exact nearest hit is truth->prim. False if no renderer would continue
 * from it: a miss, a hit that `tri` misses or answers without a bound on t, a triangle without a
 * normal. Directions less than 1/1000 above the surface are not used. */
bool spawn_hit_make(const struct oracle *oracle, const struct scene *scene,
                    const struct tri_test *tri, const struct ray *ray,
                    const struct oracle_answer *truth, struct rng *rng, struct spawn_hit *out);

/* How the hit point is computed. */
enum spawn_point {
    SPAWN_ALONG,       /* o + t d */
    SPAWN_BARYCENTRIC, /* (1 - u - v) v0 + u v1 + v v2 */
    SPAWN_POINTS
};
const char *spawn_point_name(enum spawn_point point); /* "o+td", "bary" */

/* The point in float32, and a bound on the error of each coordinate. Along the ray it is |d| t_err
 * + u (|t d| + |p|), times 1 + 2^-20. Between the vertices it is gamma_7 times the sum of the sizes
 * of the three products, which bounds the distance to the triangle's plane. Both: Pharr, Jakob and
 * Humphreys, Physically Based Rendering, "Managing Rounding Error". */
void spawn_point_make(const struct spawn_hit *hit, const struct scene *scene,
                      enum spawn_point point, float p[3], float error[3]);

/* Rules, from p, the unit normal n on the side to leave, and the direction.
 * 
 * p + c n. */
void spawn_constant(const float p[3], const float n[3], float c, float out[3]);
/* p + (|n| . error) n, then every coordinate rounded away from p by one float: pbrt's
 * OffsetRayOrigin. */
void spawn_bound(const float p[3], const float error[3], const float n[3], float out[3]);
/* Moves every coordinate by 256 n floats, or by n / 65536 if it is below 1/32: Waechter and Binder,
 * "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems 2019, chapter 6. */
void spawn_integer(const float p[3], const float n[3], float out[3]);
/* p + k s n, where s is the distance of floats at p's largest coordinate. k is the smallest for
 * which the exact ray neither hits its own triangle (t >= 0, ends included) nor starts behind its
 * plane. Every k up to 64 is tried; beyond, k is found by doubling and halving. Returns k, or
 * SPAWN_NEVER if not even 2^23 steps suffice; *out is then p. */
#define SPAWN_NEVER 0xFFFFFFFFu
uint32_t spawn_least(const struct oracle *oracle, const struct scene *scene,
                     const struct spawn_hit *hit, const float p[3], float out[3]);

/* Whether the exact ray from the hit's exact point in its direction meets triangle `prim`. */
enum spawn_meets { SPAWN_MISSES, SPAWN_MEETS, SPAWN_UNDECIDED };

/* Decided in double, including the error of the point. *distance (in space, not in t) is set unless
 * it misses. A triangle that contains the point is undecided. */
enum spawn_meets spawn_meets(const struct scene *scene, const struct spawn_hit *hit, uint32_t prim,
                             double *distance);

/* The first surface that the exact ray meets, if it is nearer than `reach`. */
struct spawn_near {
    uint32_t prim;   /* ABI_NO_PRIM: no surface */
    double distance; /* to it, in space */
    bool undecided;  /* an undecided triangle might be met first, so nothing is known */
};

/* Checks every triangle except the hit's own. */
struct spawn_near spawn_near_find(const struct scene *scene, const struct spawn_hit *hit,
                                  double reach);

/* The fate of a ray spawned at `org`, by the triangle it hits first. */
struct spawn_fate {
    bool self;    /* hits the triangle it left */
    bool beside;  /* hits a triangle that touches its own and that the exact ray certainly misses */
    bool near;    /* on the exact ray, a surface is nearer to the exact point than `org` is */
    bool skipped; /* `near`, but it hits neither that surface, nor a neighbour of it, nor its own */
};

/* The fate for an engine's answer: triangle `prim`, or ABI_NO_PRIM. */
struct spawn_fate spawn_fate_answer(const struct scene *scene, const struct topology *topology,
                                    const struct spawn_hit *hit, const struct spawn_near *near,
                                    const float org[3], uint32_t prim);

/* The fate for the oracle's answer to spawn_ray(hit, org). Its own triangle counts if it is one of
 * several nearest. */
struct spawn_fate spawn_fate_exact(const struct oracle *oracle, const struct scene *scene,
                                   const struct topology *topology, const struct spawn_hit *hit,
                                   const struct spawn_near *near, const float org[3],
                                   const struct oracle_answer *truth);

/* The ray from `org`: tmin 0, tmax 1e30. */
struct ray spawn_ray(const struct spawn_hit *hit, const float org[3]);

/* |org - exact point|. */
double spawn_offset(const struct spawn_hit *hit, const float org[3]);

#endif
