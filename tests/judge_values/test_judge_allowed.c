/* What a black box may do (ref/judge/judge_allowed.c), by value: every bound against its formula,
 * written anew in long double, and what is made of the bounds against its definition, at borders
 * that are met exactly. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/judge_values/one_placed.h"

#define U 0x1p-24L

typedef long double wide;

static void same(const char *what, double found, wide expected, wide share)
{
    wide off = fabsl((wide)found - expected);
    if (!(off <= share * fabsl(expected)) && !((wide)found == expected))
        fail_msg("%s: %a, not %La", what, found, expected);
}

/* --- the bounds of a ray and a triangle ------------------------------------------------------- */

struct bounds {
    wide edge[3], edge_most[3], det, det_most, t, t_most, across[3];
    wide edge_of[3], det_of, t_of, across_of[3]; /* of all sizes, which rounding is a share of */
};

static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

static wide determinant(const wide a[3], const wide b[3], const wide c[3], wide *sizes)
{
    wide sum = 0, all = 0;
    for (int p = 0; p < 6; p++) {
        wide product = a[order[p][0]] * b[order[p][1]] * c[order[p][2]];
        sum += p < 3 ? product : -product;
        all += fabsl(product);
    }
    *sizes = all;
    return sum;
}

static wide largest_of(const wide a[3])
{
    return fmaxl(fabsl(a[0]), fmaxl(fabsl(a[1]), fabsl(a[2])));
}

/* 16 u of the sum of sizes; where a product that is not 0 may be flushed, what that loses. */
static wide bound_of(const wide a[3], const wide b[3], const wide c[3])
{
    wide sizes, x = largest_of(a), y = largest_of(b), z = largest_of(c);
    bool small = false;
    determinant(a, b, c, &sizes);
    for (int p = 0; p < 6; p++) {
        wide outer = fabsl(a[order[p][0]]), pair = fabsl(b[order[p][1]] * c[order[p][2]]);
        if (pair == 0)
            continue;
        wide whole = outer * (pair < 1 ? pair : 1);
        small = small || pair <= 0x1p-60L || (outer != 0 && whole <= 0x1p-60L);
    }
    return 16 * U * sizes +
           (small ? 0x1p-126L * (5 + 9 * x + 6 * x * y + 6 * x * z + 6 * y * z) : 0);
}

/* v[c] from the origin, side[c] from vertex c to the next. */
static void bounds_of(const wide v[3][3], const wide side[3][3], const wide d[3],
                      struct bounds *out)
{
    *out = (struct bounds){.det = 0};
    out->det = determinant(side[0], d, side[2], &out->det_of);
    out->t = determinant(v[0], side[2], side[0], &out->t_of);
    for (int c = 0; c < 3; c++) {
        const wide *e = side[(c + 1) % 3], *from = v[(c + 1) % 3];
        out->edge[c] = determinant(d, from, e, &out->edge_of[c]);
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            wide minor = d[i] * e[j] - d[j] * e[i];
            out->across[c] += minor * minor;
        }
        out->across[c] = sqrtl(out->across[c]);
        out->across_of[c] = largest_of(d) * largest_of(e);
    }
    for (int base = 0; base < 3; base++) {
        int next = (base + 1) % 3, last = (base + 2) % 3;
        const wide *s = v[base], *one = side[base], *two = side[last];
        wide u = bound_of(s, d, two), w = bound_of(d, s, one), det = bound_of(one, d, two);
        out->edge_most[next] = fmaxl(out->edge_most[next], u);
        out->edge_most[last] = fmaxl(out->edge_most[last], w);
        out->edge_most[base] = fmaxl(out->edge_most[base], u + w + det + 10 * U * fabsl(out->det));
        out->det_most = fmaxl(out->det_most, det);
        out->t_most = fmaxl(out->t_most, bound_of(two, s, one));
    }
}

static void must_have(const struct judge_rounding *r, const struct bounds *b, wide share)
{
    for (int c = 0; c < 3; c++) {
        same("an edge's bound", r->edge_most[c], b->edge_most[c], share);
        assert_true(fabsl((wide)r->across[c] - b->across[c]) <= 0x1p-45L * b->across_of[c]);
        assert_true(fabsl((wide)r->edge[c] - b->edge[c]) <= 0x1p-40L * b->edge_of[c]);
    }
    same("the determinant's bound", r->det_most, b->det_most, share);
    same("t's bound", r->t_most, b->t_most, share);
    assert_true(fabsl((wide)r->det - b->det) <= 0x1p-40L * b->det_of);
    assert_true(fabsl((wide)r->t - b->t) <= 0x1p-40L * b->t_of);
}

/* Powers of two and zeros, around the border below which something may be flushed; else any. */
static float coordinate(struct rng *rng, int kind)
{
    static const int power[] = {0, 0, 1, -1, -20, -30, -31, -40, -59, -60, -61, -80, -110, 20, 40};
    float sign = rng_below(rng, 2) ? 1.0f : -1.0f;
    if (kind == 0)
        return rng_range(rng, -2, 2);
    if (rng_below(rng, kind == 1 ? 2 : 4) == 0)
        return 0;
    return ldexpf(sign, power[rng_below(rng, ARRAY_COUNT(power))]);
}

static struct ray drawn_ray(struct rng *rng, int kind, float v[3][3])
{
    struct ray ray = {.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray.org[k] = kind == 0 ? coordinate(rng, 0) : 0;
        ray.dir[k] = coordinate(rng, kind);
        for (int c = 0; c < 3; c++)
            v[c][k] = coordinate(rng, kind);
    }
    return ray;
}

static void bounds_are_those_of_their_formula(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 50);
    for (int i = 0; i < 100000; i++) {
        float v[3][3];
        struct ray ray = drawn_ray(&rng, i % 3, v);
        wide p[3][3], side[3][3], d[3], most = 0;
        struct bounds b;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                p[c][k] = (wide)((double)v[c][k] - (double)ray.org[k]);
                side[c][k] = (wide)((double)v[(c + 1) % 3][k] - (double)v[c][k]);
                d[k] = (wide)ray.dir[k];
                most = fmaxl(most, fabsl(p[c][k]));
            }
        bounds_of((const wide(*)[3])p, (const wide(*)[3])side, d, &b);
        struct judge_rounding r = judge_rounding_of(&ray, v);
        must_have(&r, &b, 1e-11L);
        same("the unit", r.tri.unit, U * most, 1e-12L);
        assert_true(r.extra == 0.0);
    }
}

/* --- of a placed triangle --------------------------------------------------------------------- */

/* Turned axes, scales and mirrors, or any numbers; of each a shift. */
static void draw_transform(struct rng *rng, int kind, float m[3][4])
{
    uint32_t turn = rng_below(rng, 3);
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t j = 0; j < 3; j++) {
            float any = rng_range(rng, -1, 1), sign = any < 0 ? -1.0f : 1.0f;
            float scale = ldexpf(sign, (int)rng_below(rng, 5) - 2);
            m[k][j] = kind == 0 ? any + (j == k ? 2.0f : 0.0f) : j == (k + turn) % 3 ? scale : 0;
        }
        m[k][3] = rng_range(rng, -8, 8);
        m[k][3] = rng_below(rng, 2) ? m[k][3] : 0;
    }
}

static wide inverse_of(float m[3][4], wide out[3][3])
{
    wide row[3][3], unused, det;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            row[k][j] = (wide)m[k][j];
    det = determinant(row[0], row[1], row[2], &unused);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, p = (k + 1) % 3, q = (k + 2) % 3;
            out[k][j] = (row[a][p] * row[b][q] - row[a][q] * row[b][p]) / det;
        }
    return fabsl(det);
}

static void along(wide m[3][3], const wide from[3], wide to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = m[k][0] * from[0] + m[k][1] * from[1] + m[k][2] * from[2];
}

/* The bounds in the world, or those in the mesh times |det M|; with what the transform moves. */
static void placed_bounds(const struct ray *ray, float v[3][3], float m[3][4], double kappa,
                          struct bounds *out, wide *extra)
{
    wide p[3][3], side[3][3], d[3], inverse[3][3], q[3][3], of[3][3], way[3], far = 0, most = 0;
    struct bounds mesh;
    for (int k = 0; k < 3; k++) {
        wide o = (wide)ray->org[k], hit = 0;
        d[k] = (wide)ray->dir[k];
        for (int c = 0; c < 3; c++) {
            wide at[2];
            for (int n = 0; n < 2; n++) {
                const float *from = v[(c + n) % 3];
                at[n] = (wide)m[k][0] * (wide)from[0] + (wide)m[k][1] * (wide)from[1] +
                        (wide)m[k][2] * (wide)from[2] + (wide)m[k][3];
            }
            p[c][k] = at[0] - o;
            side[c][k] = at[1] - at[0];
            hit = fmaxl(hit, fabsl(at[0]));
            most = fmaxl(most, fabsl(p[c][k]));
        }
        far = fmaxl(far, fabsl(o) + fabsl((wide)m[k][3]) + hit);
    }
    wide size = inverse_of(m, inverse);
    for (int c = 0; c < 3; c++) {
        along(inverse, p[c], q[c]);
        along(inverse, side[c], of[c]);
    }
    along(inverse, d, way);
    bounds_of((const wide(*)[3])p, (const wide(*)[3])side, d, out);
    bounds_of((const wide(*)[3])q, (const wide(*)[3])of, way, &mesh);
    for (int c = 0; c < 3; c++)
        out->edge_most[c] = fmaxl(out->edge_most[c], size * mesh.edge_most[c]);
    wide moved = 64 * (wide)kappa * U * far;
    out->det_most = fmaxl(out->det_most, size * mesh.det_most) +
                    2 * moved * (out->across[0] + out->across[1] + out->across[2]);
    out->t_most = fmaxl(out->t_most, size * mesh.t_most);
    *extra = most > 0 ? moved / (U * most) : 0;
}

static void placed_bounds_are_those_of_their_formula(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 50);
    for (int i = 0; i < 4000; i++) {
        struct one_placed one;
        float v[3][3], m[3][4];
        struct bounds b;
        wide extra;
        struct ray ray = drawn_ray(&rng, 0, v);
        draw_transform(&rng, i % 2, m);
        for (int k = 0; k < 3; k++) {
            v[k][0] = i % 3 ? v[k][0] : 0; /* in a plane of the axes: others products are 0 */
            ray.org[k] = i % 4 ? ray.org[k] : 0;
        }
        place(&one, v, m);
        placed_bounds(&ray, v, m, one.place.kappa, &b, &extra);
        struct judge_rounding r = judge_rounding_at(&one.judge, &ray, 0);
        must_have(&r, &b, 1e-9L);
        same("what the transform moves", r.extra, extra, 1e-9L);
        world_free(&one.world);
    }
}

static void a_placed_triangle_at_the_identity_is_that_of_a_scene(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 50);
    for (int i = 0; i < 200; i++) {
        struct one_placed one;
        float v[3][3], m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
        struct ray ray = drawn_ray(&rng, i % 3, v);
        place(&one, v, m);
        struct judge in_scene = {.scene = one.world.mesh->scene};
        struct judge_rounding placed = judge_rounding_at(&one.judge, &ray, 0);
        struct judge_rounding alone = judge_rounding_at(&in_scene, &ray, 0);
        struct judge_rounding direct = judge_rounding_of(&ray, v);
        assert_memory_equal(&placed, &direct, sizeof direct);
        assert_memory_equal(&alone, &direct, sizeof direct);
        world_free(&one.world);
    }
}

/* A triangle at the ray's origin has no unit. */
static void nothing_moves_by_no_unit(void **state)
{
    (void)state;
    struct one_placed one;
    float v[3][3] = {{0}}, m[3][4] = {{2, 0, 0, 1}, {0, 2, 0, 1}, {0, 0, 2, 1}};
    struct ray ray = {{1, 1, 1}, 0, {1, 2, 3}, INFINITY};
    place(&one, v, m);
    struct judge_rounding r = judge_rounding_at(&one.judge, &ray, 0);
    assert_true(r.tri.unit == 0.0 && r.extra == 0.0 && r.det_most == 0.0);
    world_free(&one.world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_those_of_their_formula),
        cmocka_unit_test(placed_bounds_are_those_of_their_formula),
        cmocka_unit_test(a_placed_triangle_at_the_identity_is_that_of_a_scene),
        cmocka_unit_test(nothing_moves_by_no_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
