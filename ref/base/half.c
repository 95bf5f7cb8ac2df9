#include "ref/base/half.h"

#include "ref/base/base.h"

#include <stdbool.h>

#define SIGN         0x8000u
#define MIN_NORMAL   0x0400u
#define MAX_FINITE   0x7BFFu
#define INFINITE     0x7C00u
#define F32_INFINITE 0x7F800000u

/* Compares the discarded part with half a unit of the last place kept. */
enum rest {
    REST_ZERO,
    REST_BELOW_HALF,
    REST_HALF,
    REST_ABOVE_HALF,
};

/* A magnitude rounded toward zero. */
struct cut {
    uint16_t bits;
    enum rest rest;
};

static enum rest rest_of(uint32_t cut_off, uint32_t half_unit)
{
    if (cut_off == 0)
        return REST_ZERO;
    if (cut_off == half_unit)
        return REST_HALF;
    return cut_off < half_unit ? REST_BELOW_HALF : REST_ABOVE_HALF;
}

/* `magnitude` is the bits of a float without its sign, not NaN. */
static struct cut cut_magnitude(uint32_t magnitude)
{
    if (magnitude == F32_INFINITE)
        return (struct cut){INFINITE, REST_ZERO};
    if (magnitude >= 0x47800000u) /* 2^16 and more */
        return (struct cut){MAX_FINITE, REST_ABOVE_HALF};
    if (magnitude >= 0x38800000u) /* 2^-14: the exponent is rebiased, 13 bits are discarded */
        return (struct cut){(uint16_t)((magnitude - 0x38000000u) >> 13),
                            rest_of(magnitude & 0x1FFFu, 0x1000u)};
    if (magnitude >= 0x33000000u) { /* 2^-25: the result is a multiple of 2^-24, perhaps zero */
        uint32_t significand = (magnitude & 0x7FFFFFu) | 0x800000u;
        uint32_t shift = 126 - (magnitude >> 23); /* 14 .. 24 */
        uint32_t unit = 1u << shift;
        return (struct cut){(uint16_t)(significand >> shift),
                            rest_of(significand & (unit - 1), unit >> 1)};
    }
    return (struct cut){0, magnitude ? REST_BELOW_HALF : REST_ZERO};
}

static bool is_nan(uint32_t magnitude)
{
    return magnitude > F32_INFINITE;
}

static struct half quiet_nan(uint32_t sign, uint32_t magnitude)
{
    return (struct half){(uint16_t)(sign | INFINITE | 0x200u | ((magnitude >> 13) & 0x3FFu))};
}

static struct half round_toward(float x, bool up)
{
    uint32_t sign = (float_bits(x) >> 16) & SIGN;
    uint32_t magnitude = float_bits(x) & 0x7FFFFFFFu;
    if (is_nan(magnitude))
        return quiet_nan(sign, magnitude);
    struct cut cut = cut_magnitude(magnitude);
    bool away = up == (sign == 0) && cut.rest != REST_ZERO;
    return (struct half){(uint16_t)(sign | (cut.bits + (away ? 1u : 0u)))};
}

struct half half_down(float x)
{
    return round_toward(x, false);
}

struct half half_up(float x)
{
    return round_toward(x, true);
}

struct half half_nearest(float x)
{
    uint32_t sign = (float_bits(x) >> 16) & SIGN;
    uint32_t magnitude = float_bits(x) & 0x7FFFFFFFu;
    if (is_nan(magnitude))
        return quiet_nan(sign, magnitude);
    struct cut cut = cut_magnitude(magnitude);
    bool away = cut.rest == REST_ABOVE_HALF || (cut.rest == REST_HALF && (cut.bits & 1));
    return (struct half){(uint16_t)(sign | (cut.bits + (away ? 1u : 0u)))};
}

static struct half bound_toward(float x, bool up)
{
    if (is_nan(float_bits(x) & 0x7FFFFFFFu))
        return (struct half){(uint16_t)(up ? INFINITE : SIGN | INFINITE)};
    struct half h = round_toward(x, up);
    uint32_t magnitude = h.bits & 0x7FFFu;
    if (magnitude >= MIN_NORMAL)
        return h;
    bool away = magnitude != 0 && up == ((h.bits & SIGN) == 0);
    return (struct half){(uint16_t)(away ? (h.bits & SIGN) | MIN_NORMAL : 0)};
}

struct half half_bound_down(float x)
{
    return bound_toward(x, false);
}

struct half half_bound_up(float x)
{
    return bound_toward(x, true);
}

float half_to_float(struct half h)
{
    uint32_t sign = (uint32_t)(h.bits & SIGN) << 16;
    uint32_t exponent = (h.bits >> 10) & 31;
    uint32_t fraction = h.bits & 0x3FFu;
    if (exponent == 31)
        return float_from_bits(sign | F32_INFINITE | (fraction << 13));
    if (exponent != 0)
        return float_from_bits(sign | ((exponent + 112) << 23) | (fraction << 13));
    if (fraction == 0)
        return float_from_bits(sign);
    /* A subnormal half is a normal float: shifts until the leading one reaches bit 10. */
    exponent = 113;
    while (fraction < 0x400u) {
        fraction <<= 1;
        exponent--;
    }
    return float_from_bits(sign | (exponent << 23) | ((fraction & 0x3FFu) << 13));
}
