/* Numbers of the grid family (ref/layouts/grid_number.h) by integers: the code of a bound in a
 * frame and the frame of a node, compared exactly. Numbers are bits of finite floats. */
#ifndef BUILD_NUMBER_GLSL
#define BUILD_NUMBER_GLSL

#include "ref/abi_build.h"
#include "build_axis.glsl"

#define SIGN       0x80000000u
#define NORMAL     0x00800000u /* bits of 2^-126, the least normal number */
#define FRAME_MOST 0x7E800000u /* bits of 2^126 */
#define STEPS_MOST 0x100000    /* 2^20 */

/* --- formats ---------------------------------------------------------------------------------- */

struct number_format {
    uint bits;     /* of a code */
    uint fraction; /* of these, in a format with signs; 0: whole numbers */
    uint last;     /* the largest code without a sign */
    int bias;      /* of exponents */
    int top;       /* the largest number is 2^top or more */
    int scale_low; /* least exponent of a frame's scale */
};

number_format format_of(uint number)
{
    switch (number) {
    case ABI_NUMBER_F32:
        return number_format(32u, 23u, 0x7F7FFFFFu, 127, 127, 0);
    case ABI_NUMBER_F16:
        return number_format(16u, 10u, 0x7BFFu, 15, 15, -112);
    case ABI_NUMBER_BF16:
        return number_format(16u, 7u, 0x7F7Fu, 127, 127, 0);
    case ABI_NUMBER_U8:
        return number_format(8u, 0u, 255u, 0, 7, -126);
    case ABI_NUMBER_U10:
        return number_format(10u, 0u, 1023u, 0, 9, -126);
    case ABI_NUMBER_U12:
        return number_format(12u, 0u, 4095u, 0, 11, -126);
    default:
        return number_format(16u, 0u, 65535u, 0, 15, -126);
    }
}

/* --- exact sums ------------------------------------------------------------------------------- */

/* An integer of 64 bits, or what lies between it and the next, times 2^unit. */
struct exact {
    uint high, low;
    bool between;
    int unit;
};

exact negated(exact x)
{
    x.low = ~x.low;
    x.high = ~x.high;
    if (!x.between) { /* else it lies between the negated next and this */
        x.low += 1u;
        x.high += x.low == 0u ? 1u : 0u;
    }
    return x;
}

/* A number times 2^-unit; the unit is at least its own, less 32. */
exact in_unit(uint bits, int unit)
{
    uint units = bits_units(bits), by = uint(min(unit - bits_unit(bits) + 32, 63));
    exact x = exact(units, 0u, false, unit);
    if (by > 32u) {
        x.high = 0u;
        x.low = units >> (by - 32u);
        x.between = (units & ((1u << (by - 32u)) - 1u)) != 0u;
    } else if (by > 0u) {
        x.high = by < 32u ? units >> by : 0u;
        x.low = units << (32u - by);
    }
    return (bits & SIGN) != 0u ? negated(x) : x;
}

exact sum_of(uint a, uint b)
{
    int unit = max(bits_unit(a), bits_unit(b)) - 32;
    exact x = in_unit(a, unit), y = in_unit(b, unit); /* the one of the larger unit has low 0 */
    return exact(x.high + y.high, x.low | y.low, x.between || y.between, unit);
}

bool is_negative(exact x)
{
    return (x.high & SIGN) != 0u;
}

/* Without the sign; rounded down. */
exact magnitude_of(exact x)
{
    return is_negative(x) ? negated(x) : x;
}

/* The highest bit of a magnitude; -1: there is none. */
int top_bit(exact x)
{
    return x.high != 0u ? 32 + findMSB(x.high) : findMSB(x.low);
}

/* Half, often, rounded down. */
exact shifted(exact x, uint by)
{
    x.unit += int(min(by, 1000u));
    if (by >= 32u) {
        uint more = min(by - 32u, 31u);
        x.between = x.between || x.low != 0u || (x.high & ((1u << more) - 1u)) != 0u;
        x.low = uint(int(x.high) >> more);
        x.high = uint(int(x.high) >> 31);
    } else if (by > 0u) {
        x.between = x.between || (x.low & ((1u << by) - 1u)) != 0u;
        x.low = x.low >> by | x.high << (32u - by);
        x.high = uint(int(x.high) >> by);
    }
    return x;
}

/* --- codes ------------------------------------------------------------------------------------ */

/* The last multiple of 2^exponent that is at most x, or the first that is at least it, if it is
 * less than STEPS_MOST. */
int whole_of(exact x, int exponent, bool up)
{
    int by = exponent - x.unit;
    x = shifted(x, uint(max(by, 0)));
    int whole = int(x.low), most = by >= 0 ? STEPS_MOST : by > -20 ? STEPS_MOST >> uint(-by) : 0;
    if (x.high != uint(whole >> 31) || whole > most || whole < -most)
        return is_negative(x) ? -STEPS_MOST : STEPS_MOST;
    whole <<= uint(clamp(-by, 0, 20));
    return up && x.between ? whole + 1 : whole;
}

bool whole_code(number_format format, exact x, int exponent, bool up, out uint code)
{
    int whole = whole_of(x, exponent, up);
    code = uint(clamp(whole, 0, int(format.last)));
    return up ? whole <= int(format.last) : whole >= 0;
}

/* A code with a sign, an exponent and a fraction. */
bool signed_code(number_format format, exact x, int exponent, bool up, out uint code)
{
    bool away = is_negative(x) != up;
    exact size = magnitude_of(x);
    int top = top_bit(size), biased = top + size.unit - exponent + format.bias;
    int by = top - int(format.fraction);
    code = 0u;
    if (top < 0)
        return true;
    if (biased < 1) {
        code = away ? 1u << format.fraction : 0u;
    } else if (biased > 254) {
        code = format.last + 1u;
    } else {
        size = shifted(size, uint(max(by, 0)));
        size.low <<= uint(max(-by, 0));
        code = (uint(biased - 1) << format.fraction) + size.low;
        code += away && size.between ? 1u : 0u;
    }
    bool beyond = code > format.last;
    code = min(code, format.last);
    if (is_negative(x) && code != 0u)
        code |= 1u << (format.bits - 1u);
    return !(beyond && away);
}

/* Bits of the number of a code, times 2^exponent. */
uint bits_of_code(number_format format, uint code, int exponent)
{
    if (code == 0u)
        return 0u;
    if (format.fraction == 0u) {
        int top = findMSB(code);
        return uint(exponent + top + 127) << 23 | ((code << uint(23 - top)) & 0x7FFFFFu);
    }
    uint sign = code >> (format.bits - 1u), size = code & ((1u << (format.bits - 1u)) - 1u);
    return sign << 31 |
           ((size << (23u - format.fraction)) + (uint(127 - format.bias + exponent) << 23));
}

/* True if a sum is subnormal. */
bool is_subnormal(exact x)
{
    int top = top_bit(magnitude_of(x));
    return top >= 0 && top + x.unit < -126;
}

/* The code of a bound in an axis of a frame, rounded outward, as number_encode; false: none. */
bool framed_code(number_format format, uint origin, int exponent, uint bound, bool up,
                 out uint code)
{
    code = 0u;
    for (uint turn = 0u; turn < 3u; turn++) {
        exact x = sum_of(bound, origin ^ SIGN);
        bool fits = format.fraction != 0u ? signed_code(format, x, exponent, up, code)
                                          : whole_code(format, x, exponent, up, code);
        exact value = sum_of(bits_of_code(format, code, exponent), origin);
        if (!fits || !is_subnormal(value))
            return fits;
        if (up)
            bound = is_negative(value) ? 0u : NORMAL;
        else
            bound = is_negative(value) ? NORMAL | SIGN : 0u;
    }
    return true;
}

/* The code in the world. */
bool world_code(number_format format, uint bound, bool up, out uint code)
{
    return signed_code(format, sum_of(bound, 0u), 0, up, code);
}

/* --- frames ----------------------------------------------------------------------------------- */

/* Rounds a subnormal bound outward; there is no -0. */
uint normal_bound(uint bits, bool up)
{
    uint size = bits & ~SIGN;
    bool negative = (bits & SIGN) != 0u;
    if (size >= NORMAL)
        return bits;
    if (size == 0u || up == negative)
        return 0u;
    return up ? NORMAL : NORMAL | SIGN;
}

/* Rounds a magnitude to 24 bits, to the nearest, of two the even one. */
exact rounded(exact x)
{
    int by = top_bit(x) - 23;
    if (by <= 0)
        return x;
    exact before = shifted(x, uint(by - 1));
    bool tie = (before.low & 1u) != 0u, more = before.between;
    x = shifted(before, 1u);
    if (tie && (more || (x.low & 1u) != 0u)) {
        x.low += 1u;
        x.high += x.low == 0u ? 1u : 0u;
    }
    x.between = false;
    return x;
}

/* The middle of two numbers, rounded; 0 if it is subnormal. C rounds to a double before, whose 53
 * bits are enough that nothing changes (Figueroa 1995, 2 p + 2 bits for sums of p bits). */
uint middle_of(uint lo, uint hi)
{
    exact sum = sum_of(lo, hi);
    exact size = rounded(magnitude_of(sum));
    int top = top_bit(size), exponent = top + size.unit - 1;
    uint sign = is_negative(sum) ? SIGN : 0u;
    if (top < 0)
        return 0u;
    size = shifted(size, uint(max(top - 23, 0)));
    uint fraction = size.low << uint(max(23 - top, 0));
    if (exponent == -127 && fraction == 0xFFFFFFu)
        return sign | NORMAL; /* as a subnormal it has a bit less */
    return exponent < -126 ? 0u : sign | uint(exponent + 127) << 23 | (fraction & 0x7FFFFFu);
}

struct number_axis {
    uint origin;
    int exponent; /* of the scale */
};

/* The axis with the smallest scale in which both bounds have codes, as number_frame_make; false:
 * none. */
bool number_axis_make(number_format format, uint lo, uint hi, out number_axis axis)
{
    uint code;
    lo = normal_bound(lo, false);
    hi = normal_bound(hi, true);
    axis = number_axis(format.fraction != 0u ? middle_of(lo, hi) : lo, format.scale_low);
    if (max(lo & ~SIGN, hi & ~SIGN) > FRAME_MOST)
        return false;
    exact above = magnitude_of(sum_of(hi, axis.origin ^ SIGN));
    exact below = magnitude_of(sum_of(axis.origin, lo ^ SIGN));
    int top = max(top_bit(above) < 0 ? -1000 : top_bit(above) + above.unit,
                  top_bit(below) < 0 ? -1000 : top_bit(below) + below.unit);
    axis.exponent = max(axis.exponent, top - format.top - 1);
    while (axis.exponent < 127 &&
           !(framed_code(format, axis.origin, axis.exponent, lo, false, code) &&
             framed_code(format, axis.origin, axis.exponent, hi, true, code)))
        axis.exponent++;
    return true;
}

#endif
