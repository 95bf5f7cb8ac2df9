/* How much slack the box tests' constants have: each is tightened step by step until a box is
 * turned away that must not be. Prints the table; fails if that happens untightened. */
#include "tests/exact/legal.h"

#include "ref/base/base.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define UNIT 0x1p-24

static const struct {
    const char *name;
    struct rounding rounding;
} roundings[] = {
    {"ieee", ROUNDING_IEEE}, {"vulkan rte", ROUNDING_VULKAN_RTE}, {"vulkan", ROUNDING_VULKAN}};

/* A box test's constants in u: far plane x (1 + far u), entry x (1 - near u) - behind u x reach. */
struct padding {
    int far, near, behind;
};

static const struct padding padding_robust = {32, 0, 0};
static const struct padding padding_watertight = {0, 64, 32};

static void paddings_are_those_of_the_box_tests(void **state)
{
    (void)state;
    assert_true((double)SLAB_FAR == 1 + padding_robust.far * UNIT);
    assert_true((double)SLAB_NEAR == 1 - padding_watertight.near * UNIT);
    assert_true((double)SLAB_BEHIND == padding_watertight.behind * UNIT);
}

static uint64_t trials(void)
{
    return getenv("RAYDIFF_SLOW") ? 20000000 : 300000;
}

/* A constant and the step, from `proven` down, at which it broke. */
struct boxes_row {
    const char *name, *rounding;
    int proven, needed; /* needed: what the proof asks for, rounded up */
    int broken;         /* largest value that broke, -1: none */
    uint64_t trials;
};

static void print_head(void)
{
    print_message("%-18s %-11s %7s %7s %7s %7s %10s\n", "constant (in u)", "rounding", "chosen",
                  "proof", "held", "broke", "trials");
}

static void print_row(const struct boxes_row *row)
{
    char broke[16] = "-";
    if (row->broken >= 0)
        snprintf(broke, sizeof broke, "%d", row->broken);
    print_message("%-18s %-11s %7d %7d %7d %7s %10llu\n", row->name, row->rounding, row->proven,
                  row->needed, row->broken + 1, broke, (unsigned long long)row->trials);
    assert_true(row->trials >= 90);
    assert_true(row->broken < row->needed); /* what breaks contradicts the proof */
}

/* --- the slab test, computed legally ---------------------------------------------------------- */

/* One axis: its planes as the ray meets them, and which of them is to be computed too far away. */
struct boxes_axis {
    float o, d, nearer, farther;
    bool enters; /* the entry is pushed back, else the exit is pulled forward */
};

static float plane_distance(struct legal *l, float plane, float o, float inverse)
{
    return legal_mul(l, legal_add(l, plane, -o), inverse);
}

static bool slab_accepts(struct legal *l, const struct boxes_axis axis[3], float behind,
                         float tbest, struct padding pad)
{
    float tn = 0, tf = tbest;
    for (int k = 0; k < 3; k++) {
        l->style = axis[k].enters ? LEGAL_ALL_HIGH : LEGAL_ALL_LOW;
        float inverse = legal_div(l, 1, axis[k].d);
        float a = plane_distance(l, axis[k].nearer, axis[k].o, inverse);
        float b = plane_distance(l, axis[k].farther, axis[k].o, inverse);
        if (pad.far > 0)
            b = legal_mul(l, b, 1 + (float)pad.far * 0x1p-24f);
        tn = a > tn ? a : tn;
        tf = b < tf ? b : tf;
    }
    l->style = LEGAL_ALL_HIGH;
    if (pad.near > 0)
        tn = legal_mul(l, tn, 1 - (float)pad.near * 0x1p-24f);
    return legal_add(l, tn, -behind) <= tf;
}

/* --- a ray through a corner exactly, or inside it by less than rounding ----------------------- */

/* Is a / b <= c / d, exactly? b, d > 0; each difference a, c is exact in double. */
static bool at_most(double a, double b, double c, double d)
{
    double left = a * d, right = c * b;
    if (left != right)
        return left < right;
    return fma(a, d, -left) <= fma(c, b, -right);
}

static bool corner_is_met(const struct boxes_axis axis[3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!at_most((double)axis[i].nearer - (double)axis[i].o, (double)axis[i].d,
                         (double)axis[j].farther - (double)axis[j].o, (double)axis[j].d))
                return false;
    return true;
}

/* A power of two from 2^least to 2^most. Calls are never two in one product: C leaves their order
 * open. */
static float binade(struct rng *rng, int least, int most)
{
    return ldexpf(1, least + (int)rng_below(rng, (uint32_t)(most - least + 1)));
}

/* An axis that the ray enters, or leaves, at t but for a rounding that keeps the corner met: of
 * `CANDIDATES` the one whose computed distance is farthest off. */
#define CANDIDATES 20000
static struct boxes_axis worst_axis(struct rng *rng, struct legal *l, double t, bool enters)
{
    struct boxes_axis worst = {0};
    float most = enters ? 0 : INFINITY;
    l->style = enters ? LEGAL_ALL_HIGH : LEGAL_ALL_LOW;
    for (int n = 0; n < CANDIDATES; n++) {
        float d = 2 - rng_float(rng) * 0.25f, at = (float)(t * (double)d);
        double rest = ((double)at - t * (double)d) * 0x1p46; /* the origin, exact so far */
        float o = (float)((enters ? ceil(rest) : floor(rest)) * 0x1p-46);
        float computed = plane_distance(l, at, o, legal_div(l, 1, d));
        if (enters ? computed > most : computed < most) {
            most = computed;
            worst = (struct boxes_axis){o, d, enters ? at : at - 1, enters ? at + 1 : at, enters};
        }
    }
    return worst;
}

static void draw_corner(struct rng *rng, struct legal *l, struct boxes_axis axis[3])
{
    /* Just above a power of two rounding is largest; 28 bits lie between the float32s, and times 24
     * they are exact in double. */
    double t = 1 + floor((double)rng_float(rng) * 0x1p25) * 0x1p-28;
    axis[0] = worst_axis(rng, l, t, true);
    axis[1] = worst_axis(rng, l, t, false);
    axis[2] = (struct boxes_axis){0, 1, -8, 8, true};
}

static void far_plane_has_this_much_slack(void **state)
{
    (void)state;
    print_head();
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++) {
        static const int needed[] = {6, 14, 18};
        struct boxes_row row = {"robust: far", roundings[r].name, 32, needed[r], -1, 0};
        struct rng rng = rng_make(17, r);
        struct legal legal = {.rounding = roundings[r].rounding};
        for (uint64_t n = 0; n < trials() / 3000; n++) {
            struct boxes_axis axis[3];
            draw_corner(&rng, &legal, axis);
            if (!corner_is_met(axis))
                continue;
            row.trials++;
            struct padding pad = padding_robust;
            for (pad.far = row.broken + 2; pad.far <= 32; pad.far += 2) { /* 2 u: one float32 */
                pad.far -= pad.far % 2;
                if (slab_accepts(&legal, axis, 0, INFINITY, pad))
                    break;
                row.broken = pad.far;
            }
        }
        print_row(&row);
        assert_true(row.broken >= 4); /* 1 + 4u is not enough: the search sees that much */
    }
}

/* --- woop's triangles and their boxes --------------------------------------------------------- */

struct boxes_pair {
    struct ray ray;
    float v[3][3];
};

/* A triangle with an edge in a face of its box, often long and often reaching behind the origin,
 * and a ray that passes that edge outside of the box by about woop's error. */
static void draw_beside(struct rng *rng, struct boxes_pair *pair)
{
    int main = (int)rng_below(rng, 3), side = (main + 1 + (int)rng_below(rng, 2)) % 3;
    int third = 3 - main - side;
    float ahead = binade(rng, 0, 11), back = 0.25f; /* extent along the ray */
    ahead *= 1 + rng_float(rng);
    if (rng_below(rng, 3)) {
        back = -binade(rng, 0, 11);
        back *= 1 + rng_float(rng);
    }
    float face = rng_range(rng, -2, 2), level = rng_range(rng, -2, 2);
    bool flat = rng_below(rng, 2);
    float wide = binade(rng, -1, 3);
    wide = rng_below(rng, 2) ? wide : -wide;
    for (int c = 0; c < 3; c++) {
        pair->v[c][side] = c == 2 ? face + wide : face;
        pair->v[c][third] = flat ? level : level + rng_range(rng, -1, 1);
        pair->v[c][main] = c == 0 ? back : ahead;
    }
    double hit[3], share = (double)rng_float(rng);
    share *= rng_below(rng, 2) ? 1 : 0.01;
    if (back < 0) /* near to the origin, on the far side of it */
        share =
            ((double)(1.5f * binade(rng, -7, 0)) - (double)back) / ((double)ahead - (double)back);
    share = fmin(share, 1);
    for (int k = 0; k < 3; k++)
        hit[k] = (1 - share) * (double)pair->v[0][k] + share * (double)pair->v[1][k];
    for (int k = 0; k < 3; k++) {
        float wanted = rng_range(rng, -1, 1);
        pair->ray.org[k] = k == main ? 0 : (float)(hit[k] + (double)wanted * fabs(hit[main]));
    }
    double size = fmax((double)ahead, fabs((double)back));
    double off = (double)rng_range(rng, 0, 16) * UNIT *
                 (rng_below(rng, 2) ? size : fabs(hit[main]) + fabs(hit[side]));
    hit[side] -= wide > 0 ? off : -off; /* outside */
    for (int k = 0; k < 3; k++)
        pair->ray.dir[k] = (float)(hit[k] - (double)pair->ray.org[k]);
    pair->ray.tmin = 0;
    pair->ray.tmax = INFINITY;
}

/* Whether 0 lies strictly inside the triangle of the computed places, so that woop accepts it and
 * no luck of rounding is needed; *t is where the ray meets it then, as close as double tells. */
static bool computed_inside(const struct boxes_pair *pair, const struct tri_ray *r,
                            const float x[3], const float y[3], double *t)
{
    double w[3], sum = 0;
    int side = 0;
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        double left = (double)x[a] * (double)y[b], right = (double)y[a] * (double)x[b];
        w[c] = left - right; /* products of float32 are exact */
        side += fabs(w[c]) > 0 ? (w[c] > 0 ? 1 : -1) : 0;
        sum += w[c];
    }
    if (side != 3 && side != -3)
        return false;
    *t = 0;
    for (int c = 0; c < 3; c++)
        *t += w[c] / sum * ((double)pair->v[c][r->kz] - (double)r->o[r->kz]);
    *t /= (double)r->d[r->kz];
    return *t > 0x1p-20;
}

static void axes_of(const struct boxes_pair *pair, struct rng *rng, struct boxes_axis axis[3])
{
    for (int k = 0; k < 3; k++) {
        float lo = pair->v[0][k], hi = lo, d = pair->ray.dir[k];
        for (int c = 1; c < 3; c++) {
            lo = fminf(lo, pair->v[c][k]);
            hi = fmaxf(hi, pair->v[c][k]);
        }
        axis[k] = (struct boxes_axis){pair->ray.org[k], d, d < 0 ? hi : lo, d < 0 ? lo : hi,
                                      rng_below(rng, 2) != 0};
    }
}

/* The scene is the triangle alone, which reaches behind the origin least. */
static float reach_behind(const struct boxes_axis *main)
{
    float t = (main->nearer - main->o) * (1 / main->d);
    return t < 0 ? -t : 0;
}

/* Draws until woop accepts the triangle; false if this one is of no use. */
static bool draw_accepted(struct rng *rng, struct legal *l, struct boxes_axis axis[3], float *reach,
                          float *tbest)
{
    struct boxes_pair pair;
    float x[3], y[3], z[3];
    double t;
    draw_beside(rng, &pair);
    struct tri_ray r = tri_ray_make(&pair.ray);
    for (int k = 0; k < 3; k++)
        if (fabsf(pair.ray.dir[k]) < 0x1p-10f)
            return false;
    l->style = (enum legal_style)(LEGAL_ALL_LOW + (int)rng_below(rng, 3));
    legal_woop_shear(l, &r, pair.v, x, y, z);
    if (!computed_inside(&pair, &r, x, y, &t))
        return false;
    axes_of(&pair, rng, axis);
    *reach = reach_behind(&axis[r.kz]);
    *tbest = nextafterf((float)(t * (1 + 1e-12)), INFINITY);
    return true;
}

/* Raises row->broken while the box is turned away with that value. */
static void try_padding(struct boxes_row *row, struct legal *l, const struct boxes_axis axis[3],
                        float reach, float tbest, bool of_near)
{
    row->trials++;
    while (row->broken < row->proven) {
        struct padding pad = padding_watertight;
        *(of_near ? &pad.near : &pad.behind) = row->broken + 1;
        float behind = reach * (float)pad.behind * 0x1p-24f;
        if (slab_accepts(l, axis, behind, tbest, pad))
            return;
        row->broken++;
    }
}

static void entry_has_this_much_slack(void **state)
{
    (void)state;
    print_head();
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++) {
        static const int needed[2][3] = {{18, 34, 47}, {9, 9, 17}}; /* rounded up */
        struct boxes_row row[2] = {
            {"watertight: near", roundings[r].name, 64, needed[0][r], -1, 0},
            {"watertight: behind", roundings[r].name, 32, needed[1][r], -1, 0},
        };
        struct rng rng = rng_make(18, r);
        struct legal legal = {.rounding = roundings[r].rounding, .rng = rng_make(19, r)};
        for (uint64_t n = 0; n < trials(); n++) {
            struct boxes_axis axis[3];
            float reach, tbest;
            if (!draw_accepted(&rng, &legal, axis, &reach, &tbest))
                continue;
            try_padding(&row[reach > 0], &legal, axis, reach, tbest, !(reach > 0));
        }
        print_row(&row[0]);
        print_row(&row[1]);
        assert_true(row[1].broken > 0); /* robust boxes do leak */
    }
}

/* --- Embree's default box test ---------------------------------------------------------------- */

/* b r - o r with r = 1 / d: largest error in u (|b| + |o|) / |d|. */
static void embree_slab_has_this_much_slack(void **state)
{
    (void)state;
    double most = 0;
    struct rng rng = rng_make(20, 0);
    struct legal legal = {.rounding = ROUNDING_EMBREE, .fuses = true, .rng = rng_make(21, 0)};
    for (uint64_t n = 0; n < trials(); n++) {
        float d = 1 + rng_float(&rng), o = rng_range(&rng, -1, 1);
        float b = rng_range(&rng, -1, 1);
        if (rng_below(&rng, 4) == 0)
            b = o * (1 + b / 64);
        for (int style = LEGAL_ALL_LOW; style <= LEGAL_RANDOM; style++) {
            legal.style = (enum legal_style)style;
            float r = legal_div(&legal, 1, d);
            float t = legal_multiply_add(&legal, b, r, -legal_mul(&legal, o, r));
            double exact = ((double)b - (double)o) / (double)d;
            double size = (fabs((double)b) + fabs((double)o)) / (double)d;
            most = fmax(most, fabs((double)t - exact) / size / UNIT);
        }
    }
    print_message(
        "embree default: plane error chosen %g u (|b| + |o|) / |d|, proof 7.5, seen %.3f of "
        "%llu\n",
        EMBREE_SLAB_ERROR, most, (unsigned long long)(3 * trials()));
    assert_true(most <= 7.5 && most > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paddings_are_those_of_the_box_tests),
        cmocka_unit_test(far_plane_has_this_much_slack),
        cmocka_unit_test(entry_has_this_much_slack),
        cmocka_unit_test(embree_slab_has_this_much_slack),
    };
    return cmocka_run_group_tests_name("bounds_boxes", tests, NULL, NULL) ? 1 : 0;
}
