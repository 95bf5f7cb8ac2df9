/* Four floats at a time, three of them used by boxes: the arithmetic of the fast builders. The
 * operations and their order are the same with and without SSE, so the trees are the same. */
#ifndef LANES_H
#define LANES_H

#include "ref/scene/scene.h"

#include <math.h>
#include <stdint.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

typedef float lanes __attribute__((vector_size(16)));
typedef int32_t lanes_int __attribute__((vector_size(16)));

/* A box as two vectors; the fourth lane of each is anything but NaN. */
struct lane_box {
    lanes lo, hi;
};

static inline lanes lanes_all(float x)
{
    return (lanes){x, x, x, x};
}

/* Selects `yes` where mask is ~0, `no` where it is 0. */
static inline lanes lanes_select(lanes_int mask, lanes yes, lanes no)
{
    return (lanes)(((lanes_int)yes & mask) | ((lanes_int)no & ~mask));
}

static inline lanes lanes_min(lanes a, lanes b)
{
#ifdef __SSE2__
    return (lanes)_mm_min_ps((__m128)a, (__m128)b);
#else
    return lanes_select(a < b, a, b);
#endif
}

static inline lanes lanes_max(lanes a, lanes b)
{
#ifdef __SSE2__
    return (lanes)_mm_max_ps((__m128)a, (__m128)b);
#else
    return lanes_select(a > b, a, b);
#endif
}

/* Truncates; every lane must fit an int32_t. */
static inline lanes_int lanes_to_int(lanes x)
{
#ifdef __SSE2__
    return (lanes_int)_mm_cvttps_epi32((__m128)x);
#else
    return (lanes_int){(int32_t)x[0], (int32_t)x[1], (int32_t)x[2], (int32_t)x[3]};
#endif
}

static inline struct lane_box lane_box_empty(void)
{
    return (struct lane_box){lanes_all(FLT_MAX), lanes_all(-FLT_MAX)};
}

static inline void lane_box_add(struct lane_box *box, const struct lane_box *other)
{
    box->lo = lanes_min(box->lo, other->lo);
    box->hi = lanes_max(box->hi, other->hi);
}

static inline struct box lane_box_store(const struct lane_box *box)
{
    return (struct box){{box->lo[0], box->lo[1], box->lo[2]}, {box->hi[0], box->hi[1], box->hi[2]}};
}

static inline struct lane_box lane_box_load(const struct box *box)
{
    return (struct lane_box){{box->lo[0], box->lo[1], box->lo[2], 1},
                             {box->hi[0], box->hi[1], box->hi[2], 1}};
}

/* Half the area of a box with these sides. */
static inline float lanes_half_area(lanes side)
{
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* Half the area of a box in double, as box_half_area. */
static inline double lane_box_half_area(const struct lane_box *box)
{
    double x = (double)box->hi[0] - (double)box->lo[0];
    double y = (double)box->hi[1] - (double)box->lo[1];
    double z = (double)box->hi[2] - (double)box->lo[2];
    return x * y + y * z + z * x;
}

/* Half a box's sides: halved first, as the difference of two floats can overflow; 0 if empty. */
static inline lanes lane_box_reach(const struct lane_box *box)
{
    lanes half = lanes_all(0.5f);
    return lanes_max(box->hi * half - box->lo * half, lanes_all(0));
}

/* Returns a factor that scales the longest of three sides to 1, so that areas neither overflow nor
 * vanish at any scale; finite also for a box without extent. */
static inline float lanes_unit(lanes reach)
{
    float most = reach[0] > reach[1] ? reach[0] : reach[1];
    most = most > reach[2] ? most : reach[2];
    float unit = 1 / most;
    return unit < FLT_MAX ? unit : FLT_MAX;
}

/* Returns a power of two that scales all coordinates of a box to at most 1, exactly unless they are
 * far smaller than the largest; then areas neither overflow nor vanish. */
static inline float lanes_scale(const struct lane_box *box)
{
    float most = 0;
    int exponent;
    for (int k = 0; k < 3; k++)
        most = fmaxf(most, fmaxf(fabsf(box->lo[k]), fabsf(box->hi[k])));
    (void)frexpf(most, &exponent);
    return ldexpf(1, exponent < -126 ? 126 : -exponent);
}

#endif
