/* Integers of a fixed width that holds all products of a pair of triangles, placed ones included.
 * Every finite float32 is a whole multiple of 2^-149 below 2^277 of them. A placed vertex relative
 * to the origin, M v + T - o, is one of 2^-298 below 2^556 of them, an edge below 2^557. So
 * T, a determinant of three such, is below (sqrt(3) 2^556)^3 < 2^1671: 27 limbs; D, a direction
 * times a product of two edges, below 2^1394: 22 limbs. Two t are compared by products of a T and a
 * D: 49 limbs. Of a scene, whose vertices are floats themselves, all are half as long. */
#ifndef ORACLE_WIDE_H
#define ORACLE_WIDE_H

#include <stdint.h>

#define WIDE_LIMBS 50

/* Sign and magnitude. Only the lowest `count` limbs are defined; the highest of them is not 0, and
 * sign is 0 exactly when count is. */
struct oracle_wide {
    int sign;
    int count;
    uint64_t limb[WIDE_LIMBS];
};

void wide_set(__int128 value, struct oracle_wide *out);

/* Copies only the defined limbs. */
static inline void wide_copy(const struct oracle_wide *a, struct oracle_wide *out)
{
    out->sign = a->sign;
    out->count = a->count;
    for (int i = 0; i < a->count; i++)
        out->limb[i] = a->limb[i];
}

/* out = a + b, a - b, a * b. `out` may be one of the operands, but not of a product. */
void wide_add(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out);
void wide_sub(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out);
void wide_mul(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out);

/* Multiplies by 2^bits, or divides exactly: the bits shifted out must be 0. In place. */
void wide_shift_left(struct oracle_wide *a, unsigned bits);
void wide_shift_right(struct oracle_wide *a, unsigned bits);

/* Sign of |a| - |b|. */
int wide_compare_size(const struct oracle_wide *a, const struct oracle_wide *b);

/* Bits of |a|, 0 for 0; and the number of trailing zero bits, 0 for 0. */
unsigned wide_bits(const struct oracle_wide *a);
unsigned wide_trailing(const struct oracle_wide *a);

/* The 64 highest bits of |a| != 0, of which the topmost is 1: |a| is at least *top * 2^*exponent
 * and less than (*top + 1) * 2^*exponent. Returns whether it is exactly the former. */
int wide_top(const struct oracle_wide *a, uint64_t *top, int *exponent);

/* |a| / by rounded down, in place; returns the remainder. by != 0. */
uint64_t wide_divide_small(struct oracle_wide *a, uint64_t by);

#endif
