/* The numbers of the grid family: formats of a bound's code, and frames in which codes count. What
 * a code stands for is computed in float32, with the same operations as in shaders/grid.glsl, and
 * exactly but for one sum; what is stored is chosen by exact arithmetic. */
#ifndef GRID_NUMBER_H
#define GRID_NUMBER_H

#include "ref/base/base.h"
#include "ref/tree/bvh.h"

/* A format. Codes that are stored are 0, `first` to `last`, and those with the sign's bit: neither
 * subnormal nor infinite, nor -0. */
struct number_format {
    const char *name;
    uint32_t id;   /* ABI_NUMBER_* */
    uint32_t bits; /* of a code */
    uint32_t sign; /* its bit; 0: there are no negative numbers */
    uint32_t first, last;
    int top;        /* the largest number is 2^top or more, and below 2^(top + 1) */
    int scale_low;  /* exponents of a frame's scale: from there on nothing that is stored */
    int scale_high; /* is subnormal when scaled */
    float (*number)(uint32_t code); /* any code of that many bits; exact */
};

extern const struct number_format number_f32, number_f16, number_bf16;
extern const struct number_format number_u8, number_u10, number_u12, number_u16;

/* NULL-terminated: these. */
extern const struct number_format *const number_formats[];

/* Bounds in a frame are at most 2^126 in magnitude: twice that is finite. */
#define NUMBER_FRAME_MOST 126

/* Where a code's number x stands on axis k: at fl(origin + x * 2^scale). The product is exact and
 * the origin no subnormal; of a number that is stored, nor is the sum. */
struct number_frame {
    float origin[3];
    uint32_t scale[3]; /* biased exponents of float32, 1 to 254 */
};

/* The bound that a code stands for; frame NULL: the number itself. */
float number_decode(const struct number_format *format, const struct number_frame *frame, int axis,
                    uint32_t code);

/* The code of the largest bound that is at most `bound`, or, `up`, of the smallest that is at least
 * it: exactly, before the sum is rounded, so that it is either way true of what is decoded (design:
 * any faithful rounding of a sum that is at most a float is at most that float). False: there is
 * none. `bound` is finite. */
bool number_encode(const struct number_format *format, const struct number_frame *frame, int axis,
                   float bound, bool up, uint32_t *code) MUST_USE;

/* The frame with the smallest scales in which both bounds of `box` on each axis have codes; of a
 * format without negative numbers it begins at the lower bound, else it is around the middle.
 * False: there is none, for a bound beyond 2^NUMBER_FRAME_MOST in magnitude. */
bool number_frame_make(const struct number_format *format, const struct box *box,
                       struct number_frame *out) MUST_USE;

#endif
