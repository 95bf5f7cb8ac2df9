/* The planes of one axis of a wide node, as ref/layouts/wide_nodes.h has them, by integers: plane q
 * lies at (first + q) * 2^exponent. Numbers are bits of finite floats of at most 2^100 in
 * magnitude. */
#ifndef BUILD_AXIS_GLSL
#define BUILD_AXIS_GLSL

#define AXIS_LEAST (-100)   /* of exponents */
#define AXIS_STEPS 0x800000 /* 2^23: so many steps from zero lie origins at most */

struct node_axis {
    int first; /* of the planes, in steps */
    int exponent;
};

/* Maps bits to a number of the same order; -0 lies below 0. */
uint bits_order(uint bits)
{
    return (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
}

/* A number is so many times 2^unit. */
int bits_unit(uint bits)
{
    return max(int((bits >> 23) & 0xFFu), 1) - 150;
}

uint bits_units(uint bits)
{
    uint fraction = bits & 0x7FFFFFu;
    return (bits & 0x7F800000u) != 0u ? fraction | 0x800000u : fraction;
}

/* The last multiple of 2^exponent that is at most a number. The exponent is not below the
 * number's unit: nothing is shifted up. */
int steps_down(uint bits, int exponent)
{
    uint units = bits_units(bits), by = uint(min(exponent - bits_unit(bits), 24));
    int whole = int(units >> by);
    bool rest = (units & ((1u << by) - 1u)) != 0u;
    if ((bits >> 31) == 0u)
        return whole;
    return rest ? -whole - 1 : -whole;
}

/* The first that is at least the number. */
int steps_up(uint bits, int exponent)
{
    return -steps_down(bits ^ 0x80000000u, exponent);
}

/* The finest axis whose `most` (2 to 4096) steps extend from at most lo to at least hi. */
node_axis node_axis_make(uint lo, uint hi, uint most)
{
    uint larger = max(lo & 0x7FFFFFFFu, hi & 0x7FFFFFFFu);
    int exponent = max(bits_unit(larger), AXIS_LEAST);
    int apart = steps_up(hi, exponent) - steps_down(lo, exponent);
    exponent += max(findMSB(apart) - findMSB(most) - 2, 0); /* twice as many are too many */
    for (;; exponent++) {
        int first = steps_down(lo, exponent);
        if (abs(first) <= AXIS_STEPS && steps_up(hi, exponent) - first <= int(most))
            return node_axis(first, exponent);
    }
}

/* Of a number between the bounds that the axis was made of: the last plane that is at most it, the
 * first that is at least it. */
uint node_axis_down(node_axis axis, uint bits)
{
    return uint(steps_down(bits, axis.exponent) - axis.first);
}

uint node_axis_up(node_axis axis, uint bits)
{
    return uint(steps_up(bits, axis.exponent) - axis.first);
}

/* Bits of plane 0. */
uint node_axis_origin(node_axis axis)
{
    if (axis.first == 0)
        return 0u;
    uint steps = uint(abs(axis.first));
    int top = findMSB(steps);
    uint sign = axis.first < 0 ? 0x80000000u : 0u;
    return sign | uint(axis.exponent + top + 127) << 23 | ((steps << (23 - top)) & 0x7FFFFFu);
}

#define BOX_WORDS 48 /* of 8 slots */

/* A node's axis k. Of slot s, words 6 s to 6 s + 2 of `box` are the lower bounds and the next three
 * the upper ones; bit s of `there` tells whether it has a child. At least one has. */
node_axis node_axis_of(uint there, uint box[BOX_WORDS], uint k, uint most)
{
    uint lo = 0x7F800000u, hi = 0xFF800000u;
    for (uint s = 0u; s < 8u; s++) {
        if (((there >> s) & 1u) == 0u)
            continue;
        uint slot_lo = box[6u * s + k], slot_hi = box[6u * s + 3u + k];
        lo = bits_order(slot_lo) < bits_order(lo) ? slot_lo : lo;
        hi = bits_order(slot_hi) > bits_order(hi) ? slot_hi : hi;
    }
    return node_axis_make(lo, hi, most);
}

#endif
