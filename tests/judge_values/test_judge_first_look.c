/* What is looked at for an answer that names no triangle (ref/judge/judge_unnamed.c), by value:
 * which triangles the first look keeps, of which formulas, and which boxes a ray comes near to. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

typedef long double wide;

/* --- the first look --------------------------------------------------------------------------- */

#define TRIS 150

/* Triangles, of which the scene holds the first `count`; the index of the next is of no vertex. */
struct looked {
    struct scene scene;
    struct judge judge;
    struct ray ray;
};

static struct looked *looked_make(void)
{
    struct looked *out = calloc(1, sizeof *out);
    assert_non_null(out);
    assert_int_equal(scene_make(3 * TRIS, TRIS, &out->scene), STATUS_OK);
    out->judge.scene = &out->scene;
    return out;
}

static void looked_count(struct looked *l, uint32_t count)
{
    for (uint32_t i = 0; i < 3 * TRIS; i++)
        l->scene.index[i] = i < 3 * count ? i : 0xFFFFFFFFu;
    l->scene.tri_count = count;
}

static void looked_free(struct looked *l)
{
    l->scene.tri_count = TRIS;
    scene_free(&l->scene);
    free(l);
}

/* Two edge functions have opposite signs, and are farther from 0 than what is allowed. *near: a
 * matter of the last digits. */
static bool is_dropped(const struct looked *l, uint32_t prim, bool *near)
{
    wide p[3][3], length = 0, size = 0, direction = 0, lowest = INFINITY, highest = -INFINITY;
    float v[3][3];
    scene_tri(&l->scene, prim, v);
    for (int k = 0; k < 3; k++) {
        direction = fmaxl(direction, fabsl((wide)l->ray.dir[k]));
        for (int c = 0; c < 3; c++) {
            p[c][k] = (wide)v[c][k] - (wide)l->ray.org[k];
            size = fmaxl(size, fabsl(p[c][k]));
            length = fmaxl(length, fabsl((wide)v[c][k] - (wide)v[(c + 1) % 3][k]));
        }
    }
    for (int c = 0; c < 3; c++) {
        const wide *a = p[c], *b = p[(c + 1) % 3];
        wide edge = 0;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            edge += (wide)l->ray.dir[k] * (a[i] * b[j] - a[j] * b[i]);
        }
        lowest = fminl(lowest, edge);
        highest = fmaxl(highest, edge);
    }
    wide widest = 1 + fmaxl(direction, fmaxl(size, length));
    wide most = (wide)(3.47 * l->judge.displacement + 505) * 0x1p-24L * size * direction * length +
                0x1p-119L * widest * widest;
    wide off = fminl(fabsl(-lowest - most), fabsl(highest - most));
    *near = off <= 1e-7L * most;
    return -lowest > most && highest > most;
}

/* Where triangles are: of ordinary sizes, and where what is flushed is all that is allowed, of
 * which a small or a large triangle, a far one or a long direction has its share. */
static const struct kind_of_place {
    int direction, scale, along; /* powers of two */
} places[] = {{0, 0, 0},      {-60, -25, 35},  {-90, 0, 110},
              {20, -45, -65}, {-110, 20, 100}, {-110, 0, 110}};

static void draw_ray(struct rng *rng, const struct kind_of_place *at, struct ray *ray)
{
    uint32_t axis = rng_below(rng, 3);
    for (uint32_t k = 0; k < 3; k++) {
        float sign = rng_below(rng, 2) ? 1.0f : -1.0f, any = rng_range(rng, -2, 2);
        ray->org[k] = at->along ? 0 : rng_range(rng, -1, 1);
        ray->dir[k] = !at->along ? any : k == axis ? ldexpf(sign, at->direction) : 0;
    }
}

/* Beside an edge of the triangle, by about what is allowed. */
static void beside(struct rng *rng, const struct kind_of_place *at, struct looked *l, uint32_t prim)
{
    float *v = l->scene.vertex + 9 * prim, off = rng_range(rng, 0, 1);
    float a = rng_range(rng, 0, 1), along = ldexpf(1, at->along);
    uint32_t edge = rng_below(rng, 3);
    float *p = v + 3 * edge, *q = v + 3 * ((edge + 1) % 3), *r = v + 3 * ((edge + 2) % 3);
    off = ldexpf(off, -6 - (int)rng_below(rng, 6));
    for (int k = 0; k < 9; k++)
        v[k] = ldexpf(rng_range(rng, -1, 1), at->scale);
    for (int k = 0; k < 3; k++) {
        float to = p[k] + a * (q[k] - p[k]) - off * (r[k] - p[k]);
        float by = l->ray.org[k] + along * l->ray.dir[k] - to;
        v[k] += by;
        v[k + 3] += by;
        v[k + 6] += by;
    }
}

static void what_is_kept_is_what_may_be_of_one_sign(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 52);
    struct looked *l = looked_make();
    size_t kept = 0, dropped = 0;
    for (int i = 0; i < 3000; i++) {
        const struct kind_of_place *at = &places[i % (int)ARRAY_COUNT(places)];
        uint32_t count = 1 + rng_below(&rng, TRIS - 1), first = rng_below(&rng, count);
        uint32_t left = count - first, some = left < JUDGE_TOGETHER ? left : JUDGE_TOGETHER;
        draw_ray(&rng, at, &l->ray);
        l->judge.displacement = i % 2 ? 32 : (double)rng_range(&rng, 0, 4096);
        looked_count(l, count);
        for (uint32_t prim = 0; prim < count; prim++)
            beside(&rng, at, l, prim);
        uint64_t found = judge_first_look(&l->judge, &l->ray, first, some);
        for (uint32_t k = 0; k < 64; k++) {
            bool near = false, is = found >> k & 1;
            bool must = k < some && !is_dropped(l, first + k, &near);
            if (is != must && !near)
                fail_msg("%d: triangle %u of %u: %d, not %d", i, k, some, is, must);
            kept += is;
            dropped += k < some && !is;
        }
    }
    print_message("kept %zu, dropped %zu\n", kept, dropped);
    looked_free(l);
    assert_true(kept > 20000 && dropped > 10000);
}

/* A triangle of size and length 1 at z = 1, one of whose edges is as far away as is allowed: 505 u.
 * Turned, so that it is each of the three, and mirrored. */
static void what_is_at_the_border_is_kept(void **state)
{
    (void)state;
    struct looked *l = looked_make();
    const float least[2] = {1010 * 0x1p-24f, 1011 * 0x1p-24f};
    l->ray = (struct ray){{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    for (uint32_t turn = 0; turn < 3; turn++)
        for (int mirror = 0; mirror < 2; mirror++)
            for (int beyond = 0; beyond < 2; beyond++) {
                const float corner[3][2] = {{0, -0.5f}, {least[beyond], 0.5f}, {0.5f, 0}};
                for (uint32_t c = 0; c < 3; c++) {
                    float *v = l->scene.vertex + 3 * ((c + turn) % 3);
                    v[0] = corner[c][0];
                    v[1] = mirror ? -corner[c][1] : corner[c][1];
                    v[2] = 1;
                }
                looked_count(l, 1);
                uint64_t kept = judge_first_look(&l->judge, &l->ray, 0, 1);
                assert_int_equal(kept, beyond ? 0 : 1);
            }
    looked_free(l);
}

static void formulas_and_roundings_are_looked_at_that_are_allowed_for(void **state)
{
    (void)state;
    static const double steps[] = {1, 2, 2.5, 5};
    for (int f = 0; f <= TWIN_UNKNOWN; f++)
        for (size_t a = 0; a < ARRAY_COUNT(steps); a++)
            for (size_t m = 0; m < ARRAY_COUNT(steps); m++) {
                struct model model = {.formula = (enum twin_formula)f,
                                      .rounding = {steps[a], steps[m], 9, 0}};
                model.rounding.add = steps[a];
                model.rounding.mul = steps[m];
                bool known =
                    f == TWIN_MT || f == TWIN_MT_RTRS || f == TWIN_EMBREE || f == TWIN_PLUECKER;
                assert_int_equal(judge_looks_first(&model), known && a < 2 && m < 2);
            }
}

/* --- boxes ------------------------------------------------------------------------------------ */

/* The line meets the widened box: some t is in the slabs of all axes. Whole numbers: all is exact
 * but the quotients, and those of powers of two are, too. */
static bool meets(const struct ray *ray, const struct box *box)
{
    wide size = 0, from = -INFINITY, to = INFINITY;
    bool empty = false;
    for (int k = 0; k < 3; k++) {
        size = fmaxl(size, fmaxl(fabsl((wide)box->lo[k]), fabsl((wide)box->hi[k])));
        size = fmaxl(size, fabsl((wide)ray->org[k]));
    }
    for (int k = 0; k < 3; k++) {
        wide d = (wide)ray->dir[k], lo = (wide)box->lo[k] - size / 16 - (wide)ray->org[k];
        wide hi = (wide)box->hi[k] + size / 16 - (wide)ray->org[k];
        if (d == 0) {
            empty = empty || !(lo <= 0 && 0 <= hi);
            continue;
        }
        from = fmaxl(from, (d > 0 ? lo : hi) / d);
        to = fminl(to, (d > 0 ? hi : lo) / d);
    }
    return !empty && from <= to;
}

static void a_ray_comes_near_a_box_that_it_meets_when_widened(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 52);
    size_t near = 0, border = 0;
    for (int i = 0; i < 200000; i++) {
        struct box box;
        struct ray ray = {.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            int a = (int)rng_below(&rng, 33), b = (int)rng_below(&rng, 17), sign = i >> k & 1;
            box.lo[k] = (float)(a - 16);
            box.hi[k] = (float)(a - 16 + b);
            ray.org[k] = (float)((int)rng_below(&rng, 33) - 16);
            ray.dir[k] = ldexpf(sign ? 1 : -1, (int)rng_below(&rng, 3));
            if (rng_below(&rng, 4) == 0)
                ray.dir[k] = 0;
        }
        for (int k = 0; k < 3; k++) { /* whatever the size of all */
            box.lo[k] = ldexpf(box.lo[k], -(i % 16));
            box.hi[k] = ldexpf(box.hi[k], -(i % 16));
            ray.org[k] = ldexpf(ray.org[k], -(i % 16));
        }
        bool found = judge_comes_near(&ray, &box);
        assert_int_equal(found, meets(&ray, &box));
        near += found;
        ray.org[0] += ldexpf(0x1p-10f, -(i % 16)); /* what was at a border is not any more */
        border += found && !meets(&ray, &box);
    }
    print_message("%zu near, %zu at a border\n", near, border);
    assert_true(near > 10000 && border > 100);
}

static void no_ray_comes_near_an_empty_box(void **state)
{
    (void)state;
    const struct box empty = box_empty();
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    assert_false(judge_comes_near(&ray, &empty));
    ray.dir[0] = 1;
    assert_false(judge_comes_near(&ray, &empty));
    struct box point = {{0, 0, 0}, {0, 0, 0}};
    assert_true(judge_comes_near(&ray, &point));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_kept_is_what_may_be_of_one_sign),
        cmocka_unit_test(what_is_at_the_border_is_kept),
        cmocka_unit_test(formulas_and_roundings_are_looked_at_that_are_allowed_for),
        cmocka_unit_test(a_ray_comes_near_a_box_that_it_meets_when_widened),
        cmocka_unit_test(no_ray_comes_near_an_empty_box),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
