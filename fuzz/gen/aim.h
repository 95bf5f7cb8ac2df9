/* Rays that aim at features that break tracers: vertices, edges, corners and faces of boxes, and
 * the float16 steps that stored bounds are rounded to. Bytes are the same on every machine, see
 * fuzz/gen/gen_sketch.h. */
#ifndef FUZZ_AIM_H
#define FUZZ_AIM_H

#include "ref/abi.h"
#include "ref/base/rng.h"
#include "ref/scene/scene.h"

enum aim_kind {
    AIM_VERTEX,
    AIM_EDGE,
    AIM_CORNER,                /* corner or edge of a box */
    AIM_FACE,                  /* of a box */
    AIM_HALF,                  /* between a bound and the float16 it is rounded to, or on that */
    AIM_FEATURES,              /* the kinds above are aimed at features */
    AIM_INSIDE = AIM_FEATURES, /* of a triangle */
    AIM_RANDOM,
    AIM_AXIS,       /* random, parallel to an axis */
    AIM_GRAZING,    /* in a triangle's plane, or nearly */
    AIM_DEGENERATE, /* zero, subnormal, huge or no numbers; ranges that are empty or backward */
    AIM_KINDS
};

#define AIM_BOXES_MOST 128u
#define AIM_SPLIT_MOST 96u /* triangles of a scene that is split as a tree is */

/* The features of a scene. Does not own it. */
struct aim {
    const struct scene *scene;
    struct box all;  /* of the scene, cut to +-2^37 */
    float centre[3]; /* of that */
    float extent;    /* its longest side; 1 if that is 0 */
    float quantum;   /* a power of two near extent / 256 */
    struct box box[AIM_BOXES_MOST];
    uint32_t box_count; /* >= 1 */
};

/* Finds the features. The boxes of a small scene are those of the tree that splits at the middle of
 * the longest axis down to `leaf` triangles, computed here so that no builder's fault changes what
 * is aimed at; of a large one those of random triangles. */
void aim_make(const struct scene *scene, uint32_t leaf, struct rng *rng, struct aim *out);

/* Makes one ray. `target` receives the point it is aimed at (0, 0, 0 for AIM_RANDOM, AIM_AXIS and
 * AIM_DEGENERATE). All kinds but AIM_DEGENERATE keep ray_in_contract. */
enum aim_kind aim_ray(const struct aim *aim, struct rng *rng, struct ray *out, float target[3]);

/* Makes `count` rays, four of a kind in a row: the kinds' shares are those of aim_ray. */
void aim_rays(const struct aim *aim, struct rng *rng, struct ray *out, uint32_t count);

#endif
