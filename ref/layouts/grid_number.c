#include "ref/layouts/grid_number.h"

#include "ref/abi.h"
#include "ref/base/half.h"

#include <float.h>
#include <math.h>

#define BIAS 127

/* --- formats ---------------------------------------------------------------------------------- */

static float f32_number(uint32_t code)
{
    return float_from_bits(code);
}

static float f16_number(uint32_t code)
{
    return half_to_float((struct half){(uint16_t)code});
}

/* The upper half of a float32. */
static float bf16_number(uint32_t code)
{
    return float_from_bits(code << 16);
}

static float whole_number(uint32_t code)
{
    return (float)code;
}

#define UNORM(n)                                                                                   \
    {                                                                                              \
        .name = "u" #n, .id = ABI_NUMBER_U##n, .bits = n, .first = 1, .last = (1u << n) - 1,       \
        .top = n - 1, .scale_low = -126, .number = whole_number                                    \
    }

#define FLOATS(n, N, width, sign_bit, least, most, exponent, low)                                  \
    {                                                                                              \
        .name = #n, .id = ABI_NUMBER_##N, .bits = width, .sign = sign_bit, .first = least,         \
        .last = most, .top = exponent, .scale_low = low, .number = n##_number                      \
    }

const struct number_format number_f32 =
    FLOATS(f32, F32, 32, 0x80000000u, 0x00800000u, 0x7F7FFFFFu, 127, 0);
const struct number_format number_f16 = FLOATS(f16, F16, 16, 0x8000u, 0x0400u, 0x7BFFu, 15, -112);
/* The range is that of float32: a scale would only make numbers subnormal or infinite. */
const struct number_format number_bf16 = FLOATS(bf16, BF16, 16, 0x8000u, 0x0080u, 0x7F7Fu, 127, 0);
const struct number_format number_u8 = UNORM(8), number_u10 = UNORM(10);
const struct number_format number_u12 = UNORM(12), number_u16 = UNORM(16);

const struct number_format *const number_formats[] = {
    &number_f32, &number_f16, &number_bf16, &number_u8, &number_u10, &number_u12, &number_u16, NULL,
};

/* --- decoding --------------------------------------------------------------------------------- */

static float scale_of(const struct number_frame *frame, int axis)
{
    return float_from_bits(frame->scale[axis] << 23);
}

float number_decode(const struct number_format *format, const struct number_frame *frame, int axis,
                    uint32_t code)
{
    float number = format->number(code);
    if (!frame)
        return number;
    float scaled = number * scale_of(frame, axis);
    return frame->origin[axis] + scaled;
}

/* --- encoding --------------------------------------------------------------------------------- */

/* Codes in the order of their numbers: rank 0 is zero. */
static int64_t most_rank(const struct number_format *format)
{
    return (int64_t)format->last - format->first + 1;
}

static int64_t least_rank(const struct number_format *format)
{
    return format->sign ? -most_rank(format) : 0;
}

static uint32_t code_of(const struct number_format *format, int64_t rank)
{
    if (rank == 0)
        return 0;
    if (rank > 0)
        return (uint32_t)(rank - 1) + format->first;
    return format->sign | ((uint32_t)(-rank - 1) + format->first);
}

/* The exact number at a rank as the sum of two doubles; the first is the rounded sum (Knuth 1969,
 * two-sum; nothing overflows). */
struct number_exact {
    double sum, rest;
};

static struct number_exact exact_at(const struct number_format *format,
                                    const struct number_frame *frame, int axis, int64_t rank)
{
    double x = (double)format->number(code_of(format, rank));
    if (!frame)
        return (struct number_exact){x, 0};
    x *= (double)scale_of(frame, axis);
    double a = (double)frame->origin[axis], sum = a + x;
    double b = sum - a;
    return (struct number_exact){sum, (a - (sum - b)) + (x - b)};
}

static bool is_at_least(struct number_exact value, double bound, bool equal_too)
{
    if (value.sum != bound)
        return value.sum > bound;
    return equal_too ? value.rest >= 0 : value.rest > 0;
}

/* Returns a rank, near the bound if possible: it only affects the time of the search. */
static int64_t near_rank(const struct number_format *format, const struct number_frame *frame,
                         int axis, double bound)
{
    double x =
        frame ? (bound - (double)frame->origin[axis]) / (double)scale_of(frame, axis) : bound;
    double most = (double)format->number(format->last);
    double size = fabs(x) < most ? fabs(x) : most;
    int64_t rank = format->sign ? 0 : (int64_t)size;
    if (format->sign) { /* its numbers are evenly spaced in the bits of float32 */
        uint32_t first = float_bits(format->number(format->first));
        uint32_t step = float_bits(format->number(format->first + 1)) - first;
        uint32_t bits = float_bits((float)size);
        rank = bits < first ? 0 : 1 + (bits - first) / step;
    }
    return x < 0 ? -rank : rank;
}

/* Finds the first rank whose number is at least `bound`, or above it unless `equal_too`; most_rank
 * + 1: none. The search begins at a rank beside it. */
static int64_t first_rank(const struct number_format *format, const struct number_frame *frame,
                          int axis, double bound, bool equal_too)
{
    int64_t least = least_rank(format), none = most_rank(format) + 1;
    int64_t at = near_rank(format, frame, axis, bound);
    at = at < least ? least : at > none ? none : at;
    while (at < none && !is_at_least(exact_at(format, frame, axis, at), bound, equal_too))
        at++;
    while (at > least && is_at_least(exact_at(format, frame, axis, at - 1), bound, equal_too))
        at--;
    return at;
}

static bool is_subnormal(double x)
{
    return x != 0 && fabs(x) < (double)FLT_MIN;
}

bool number_encode(const struct number_format *format, const struct number_frame *frame, int axis,
                   float bound, bool up, uint32_t *code)
{
    double target = (double)bound;
    *code = 0;
    /* A device may flush a subnormal to 0, which is inward for one of the two signs. A subnormal is
     * replaced by the next bound outward, at most twice. */
    for (;;) {
        int64_t rank = first_rank(format, frame, axis, target, up);
        rank -= up ? 0 : 1;
        if (rank < least_rank(format) || rank > most_rank(format))
            return false;
        double value = exact_at(format, frame, axis, rank).sum;
        *code = code_of(format, rank);
        if (!is_subnormal(value))
            return true;
        if (up)
            target = signbit(value) ? 0 : (double)FLT_MIN;
        else
            target = signbit(value) ? -(double)FLT_MIN : 0;
    }
}

/* --- frames ----------------------------------------------------------------------------------- */

/* Rounds a subnormal bound outward; never returns -0. */
static float normal_bound(float bound, bool up)
{
    if (!is_subnormal((double)bound))
        return bound + 0.0f;
    if (up == (signbit(bound) != 0))
        return 0;
    return up ? FLT_MIN : -FLT_MIN;
}

/* Bounds in a frame are finite twice over, so that every format has a scale that holds them. */
static void make_axis(const struct number_format *format, float lo, float hi, int axis,
                      struct number_frame *out)
{
    uint32_t code;
    double middle = (double)lo / 2 + (double)hi / 2;
    float origin = format->sign ? (float)middle : lo;
    out->origin[axis] = is_subnormal((double)origin) ? 0 : origin + 0.0f;
    double extent = fmax((double)hi - (double)origin, (double)origin - (double)lo);
    int scale = format->scale_low;
    if (extent > 0 && ilogb(extent) - format->top - 1 > scale)
        scale = ilogb(extent) - format->top - 1;
    for (;; scale++) {
        out->scale[axis] = (uint32_t)(scale + BIAS);
        if (number_encode(format, out, axis, lo, false, &code) &&
            number_encode(format, out, axis, hi, true, &code))
            return;
    }
}

bool number_frame_make(const struct number_format *format, const struct box *box,
                       struct number_frame *out)
{
    float most = ldexpf(1, NUMBER_FRAME_MOST);
    *out = (struct number_frame){0};
    for (int k = 0; k < 3; k++) {
        float lo = normal_bound(box->lo[k], false), hi = normal_bound(box->hi[k], true);
        if (!(lo >= -most && lo <= hi && hi <= most))
            return false;
        make_axis(format, lo, hi, k, out);
    }
    return true;
}
