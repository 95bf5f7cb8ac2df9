/* What is made of a black box's bounds (ref/judge/judge_allowed.c), against definitions written
 * anew: of any bounds, those met exactly among them, and of rays beside triangles. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define U       0x1p-24L
#define FLUSHED 0x1p-126L

typedef long double wide;

static void same(const char *what, double found, wide expected)
{
    if (!(fabsl((wide)found - expected) <= 1e-13L * fabsl(expected)) && !((wide)found == expected))
        fail_msg("%s: %a, not %La", what, found, expected);
}

/* --- of any bounds ---------------------------------------------------------------------------- */

/* Few digits, so that sums of few such are exact, and borders are met. */
static double number(struct rng *rng)
{
    static const int power[] = {0, 0, 0, 0, -24, -24, -66, -126};
    double digit = rng_below(rng, 5);
    return ldexp(digit, power[rng_below(rng, ARRAY_COUNT(power))]);
}

static double power_of_two(struct rng *rng)
{
    static const int power[] = {0, 0, 1, 2, -24, -66};
    return rng_below(rng, 6) ? ldexp(1, power[rng_below(rng, ARRAY_COUNT(power))]) : 0;
}

static double any_sign(struct rng *rng)
{
    double x = number(rng);
    return rng_below(rng, 2) ? x : -x;
}

static struct judge_rounding some_bounds(struct rng *rng)
{
    struct judge_rounding r = {.det_most = number(rng), .t_most = number(rng)};
    r.tri.unit = power_of_two(rng);
    r.tri.area = power_of_two(rng);
    r.det = any_sign(rng);
    r.t = any_sign(rng);
    r.extra = rng_below(rng, 2) ? number(rng) : 0;
    for (int c = 0; c < 3; c++) {
        r.edge[c] = any_sign(rng);
        r.edge_most[c] = number(rng);
        r.across[c] = power_of_two(rng);
    }
    return r;
}

static wide edge_allowed(const struct judge *judge, const struct judge_rounding *r, int c)
{
    wide length = (wide)r->across[c] * (wide)r->tri.unit, own = (wide)judge->displacement;
    wide rounding = length > 0 ? (wide)r->edge_most[c] / length : 0;
    return (rounding > own ? rounding : own) + (wide)r->extra;
}

/* Of the determinant with the division by it. */
static wide divided(const struct judge_rounding *r)
{
    return (wide)r->det_most + 10 * U * fabsl((wide)r->det);
}

static wide plane_allowed(const struct judge *judge, const struct judge_rounding *r, wide t)
{
    wide length = (wide)r->tri.area * (wide)r->tri.unit, own = (wide)judge->displacement;
    wide most = (wide)r->t_most + fabsl(t) * divided(r) + FLUSHED * fabsl((wide)r->det);
    wide rounding = length > 0 ? most / length : 0;
    return (rounding > own ? rounding : own) + (wide)r->extra;
}

/* a <= b; *near: a matter of the last digits of a double. Where both are equal it is none. */
static bool at_most(wide a, wide b, bool *near)
{
    *near = *near || (a != b && fabsl(a - b) <= 1e-15L * fmaxl(fabsl(a), fabsl(b)));
    return a <= b;
}

static bool weight_allowed(const struct judge_rounding *r, int c, wide weight, bool *near)
{
    wide off = fabsl(weight * (wide)r->det - (wide)r->edge[c]);
    wide moved = 2 * (wide)r->extra * (wide)r->tri.unit * (wide)r->across[c];
    return at_most(off,
                   (wide)r->edge_most[c] + fabsl(weight) * divided(r) +
                       FLUSHED * fabsl((wide)r->det) + moved,
                   near);
}

/* Some sign of the determinant that may be computed may be that of every edge. */
static bool may_accept(const struct judge *judge, const struct judge_rounding *r, bool *near)
{
    bool any = false;
    for (int sign = -1; sign < 2; sign += 2) {
        bool all = at_most(-sign * (wide)r->det, (wide)r->det_most, near);
        for (int c = 0; c < 3; c++) {
            wide most = edge_allowed(judge, r, c) * (wide)r->across[c] * (wide)r->tri.unit;
            all = at_most(-sign * (wide)r->edge[c], most, near) && all;
        }
        any = any || all;
    }
    return any && !(r->det == 0 && r->det_most == 0);
}

static bool side_is_open(const struct judge *judge, const struct judge_rounding *r, bool *near)
{
    bool open = fabs(r->det) <= r->det_most;
    wide units = 2 * ((wide)judge->displacement + (wide)r->extra) * (wide)r->tri.unit;
    for (int c = 0; c < 3; c++)
        open = at_most(fabsl((wide)r->det), units * (wide)r->across[c], near) || open;
    return open;
}

static wide margin(const struct judge_rounding *r)
{
    wide least = (wide)INFINITY;
    for (int c = 0; c < 3; c++)
        if (r->edge_most[c] != 0 && fabsl((wide)r->edge[c]) < least * (wide)r->edge_most[c])
            least = fabsl((wide)r->edge[c]) / (wide)r->edge_most[c];
    return least;
}

static void allowances_are_those_of_their_definition(void **state)
{
    (void)state;
    static const double displacement[] = {1, 4, 32, 0x1p-24, 0x1p-66};
    struct rng rng = rng_make(1, 51);
    size_t yes[4] = {0};
    for (int i = 0; i < 300000; i++) {
        struct judge judge = {.displacement = displacement[rng_below(&rng, 5)]};
        struct judge_rounding r = some_bounds(&rng);
        double t = any_sign(&rng), weight = any_sign(&rng);
        int c = (int)rng_below(&rng, 3);
        wide across = (wide)r.across[c] * (wide)r.tri.unit;
        same("an edge's allowance", judge_edge_allowed(&judge, &r, c), edge_allowed(&judge, &r, c));
        same("the plane's allowance", judge_plane_allowed(&judge, &r, t),
             plane_allowed(&judge, &r, (wide)t));
        if (across > 0 || r.across[c] == 0)
            same("the distance of an edge", judge_edge_distance(&r, c),
                 across > 0 ? (wide)r.edge[c] / across : 0);
        if (r.det != 0)
            same("the unit of t", judge_unit_of_t(&r),
                 (wide)r.tri.unit * (wide)r.tri.area / fabsl((wide)r.det));
        same("the margin", judge_margin(&r), margin(&r));
        bool near[4] = {false};
        const bool is[4] = {judge_weight_allowed(&r, c, weight), judge_may_accept(&judge, &r),
                            judge_side_is_open(&judge, &r), judge_det_is_open(&r)};
        const bool must[4] = {weight_allowed(&r, c, (wide)weight, &near[0]),
                              may_accept(&judge, &r, &near[1]), side_is_open(&judge, &r, &near[2]),
                              fabs(r.det) <= r.det_most};
        for (int k = 0; k < 4; k++) {
            assert_true(near[k] || is[k] == must[k]);
            yes[k] += is[k];
        }
    }
    for (int k = 0; k < 4; k++)
        assert_in_range(yes[k], 30000, 270000);
}

/* Whichever comes first: no order of these is a choice. */
static void sums_and_extremes_are_the_same_in_either_order(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 51);
    static const double ends[] = {INFINITY, -INFINITY, 0, 1};
    for (int i = 0; i < 20000; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = rng_below(&rng, 4) ? (double)rng_range(&rng, -9, 9) * 0x1.5555p-3 : ends[i % 4];
            b[k] = rng_below(&rng, 4) ? any_sign(&rng) * 0x1.1111p1 : ends[rng_below(&rng, 4)];
        }
        double one = judge_dot(a, b), other = judge_dot(b, a);
        assert_true(one == other || (isnan(one) && isnan(other)));
        assert_true(fmin(a[0], b[0]) == fmin(b[0], a[0]) && fmax(a[0], b[0]) == fmax(b[0], a[0]));
        assert_true(fmin(a[0], (double)NAN) == a[0] && fmin((double)NAN, a[0]) == a[0]);
        assert_true(fmax(a[0], (double)NAN) == a[0] && fmax((double)NAN, a[0]) == a[0]);
    }
}

/* --- of rays beside triangles ----------------------------------------------------------------- */

struct passing {
    struct scene scene;
    struct judge judge;
    struct ray ray;
};

/* A ray that passes an edge, or ends at the plane, closely on either side. */
static void aim(struct rng *rng, struct passing *out)
{
    float v[3][3], weight[3], off = (rng_range(rng, -100, 100)) * 0x1p-24f;
    int edge = (int)rng_below(rng, 3), where = (int)rng_below(rng, 3);
    bool level = rng_below(rng, 8) == 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = rng_range(rng, -1, 1);
    weight[edge] = where == 0 ? off : rng_range(rng, 0.1f, 0.3f);
    weight[(edge + 1) % 3] = rng_range(rng, 0.2f, 0.5f);
    weight[(edge + 2) % 3] = 1 - weight[edge] - weight[(edge + 1) % 3];
    out->ray = (struct ray){.tmin = 0, .tmax = rng_below(rng, 2) ? 0x1p60f : INFINITY};
    for (int k = 0; k < 3; k++) {
        float to = weight[0] * v[0][k] + weight[1] * v[1][k] + weight[2] * v[2][k];
        out->ray.org[k] = level ? v[0][k] + 2 * (v[1][k] - v[0][k]) + off : rng_range(rng, -2, 2);
        out->ray.dir[k] = to - out->ray.org[k];
        for (int c = 0; c < 3; c++)
            out->scene.vertex[3 * c + k] = v[c][k];
    }
    if (where == 1)
        out->ray.tmax = 1 + off;
    if (where == 2)
        out->ray.tmin = 1 + off;
    if (rng_below(rng, 16) == 0)
        for (int k = 0; k < 3; k++)
            out->ray.dir[k] = -out->ray.dir[k];
}

/* Where the plane may be reached within the range, *near: it is a matter of the last digits. */
static bool may_reach(const struct passing *b, const struct judge_rounding *r, bool *near)
{
    wide lo = (wide)b->ray.tmin, hi = (wide)b->ray.tmax, meet = (wide)r->t / (wide)r->det;
    bool reach = lo <= meet && meet <= hi;
    for (int end = 0; end < 2; end++) {
        wide t = end ? hi : lo;
        if (isinf((double)t))
            continue;
        wide off = fabsl(t * (wide)r->det - (wide)r->t);
        wide most = plane_allowed(&b->judge, r, t) * (wide)r->tri.area * (wide)r->tri.unit;
        reach = reach || off <= most;
        *near = *near || fabsl(off - most) <= 1e-9L * most;
    }
    return reach;
}

static void what_may_be_hit_may_be_accepted_and_reached(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 51);
    struct passing b = {.judge.displacement = 32};
    size_t yes = 0, no = 0, open = 0;
    assert_int_equal(scene_make(3, 1, &b.scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++)
        b.scene.index[c] = c;
    b.judge.scene = &b.scene;
    for (int i = 0; i < 60000; i++) {
        bool near = false;
        aim(&rng, &b);
        struct judge_rounding r = judge_rounding_at(&b.judge, &b.ray, 0);
        bool accepts = may_accept(&b.judge, &r, &near), is_open = fabs(r.det) <= r.det_most;
        bool expected = accepts && (is_open || may_reach(&b, &r, &near));
        bool found = judge_may_be_hit(&b.judge, &b.ray, 0);
        if (!near && found != expected)
            fail_msg("%d: %d, not %d", i, found, expected);
        yes += found;
        no += !found;
        open += is_open;
    }
    scene_free(&b.scene);
    print_message("%zu may be hit, %zu not, %zu open\n", yes, no, open);
    assert_true(yes > 20000 && no > 5000 && open > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(allowances_are_those_of_their_definition),
        cmocka_unit_test(sums_and_extremes_are_the_same_in_either_order),
        cmocka_unit_test(what_may_be_hit_may_be_accepted_and_reached),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
