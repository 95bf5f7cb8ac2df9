/* Numbers of the grid family: formats of a bound's code, and frames that scale codes. Decoding uses
 * float32, with the same operations as in shaders/grid.glsl, and is exact except for one sum. Codes
 * to be stored are chosen by exact arithmetic. */
#ifndef GRID_NUMBER_H
#define GRID_NUMBER_H

#include "ref/base/base.h"
#include "ref/tree/bvh.h"

/* A format. Stored codes are 0, `first` to `last`, and those with the sign bit: neither subnormal
 * nor infinite, nor -0. */
struct number_format {
    const char *name;
    uint32_t id;   /* ABI_NUMBER_* */
    uint32_t bits; /* per code */
    uint32_t sign; /* the sign bit; 0: no negative numbers */
    uint32_t first, last;
    int top;                        /* the largest number is 2^top or more, and below 2^(top + 1) */
    int scale_low;                  /* least exponent of a frame's scale: stored numbers are not
                                     * subnormal when scaled */
    float (*number)(uint32_t code); /* any code of `bits` bits; exact */
};

extern const struct number_format number_f32, number_f16, number_bf16;
extern const struct number_format number_u8, number_u10, number_u12, number_u16;

/* NULL-terminated: the formats above. */
extern const struct number_format *const number_formats[];

/* Bounds in a frame are at most 2^126 in magnitude: twice that is finite. */
#define NUMBER_FRAME_MOST 126

/* A code's number x decodes to fl(origin + x * 2^scale) on axis k. The product is exact and the
 * origin not subnormal; the sum of a stored code is not subnormal either. */
struct number_frame {
    float origin[3];
    uint32_t scale[3]; /* biased exponents of float32, 1 to 254 */
};

/* Returns the bound of a code; frame NULL: the number itself. */
float number_decode(const struct number_format *format, const struct number_frame *frame, int axis,
                    uint32_t code);

/* Finds the code of the largest bound that is at most `bound` or, if `up`, of the smallest that is
 * at least `bound`. It compares exact sums, before they are rounded. The relation also holds for
 * the decoded value: any faithful rounding of a sum that is at most a float is at most that float.
 * Returns false if there is no such code. `bound` must be finite. */
bool number_encode(const struct number_format *format, const struct number_frame *frame, int axis,
                   float bound, bool up, uint32_t *code) MUST_USE;

/* Finds the frame with the smallest scales in which both bounds of `box` on each axis have codes.
 * For a format without negative numbers it begins at the lower bound, else it is centred on the
 * box. Returns false if there is none, for a bound beyond 2^NUMBER_FRAME_MOST in magnitude. */
bool number_frame_make(const struct number_format *format, const struct box *box,
                       struct number_frame *out) MUST_USE;

#endif
