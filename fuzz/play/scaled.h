/* A trial at another scale; of a world meshes and translations are scaled. Scaling scene and origin
 * by a power of two, and the direction by another, changes no bit of a mantissa, every t by a power
 * of two, and no truth; nor does it if each axis has a power of its own. An engine that is wrong at
 * one scale alone has a constant that does not scale, or underflows. This works with any engine,
 * also with one whose source is not known. */
#ifndef FUZZ_SCALED_H
#define FUZZ_SCALED_H

#include "fuzz/play/trial.h"

enum fuzz_scaling {
    FUZZ_SCALE_ALL,  /* the axes alike */
    FUZZ_SCALE_AXES, /* each by itself: a scene that is flat near 2^-100, say, is flat no more */
    FUZZ_SCALINGS
};

#define FUZZ_SCALE_STEPS 16u /* from a trial as it is to one scaled as far as can be */

/* The trial with ray `ray` alone, scaled up `step` of FUZZ_SCALE_STEPS of the way to as far as rays
 * and scenes are answered for (2^40), its range likewise; a tmax beyond the largest float becomes
 * infinite. *power: each t is times two to that.
 * *possible: whether that is another trial, of a ray in contract. Else *out is zero.
 * Errors: STATUS_MEMORY. */
enum status fuzz_trial_scaled(const struct fuzz_trial *trial, uint32_t ray,
                              enum fuzz_scaling scaling, uint32_t step, struct fuzz_trial *out,
                              int *power, bool *possible, struct reason *reason) MUST_USE;

/* Whether FUZZ_SCALE_AXES can show more than FUZZ_SCALE_ALL: no instance is scaled or turned, and
 * some number of the positions or of the direction is less than 2^-12 of the largest. Otherwise
 * differences are at least 2^-36 of it, so that the axes alike bring them all far above any
 * constant and underflow; what axes of their own then cure is wrong by the shape, which they
 * change: angles, and ratios of lengths. */
bool fuzz_trial_is_uneven(const struct fuzz_trial *trial, uint32_t ray);

/* Whether an answer is the other one, scaled: the same triangle, u and v, and t times 2^power. Then
 * the engine's answer does not depend on the scale. */
bool fuzz_hit_is_scaled(const struct hit *hit, const struct hit *scaled, int power);

#endif
