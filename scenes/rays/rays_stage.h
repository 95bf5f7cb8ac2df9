/* Shared by the ray sets: the extent of a scene, random choices in it, and rays that keep the
 * contract of ray_in_contract at any scale of the scene. Only exact operations and sqrt are used,
 * so that the bytes of a ray are the same on every machine. */
#ifndef RAYS_STAGE_H
#define RAYS_STAGE_H

#include "ref/base/rng.h"
#include "scenes/rays/rays.h"

/* Rays are aimed at the part of the scene within +-2^37: the library supports origins up to 2^40,
 * and sets place origins up to 1.5 extents away. */
#define STAGE_REACH 0x1p37f

/* Seeds of the sets' random numbers. */
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
    struct box box; /* of the scene, clamped to +-STAGE_REACH; the unit cube around 0 if the scene
                     * is empty */
    float extent;   /* longest side of the box, or 1 if that is 0 */
    uint64_t base;  /* seed of the set */
};

struct stage stage_make(const struct scene *scene, uint64_t seed, enum stage_tag tag);

/* The random numbers of ray `i`. Neighbouring seeds have unrelated sequences. */
struct rng stage_rng(const struct stage *stage, size_t i);

/* A uniform random point on the unit sphere. */
void stage_direction(struct rng *rng, float dir[3]);

/* Picks a random triangle of the scene, or three random corners of the box if the scene has
 * none. */
void stage_triangle(const struct stage *stage, struct rng *rng, float v[3][3]);

/* A random origin to aim from: half of them in the box, half on a sphere around it. `snapped` ones
 * are multiples of a power of two near extent / 256, so that target - origin is exact on a
 * lattice. */
void stage_origin(const struct stage *stage, struct rng *rng, bool snapped, float org[3]);

/* Moves a point to the nearest multiples of `quantum`, except for coordinates where floats are
 * coarser. */
void stage_snap(float quantum, float p[3]);

/* Moves a target by up to 0, 1e-6 or 1e-3 extents, depending on turn % 3. Returns true if it was
 * not moved. */
bool stage_jitter(const struct stage *stage, struct rng *rng, size_t turn, float p[3]);

/* Makes a ray with tmin 0 and tmax RAY_TMAX that keeps the contract. `org` is clamped to +-2^39.
 * `dir` is scaled by a power of two if its largest component is outside [2^-30, 2^30). Components
 * that are not finite or below 2^-59 of the largest become zero of the same sign; a zero direction
 * becomes +z. Returns the factor s: t of the ray is s times t of the given direction. */
float stage_ray(const float org[3], const float dir[3], struct ray *out);

/* As stage_ray, from `org` to `target`. Returns t at the target (1 unless scaled). */
float stage_aim(const float org[3], const float target[3], struct ray *out);

#endif
