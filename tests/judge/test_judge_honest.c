/* The judge cries no wolf: honest answers of every kind of engine, on every kind of scene, are
 * never WRONG. At least 100,000 answers a scene. */
#include "ref/match/match.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdio.h>

#define RAYS 10000

/* Scene, moved by an offset and scaled. */
static const struct {
    const char *spec;
    float scale, offset;
} kinds[] = {
    {"soup:n=500", 1, 0},
    {"soup:n=500", 1, 1e4f},      /* far from the origin: bounds are wide, ids uncertain */
    {"soup:n=500", 1e-5f, 0},     /* small */
    {"soup:n=500", 0x1p30f, 0},   /* large, near the contract's border */
    {"sphere:n=8", 1, 0},         /* closed, vertices shared */
    {"grid:n=16,height=0", 1, 0}, /* flat lattice: exact ties, rays in the plane */
    {"grid:n=16", 1, 1e6f},       /* snapped to float32 far away: degenerate triangles */
    {"needles", 1, 0},            /* slivers */
    {"stack", 1, 0},              /* duplicates and coplanar ties */
    {"cornell", 1, 0},            /* axis-aligned, long walls */
    {"platonic", 1, 0},
    {"terrain:k=4", 1, 0},
};

static struct scene kind_of(size_t kind)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(kinds[kind].spec, kind + 1, &scene, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        scene.vertex[i] = scene.vertex[i] * kinds[kind].scale + kinds[kind].offset;
    return scene;
}

static void must_be_honest(const struct row *row, size_t kind)
{
    if (row->status == ROW_SKIPPED) {
        printf("SKIP %s\n", row->reason.text);
        return;
    }
    /* Vacuous: mt_rtrs finds nothing small, and nothing is certain for it there. */
    if ((row->status == ROW_OK || row->status == ROW_VACUOUS) && row->differences == 0 &&
        row->count[VERDICT_WRONG] == 0)
        return;
    char line[500] = "";
    if (row->finding_count)
        judge_line(&row->finding[0].ray, &row->finding[0].judgement, &row->finding[0].got, line,
                   sizeof line);
    fail_msg("%s * %g + %g: %s %s %s: %zu wrong (%s): %s%s", kinds[kind].spec,
             (double)kinds[kind].scale, (double)kinds[kind].offset, row->engine->name,
             row->options.tri->name, query_name(row->options.query), row->count[VERDICT_WRONG],
             wrong_name(row->finding[0].judgement.wrong), line, row->reason.text);
}

/* Everything that can run here and whose formula is known. */
static void known_engines_are_never_wrong(void **state)
{
    (void)state;
    static const char *const names[] = {"cpu", "embree", "embree_robust"};
    static struct ray ray[RAYS];
    static struct row row;
    struct pool pool = {.options = {.device = -1}};
    size_t kept[VERDICT_COUNT] = {0};
    for (size_t kind = 0; kind < ARRAY_COUNT(kinds); kind++) {
        struct scene scene = kind_of(kind);
        struct match match;
        struct reason reason = {""};
        size_t answers = 0;
        struct match_options options = {
            .builder = builders[0],
            .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
            .box = box_test_find("watertight"),
            .tri = tri_tests[0],
            .repeats = 1,
            .brute_budget = UINT64_MAX};
        assert_int_equal(ray_set_make(ray_sets[0], &scene, kind, RAYS, ray, &reason), STATUS_OK);
        if (match_make(&scene, ray, RAYS, &options, &pool, &match, &reason))
            fail_msg("%s", reason.text);
        for (size_t t = 0; tri_tests[t]; t++) {
            assert_int_equal(
                match_rebuild(&match, builders[0], &options.build, tri_tests[t], &reason),
                STATUS_OK);
            assert_int_equal(match_pack(&match, layout_find("f32"), &reason), STATUS_OK);
            for (size_t e = 0; e < (t ? 1 : ARRAY_COUNT(names)); e++)
                for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
                    match_set(&match, options.box, (enum query)query);
                    match_run(&match, engine_find(names[e]), &row);
                    must_be_honest(&row, kind);
                    answers += row.compared;
                    for (int v = 0; v < VERDICT_COUNT; v++)
                        kept[v] += row.count[v];
                }
        }
        assert_true(answers >= (HAVE_EMBREE ? 100000 : 60000));
        match_free(&match);
        scene_free(&scene);
    }
    pool_free(&pool);
    /* Each excuse is needed by someone: without it there would be false alarms. */
    for (int v = VERDICT_TIE; v <= VERDICT_BORDER; v++)
        assert_true(kept[v] > 0);
}

/* --- an arithmetic that takes every liberty -------------------------------------------------- */

/* Rounds to either neighbour, and a quotient up to 2 units farther. */
struct dice {
    struct rng rng;
};

static float roll(struct dice *d, double x, int most)
{
    float near = (float)x;
    int steps = (int)rng_below(&d->rng, (uint32_t)(2 * most + 1)) - most;
    if ((double)near != x && rng_below(&d->rng, 2))
        near = nextafterf(near, (double)near < x ? INFINITY : -INFINITY);
    for (; steps > 0; steps--)
        near = nextafterf(near, INFINITY);
    for (; steps < 0; steps++)
        near = nextafterf(near, -INFINITY);
    return near;
}

static float add(struct dice *d, float a, float b)
{
    return roll(d, (double)a + (double)b, 0);
}

static float mul(struct dice *d, float a, float b)
{
    return roll(d, (double)a * (double)b, 0);
}

static float quotient(struct dice *d, float a, float b)
{
    return a == 0 ? 0 : roll(d, (double)a / (double)b, 1);
}

static float dot(struct dice *d, const float a[3], const float b[3])
{
    return add(d, add(d, mul(d, a[0], b[0]), mul(d, a[1], b[1])), mul(d, a[2], b[2]));
}

static void cross(struct dice *d, const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = add(d, mul(d, a[j], b[k]), -mul(d, a[k], b[j]));
    }
}

static bool dice_mt(struct dice *d, const struct ray *ray, float v[3][3], struct hit *out)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = add(d, v[1][k], -v[0][k]);
        e2[k] = add(d, v[2][k], -v[0][k]);
        s[k] = add(d, ray->org[k], -v[0][k]);
    }
    cross(d, ray->dir, e2, p);
    cross(d, s, e1, q);
    float det = dot(d, e1, p), u = dot(d, s, p), w = dot(d, ray->dir, q), t = dot(d, e2, q);
    float sign = det < 0 ? -1.0f : 1.0f, us = sign * u, ws = sign * w, size = sign * det;
    if (!(size > 0 && us >= 0 && us <= size && ws >= 0 && add(d, us, ws) <= size))
        return false;
    out->t = quotient(d, t, det);
    out->u = quotient(d, u, det);
    out->v = quotient(d, w, det);
    return true;
}

static bool dice_woop(struct dice *d, const struct ray *ray, float v[3][3], struct hit *out)
{
    struct tri_ray r = tri_ray_make(ray);
    float x[3], y[3], z[3], w[3];
    float sx = quotient(d, r.d[r.kx], r.d[r.kz]), sy = quotient(d, r.d[r.ky], r.d[r.kz]);
    float sz = quotient(d, 1, r.d[r.kz]);
    for (int c = 0; c < 3; c++) {
        float az = add(d, v[c][r.kz], -r.o[r.kz]);
        x[c] = add(d, add(d, v[c][r.kx], -r.o[r.kx]), -mul(d, sx, az));
        y[c] = add(d, add(d, v[c][r.ky], -r.o[r.ky]), -mul(d, sy, az));
        z[c] = mul(d, sz, az);
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        w[c] = add(d, mul(d, x[a], y[b]), -mul(d, y[a], x[b]));
    }
    if ((w[0] < 0 || w[1] < 0 || w[2] < 0) && (w[0] > 0 || w[1] > 0 || w[2] > 0))
        return false;
    float det = add(d, add(d, w[0], w[1]), w[2]);
    if (!(det > 0 || det < 0))
        return false;
    out->t = quotient(d, dot(d, w, z), det);
    out->u = quotient(d, w[1], det);
    out->v = quotient(d, w[2], det);
    return true;
}

/* What such an engine answers, over all triangles. */
static struct hit dice_answer(struct dice *d, const struct judge_fixture *c, const struct ray *ray)
{
    struct hit best = {.prim = ABI_NO_PRIM}, hit;
    for (uint32_t prim = 0; prim < c->scene.tri_count; prim++) {
        float v[3][3];
        scene_tri(&c->scene, prim, v);
        bool woop = c->subject->model.formula == TWIN_WOOP;
        if (!(woop ? dice_woop : dice_mt)(d, ray, v, &hit))
            continue;
        if (hit.t < ray->tmin || hit.t > ray->tmax ||
            (best.prim != ABI_NO_PRIM && !(hit.t < best.t)))
            continue;
        best = hit;
        best.prim = prim;
    }
    return best;
}

static void every_liberty_of_vulkan_is_within_the_bounds(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=40", "sphere:n=2", "grid:n=4,height=0", "cornell",
                                        "needles:n=40"};
    struct dice dice = {rng_make(11, 0)};
    static struct ray ray[RAYS];
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct judge_fixture *c = judge_fixture_open(specs[i], 5);
        size_t kept[VERDICT_COUNT] = {0};
        double worst = 0;
        assert_int_equal(ray_set_make(ray_sets[0], &c->scene, 6, RAYS, ray, NULL), STATUS_OK);
        for (size_t s = 3; s <= 4; s++)
            for (int again = 0; again < 6; again++) {
                judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
                for (size_t k = (size_t)again % 3; k < RAYS; k += 3) {
                    if (!ray_in_contract(&ray[k]))
                        continue;
                    judge_fixture_ask(c, ray[k]);
                    struct hit hit = dice_answer(&dice, c, &ray[k]);
                    if (verdict(c, hit) == VERDICT_WRONG)
                        must_be(c, hit, VERDICT_RIGHT);
                    kept[c->judgement.verdict]++;
                    worst = fmax(worst, c->judgement.over);
                }
            }
        assert_true(kept[VERDICT_RIGHT] > 20000);
        assert_true(kept[VERDICT_BOUNDARY] > 0);
        assert_true(worst > 0.05 && worst <= 1.0);
        judge_fixture_close(c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_engines_are_never_wrong),
        cmocka_unit_test(every_liberty_of_vulkan_is_within_the_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
