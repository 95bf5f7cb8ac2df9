#include "ref/world/placed.h"

#include "ref/integers/oracle_grid.h"

#include <math.h>

/* The highest and the lowest bit of a float32. */
#define SIGNIFICAND 24
#define LOWEST      (-149)

/* --- by integers ------------------------------------------------------------------------------ */

/* m * 2^exponent; m = 0 has no exponent. */
struct term {
    int64_t m;
    int exponent;
};

static struct term product(float a, float b)
{
    struct odd x = odd_of(a), y = odd_of(b);
    return (struct term){(int64_t)x.m * y.m, x.exponent + y.exponent};
}

static struct term single(float a)
{
    struct odd x = odd_of(a);
    return (struct term){x.m, x.exponent};
}

void placed_difference(const float row[4], const float p[3], float x, struct oracle_wide *out,
                       int *exponent)
{
    struct term term[5];
    struct oracle_wide one;
    int lowest = 0;
    bool any = false;
    for (int k = 0; k < 3; k++)
        term[k] = product(row[k], p[k]);
    term[3] = single(row[3]);
    term[4] = single(-x);
    for (int i = 0; i < 5; i++)
        if (term[i].m != 0) {
            lowest = !any || term[i].exponent < lowest ? term[i].exponent : lowest;
            any = true;
        }
    wide_set(0, out);
    for (int i = 0; i < 5; i++) {
        if (term[i].m == 0)
            continue;
        wide_set(term[i].m, &one);
        wide_shift_left(&one, (unsigned)(term[i].exponent - lowest));
        wide_add(out, &one, out);
    }
    *exponent = lowest;
}

/* |a| * 2^exponent between two neighbouring floats, or as one. */
static void round_size(const struct oracle_wide *a, int exponent, float *below, float *above)
{
    uint64_t top;
    int shift;
    bool whole = wide_top(a, &top, &shift);
    exponent += shift; /* the number begins with top * 2^exponent */
    int unit = exponent + 64 - SIGNIFICAND;
    unit = unit < LOWEST ? LOWEST : unit;
    int cut = unit - exponent; /* at least 40 */
    uint64_t size = cut < 64 ? top >> cut : 0;
    uint64_t rest = cut < 64 ? top & (((uint64_t)1 << cut) - 1) : top;
    *below = unit > 128 - SIGNIFICAND ? FLT_MAX : (float)ldexp((double)size, unit);
    *above = unit > 128 - SIGNIFICAND ? INFINITY : *below;
    if (rest != 0 || !whole)
        *above = nextafterf(*below, INFINITY);
}

static void round_by_integers(const float row[4], const float p[3], float *below, float *above)
{
    struct oracle_wide sum;
    int exponent;
    float small, large;
    *below = *above = 0;
    placed_difference(row, p, 0, &sum, &exponent);
    if (sum.sign == 0)
        return;
    round_size(&sum, exponent, &small, &large);
    *below = sum.sign > 0 ? small : -large;
    *above = sum.sign > 0 ? large : -small;
}

/* --- by doubles, where they suffice ----------------------------------------------------------- */

/* a + b and what the sum lacks (Knuth 1969). */
static double two_sum(double a, double b, double *error)
{
    double sum = a + b, b_part = sum - a;
    *error = (a - (sum - b_part)) + (b - b_part);
    return sum;
}

void placed_round(const float row[4], const float p[3], float *below, float *above)
{
    double e[3], sum;
    sum = two_sum((double)row[0] * (double)p[0], (double)row[1] * (double)p[1], &e[0]);
    sum = two_sum(sum, (double)row[2] * (double)p[2], &e[1]);
    sum = two_sum(sum, (double)row[3], &e[2]);
    double lacks = fabs(e[0]) + fabs(e[1]) + fabs(e[2]);
    float near = (float)fmax(fmin(sum, (double)FLT_MAX), -(double)FLT_MAX);
    double beside = sum - (double)near;
    /* The sum lies between `near` and its neighbour, at most half way, and so does the coordinate,
     * which is beside `near` on the same side. */
    if (lacks != 0 && !(fabs(beside) > 2 * lacks)) {
        round_by_integers(row, p, below, above);
        return;
    }
    *below = beside < 0 ? nextafterf(near, -INFINITY) : near;
    *above = beside > 0 ? nextafterf(near, INFINITY) : near;
}

int placed_compare(const float row[4], const float p[3], float x)
{
    double error, about = placed_about(row, p, &error) - (double)x;
    struct oracle_wide sum;
    int exponent;
    /* One more rounding, of the difference. */
    error += fabs(about) * 0x1p-52;
    if (about > error || about < -error)
        return about > 0 ? 1 : -1;
    placed_difference(row, p, x, &sum, &exponent);
    return sum.sign;
}

/* --- boxes ------------------------------------------------------------------------------------ */

struct box placed_tri_bounds(const float m[3][4], float v[3][3])
{
    struct box box = box_empty();
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            placed_grow(m[k], v[c], &box.lo[k], &box.hi[k]);
    return box;
}

/* Along each axis the sum is least at the corner that has the least products, and largest at the
 * opposite one. */
struct box placed_box_bounds(const float m[3][4], const struct box *box)
{
    struct box out;
    for (int k = 0; k < 3; k++) {
        float least[3], most[3], other;
        for (int j = 0; j < 3; j++) {
            least[j] = m[k][j] < 0 ? box->hi[j] : box->lo[j];
            most[j] = m[k][j] < 0 ? box->lo[j] : box->hi[j];
        }
        placed_round(m[k], least, &out.lo[k], &other);
        placed_round(m[k], most, &other, &out.hi[k]);
    }
    return out;
}
