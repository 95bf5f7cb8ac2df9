/* Rays that start on a surface: hit points as renderers compute them in float32, the rules by which
 * renderers move the next ray's origin off the surface, and what the exact ray from the exact point
 * would have met. */
#ifndef SPAWN_H
#define SPAWN_H

#include "ref/oracle/oracle.h"
#include "ref/primitives/primitives.h"
#include "ref/base/rng.h"
#include "ref/scene/topology.h"

/* A hit, and the ray that is to leave it. */
struct spawn_hit {
    struct ray primary;
    struct hit hit;  /* as a float32 triangle test answers for the exact nearest triangle */
    double t_err;    /* proven bound on the error of hit.t */
    double at[3];    /* the exact point, to about 2^-40 of its distance */
    double fuzz;     /* no coordinate of `at` is further off than this */
    float normal[3]; /* float32: cross product of the edges, divided by its length, on the side
                        that the primary ray came from */
    float dir[3];    /* where the next ray goes: on that side, about cosine-distributed */
};

/* Makes a hit of a ray whose exact nearest hit is truth->prim. False if there is none that a
 * renderer would go on from: a miss, a hit that `tri` misses or answers with no bounded t, a
 * triangle without a normal. Directions less than 1/1000 above the surface are not taken. */
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

/* The point in float32, and a bound on how far each coordinate is off: along the ray
 * |d| t_err + u (|t d| + |p|), times 1 + 2^-20; between the vertices gamma_7 times the sum of the
 * sizes of the three products, which bounds how far the triangle's plane is (both: Pharr, Jakob and
 * Humphreys, Physically Based Rendering, "Managing Rounding Error"). */
void spawn_point_make(const struct spawn_hit *hit, const struct scene *scene,
                      enum spawn_point point, float p[3], float error[3]);

/* Rules: from p, the unit normal n on the side to leave, and the direction.
 *
 * p + c n. */
void spawn_constant(const float p[3], const float n[3], float c, float out[3]);
/* p + (|n| . error) n, every coordinate then rounded away from p by one float: pbrt's
 * OffsetRayOrigin. */
void spawn_bound(const float p[3], const float error[3], const float n[3], float out[3]);
/* Every coordinate moved by 256 n floats, or by n / 65536 where it is below 1/32: Waechter and
 * Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems 2019,
 * chapter 6. */
void spawn_integer(const float p[3], const float n[3], float out[3]);
/* p + k s n with s the distance of floats at p's largest coordinate, and the smallest k for which
 * the exact ray neither hits its own triangle (t >= 0, ends included) nor starts behind its plane:
 * every k up to 64 is tried, beyond it is found by doubling and halving. Returns k, or SPAWN_NEVER
 * if not even 2^23 steps suffice; *out is then p. */
#define SPAWN_NEVER 0xFFFFFFFFu
uint32_t spawn_least(const struct oracle *oracle, const struct scene *scene,
                     const struct spawn_hit *hit, const float p[3], float out[3]);

/* Whether the exact ray from the hit's exact point along its direction meets triangle `prim`. */
enum spawn_meets { SPAWN_MISSES, SPAWN_MEETS, SPAWN_UNDECIDED };

/* Decided in double with the point's own error carried along; *distance (in space, not in t) is set
 * unless it misses. A triangle that the point lies on is undecided. */
enum spawn_meets spawn_meets(const struct scene *scene, const struct spawn_hit *hit, uint32_t prim,
                             double *distance);

/* The first surface that the exact ray meets, if it is nearer than `reach`. */
struct spawn_near {
    uint32_t prim;   /* ABI_NO_PRIM: none */
    double distance; /* to it, in space */
    bool undecided;  /* some triangle might be met before it: nothing is known */
};

/* Looks at every triangle but the hit's own. */
struct spawn_near spawn_near_find(const struct scene *scene, const struct spawn_hit *hit,
                                  double reach);

/* What became of a ray that was spawned at `org`, by the triangle that it hits first. */
struct spawn_fate {
    bool self;    /* the one that it left */
    bool beside;  /* one that touches its own and that the exact ray certainly misses */
    bool near;    /* there is a surface nearer to the exact point than `org` is, on the exact way */
    bool skipped; /* and the ray hits neither that one nor one that touches it, nor its own */
};

/* By what an engine answered: the triangle `prim`, or ABI_NO_PRIM. */
struct spawn_fate spawn_fate_answer(const struct scene *scene, const struct topology *topology,
                                    const struct spawn_hit *hit, const struct spawn_near *near,
                                    const float org[3], uint32_t prim);

/* By the oracle's answer for spawn_ray(hit, org); its own triangle counts if it is one of several
 * nearest. */
struct spawn_fate spawn_fate_exact(const struct oracle *oracle, const struct scene *scene,
                                   const struct topology *topology, const struct spawn_hit *hit,
                                   const struct spawn_near *near, const float org[3],
                                   const struct oracle_answer *truth);

/* The ray from `org`: tmin 0, tmax 1e30. */
struct ray spawn_ray(const struct spawn_hit *hit, const float org[3]);

/* |org - exact point|. */
double spawn_offset(const struct spawn_hit *hit, const float org[3]);

#endif
