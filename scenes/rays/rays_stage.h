/* What the ray sets share: where a scene is, random choices in it, and rays that keep the contract
 * of ray_in_contract whatever the scene's scale. Only exact operations and sqrt are used, so that
 * a ray's bytes are the same on every machine. */
#ifndef RAYS_STAGE_H
#define RAYS_STAGE_H

#include "ref/base/rng.h"
#include "scenes/rays/rays.h"

/* Rays are aimed into the scene's part within +-2^37: the library answers for origins up to 2^40,
 * and sets stand off by up to 1.5 extents. */
#define STAGE_REACH 0x1p37f

/* A set's own random numbers. */
enum stage_tag {
    STAGE_RANDOM = 1,
    STAGE_VERTICES,
    STAGE_EDGES,
    STAGE_CORNERS,
    STAGE_AXIS,
    STAGE_BOUNCE,
    STAGE_RANGES,
    STAGE_INSIDE,
};

struct stage {
    const struct scene *scene;
    struct box box; /* of the scene, cut to +-STAGE_REACH; the unit cube around 0 if it is empty */
    float extent;   /* longest side of the box, or 1 if that is 0 */
    uint64_t base;  /* seed of the set */
};

struct stage stage_make(const struct scene *scene, uint64_t seed, enum stage_tag tag);

/* The random numbers of ray `i`. Neighbouring seeds share nothing. */
struct rng stage_rng(const struct stage *stage, size_t i);

/* Uniform on the unit sphere. */
void stage_direction(struct rng *rng, float dir[3]);

/* A random triangle of the scene; three random corners of the box if the scene has none. */
void stage_triangle(const struct stage *stage, struct rng *rng, float v[3][3]);

/* An origin to aim from: half of them in the box, half on a sphere around it. Snapped ones are
 * multiples of a power of two near extent / 256, so that on a lattice target - origin is exact. */
void stage_origin(const struct stage *stage, struct rng *rng, bool snapped, float org[3]);

/* Puts a point on the nearest multiples of `quantum`, where floats are not coarser than that. */
void stage_snap(float quantum, float p[3]);

/* Moves a target by up to 0, 1e-6 or 1e-3 extents, by turns. Returns true for the first. */
bool stage_jitter(const struct stage *stage, struct rng *rng, size_t turn, float p[3]);

/* Makes a ray with tmin 0 and tmax RAY_TMAX that keeps the contract: `org` is cut to +-2^39; `dir`
 * is scaled by a power of two if its largest component leaves [2^-30, 2^30]; components that are
 * not finite or below 2^-59 of the largest become zero of the same sign; a zero direction becomes
 * +z. Returns the factor s: t of the ray is s times t of the given direction. */
float stage_ray(const float org[3], const float dir[3], struct ray *out);

/* stage_ray from `org` to `target`; returns t at the target (1 unless scaled). */
float stage_aim(const float org[3], const float target[3], struct ray *out);

#endif
