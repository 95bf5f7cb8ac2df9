/* Legal evaluations: the triangle tests computed as badly as a rounding (ref/twin/model.h) allows,
 * each operation by choice. Written anew, from the descriptions, with the decisions that the
 * engines make; for tests of the twins. */
#ifndef TESTS_LEGAL_H
#define TESTS_LEGAL_H

#include "ref/twin/model.h"
#include "ref/base/rng.h"
#include "ref/twin/twin_placed.h"
#include "ref/primitives/test_run.h"

/* More operations than any formula has. */
#define LEGAL_MOST 256

/* One operation's choices. */
#define LEGAL_LOW     1u  /* the least result allowed, else the nearest */
#define LEGAL_HIGH    2u  /* the greatest */
#define LEGAL_FLUSH_A 4u  /* a subnormal first operand is taken for zero, if subnormals may be */
#define LEGAL_FLUSH_B 8u  /* the second */
#define LEGAL_FLUSH   16u /* a subnormal result */
#define LEGAL_FUSE    32u /* a product is not rounded before it is added, if that is allowed */

enum legal_style {
    LEGAL_ALL_NEAREST,
    LEGAL_ALL_LOW,
    LEGAL_ALL_HIGH,
    LEGAL_RANDOM,
    LEGAL_ALIKE,  /* the same operation of the same numbers gives the same result, as `seed` says */
    LEGAL_CHOSEN, /* as `choice` says */
};

struct legal {
    struct rounding rounding;
    bool fuses;
    enum legal_style style;
    struct rng rng;
    uint64_t seed;
    uint32_t count; /* operations of the last evaluation */
    uint8_t choice[LEGAL_MOST];
};

struct evaluation {
    float edge[3]; /* opposite vertex i; inside, all have one sign */
    float t, u, v;
    bool accepted; /* signs, determinant and range of the ray */
};

/* Evaluates one triangle. */
struct evaluation legal_evaluate(struct legal *legal, enum twin_formula formula,
                                 const struct ray *ray, float v[3][3]);

/* The same of a triangle that is placed, the ray being one of the world; NULL: not placed. */
struct evaluation legal_evaluate_placed(struct legal *legal, enum twin_formula formula,
                                        const struct twin_place *place, const struct ray *ray,
                                        float v[3][3]);

/* The ray in the space of the mesh. */
struct ray legal_transform(struct legal *legal, const struct twin_place *place,
                           const struct ray *ray);

/* One operation, for formulas elsewhere. */
float legal_add(struct legal *legal, float a, float b);
float legal_mul(struct legal *legal, float a, float b);
float legal_div(struct legal *legal, float a, float b);
float legal_multiply_add(struct legal *legal, float a, float b, float c); /* a b + c */

/* The places of a triangle's vertices that woop computes across the ray; r has the axes. */
void legal_woop_shear(struct legal *legal, const struct tri_ray *r, float v[3][3], float x[3],
                      float y[3], float z[3]);

#endif
