/* Laws of ref/engines/engine_embree.c: what the reference relies on when it asks Embree. Both of
 * its engines; skipped with the reason where Embree cannot run. */
#include "ref/engine.h"
#include "ref/engines/embree_modes.h"
#include "ref/judge/judge.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define RAYS 3000
#define TMAX 1e30f

/* An opened engine and its last answers. */
struct opened {
    const struct engine *engine;
    void *self;
    struct trace_report report;
    struct reason reason;
};

static const char *const names[] = {"embree", "embree_robust"};

static struct opened open_named(size_t which)
{
    const struct engine_options options = {.threads = 2, .device = -1};
    struct opened o = {.engine = engine_find(names[which])};
    assert_non_null(o.engine);
    enum status status = engine_open(o.engine, &options, &o.self, &o.reason);
    if (status == STATUS_UNSUPPORTED) {
        assert_null(o.self);
        assert_true(strlen(o.reason.text) > 10);
        printf("SKIP %s\n", o.reason.text);
        skip();
    }
    assert_int_equal(status, STATUS_OK);
    return o;
}

static void prepare(struct opened *o, const struct scene *scene, enum query query)
{
    struct job job = {.scene = scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    if (o->engine->prepare(o->self, &job, &o->reason))
        fail_msg("%s", o->reason.text);
}

static void ask(struct opened *o, const struct ray *ray, size_t count, struct hit *hit)
{
    if (o->engine->trace(o->self, ray, count, hit, &o->report, &o->reason))
        fail_msg("%s", o->reason.text);
}

static struct hit ask_one(struct opened *o, struct ray ray)
{
    struct hit hit = {1, 2, 3, 4};
    ask(o, &ray, 1, &hit);
    return hit;
}

static struct scene generated(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

/* Judges Embree's answers to `ray` and returns its hits. */
static size_t judged_hits(struct opened *o, const struct scene *scene, enum query query,
                          const struct ray *ray, size_t count)
{
    struct model model = engine_model(o->engine, o->self, tri_tests[0]);
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer *truth = calloc(count, sizeof *truth);
    struct hit *hit = calloc(count, sizeof *hit);
    size_t hits = 0;
    assert_non_null(hit);
    assert_non_null(truth);
    assert_int_equal(oracle_make(scene, &oracle, &o->reason), STATUS_OK);
    assert_int_equal(judge_make(oracle, &model, query, &judge, &o->reason), STATUS_OK);
    assert_int_equal(
        oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, count, 0, truth, NULL, &o->reason),
        STATUS_OK);
    prepare(o, scene, query);
    ask(o, ray, count, hit);
    for (size_t i = 0; i < count; i++) {
        struct judgement judgement;
        char line[400];
        hits += hit[i].prim != ABI_NO_PRIM;
        assert_int_equal(judge_answer(judge, &ray[i], &truth[i], &hit[i], &judgement), STATUS_OK);
        if (judgement.verdict != VERDICT_WRONG)
            continue;
        judge_line(&ray[i], &judgement, &hit[i], line, sizeof line);
        fail_msg("%s %s ray %zu %s: %s", o->engine->name, query_name(query), i,
                 wrong_name(judgement.wrong), line);
    }
    judge_free(judge);
    oracle_free(oracle);
    free(truth);
    free(hit);
    return hits;
}

static void embree_agrees_with_the_exact_truth(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "sphere:n=5", "grid:n=8,height=0", "cornell"};
    static struct ray ray[RAYS];
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
            struct opened o = open_named(which);
            struct scene scene = generated(specs[s]);
            assert_int_equal(ray_set_make(ray_sets[0], &scene, 5, RAYS, ray, NULL), STATUS_OK);
            size_t closest = judged_hits(&o, &scene, QUERY_CLOSEST, ray, RAYS);
            size_t any = judged_hits(&o, &scene, QUERY_ANY, ray, RAYS);
            assert_true(closest > RAYS / 10);
            assert_true(any > RAYS / 10);
            assert_true(o.report.ns > 0 && !o.report.device_clock);
            o.engine->close(o.self);
            scene_free(&scene);
        }
}

/* Packets and the other modes answer what single rays are answered, to the triangle but for the few
 * rays that a different tree or order of work decides otherwise; rays that Embree does not take,
 * and lanes beyond the last ray, have no hit. */
static void modes_answer_as_single_rays(void **state)
{
    (void)state;
    enum { COUNT = 1003 }; /* not a multiple of 16 */
    static struct ray ray[COUNT];
    static struct hit single[COUNT], hit[COUNT + 1];
    struct scene scene = generated("soup:n=300");
    assert_int_equal(ray_set_make(ray_sets[0], &scene, 5, COUNT, ray, NULL), STATUS_OK);
    for (size_t i = 0; i < COUNT; i += 7)
        ray[i].tmin = -1; /* not taken */
    for (size_t mode = 0; embree_modes[mode]; mode++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct opened a = open_named(0), b = {.engine = embree_modes[mode]};
            const struct engine_options options = {.threads = 2, .device = -1};
            size_t same = 0, hits = 0;
            assert_int_equal(engine_open(b.engine, &options, &b.self, &b.reason), STATUS_OK);
            prepare(&a, &scene, (enum query)query);
            prepare(&b, &scene, (enum query)query);
            hit[COUNT].prim = 12345;
            ask(&a, ray, COUNT, single);
            ask(&b, ray, COUNT, hit);
            for (size_t i = 0; i < COUNT; i++) {
                same += single[i].prim == hit[i].prim;
                hits += hit[i].prim != ABI_NO_PRIM;
                assert_true(i % 7 != 0 || hit[i].prim == ABI_NO_PRIM);
            }
            assert_int_equal(hit[COUNT].prim, 12345);
            assert_in_range(same, COUNT - 5, COUNT);
            assert_in_range(hits, COUNT / 10, COUNT);
            a.engine->close(a.self);
            b.engine->close(b.self);
        }
    scene_free(&scene);
}

/* t, u, v and the triangle's name mean what ours do. */
static void embree_hits_are_in_our_terms(void **state)
{
    (void)state;
    struct scene scene = trees_grid(300);
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        struct opened o = open_named(which);
        prepare(&o, &scene, QUERY_CLOSEST);
        for (uint32_t prim = 0; prim < 300; prim++) {
            const float *p = scene.vertex + 9 * (size_t)prim;
            struct hit hit = ask_one(
                &o, (struct ray){{p[0] + 0.03125f, p[1] + 0.0625f, 4}, 0, {0, 0, -2}, TMAX});
            assert_int_equal(hit.prim, prim);
            assert_true(fabsf(hit.t - 2) < 1e-5f); /* in multiples of the direction */
            assert_true(fabsf(hit.u - 0.25f) < 1e-4f && fabsf(hit.v - 0.5f) < 1e-4f);
        }
        struct hit miss = ask_one(&o, (struct ray){{-1, -1, 4}, 0, {0, 0, -2}, TMAX});
        assert_true(miss.prim == ABI_NO_PRIM && miss.t == 0 && miss.u == 0 && miss.v == 0);
        o.engine->close(o.self);
    }
    scene_free(&scene);
}

static void rays_that_embree_asserts_on_are_misses(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 2e18f, -2e18f, 3e38f};
    struct scene scene = trees_grid(100);
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct opened o = open_named(which);
            prepare(&o, &scene, (enum query)query);
            for (int word = 0; word < 8; word++)
                for (size_t b = 0; b < ARRAY_COUNT(bad); b++) {
                    float w[8] = {0.03f, 0.03f, 4, 0, 0, 0, -1, TMAX};
                    struct ray ray;
                    memcpy(&ray, w, sizeof ray);
                    assert_int_equal(ask_one(&o, ray).prim, 0);
                    w[word] = bad[b];
                    memcpy(&ray, w, sizeof ray);
                    struct hit hit = ask_one(&o, ray);
                    bool harmless = word == 7 && bad[b] > 4; /* a tmax */
                    assert_int_equal(hit.prim, harmless ? 0 : ABI_NO_PRIM);
                }
            struct ray behind = {{0.03f, 0.03f, 4}, -1, {0, 0, -1}, TMAX};
            struct ray empty = {{0.03f, 0.03f, 4}, 5, {0, 0, -1}, 3};
            struct ray still = {{0.03f, 0.03f, 0}, 0, {0, -0.0f, 0}, TMAX};
            assert_int_equal(ask_one(&o, behind).prim, ABI_NO_PRIM);
            assert_int_equal(ask_one(&o, empty).prim, ABI_NO_PRIM);
            assert_int_equal(ask_one(&o, still).prim, ABI_NO_PRIM);
            o.engine->close(o.self);
        }
    scene_free(&scene);
}

/* Where its conventions differ (ends of the range, borders, rays in a plane) the judge knows. */
static void embrees_conventions_are_allowed(void **state)
{
    (void)state;
    struct scene scene = generated("grid:n=16,height=0");
    struct box box = scene_bounds(&scene);
    struct ray ray[400];
    size_t count = 0;
    int up = 0; /* the axis the grid is flat in */
    while (box.lo[up] != box.hi[up])
        up++;
    int a = (up + 1) % 3, b = (up + 2) % 3;
    for (int i = 0; i < 33; i++)
        for (int side = 0; side < 3; side++)
            for (int end = 0; end < 4; end++) {
                float at = (float)i / 32, mid[3] = {0, 0.5f, 1};
                struct ray r = {.tmax = TMAX};
                r.org[a] = box.lo[a] + mid[side] * (box.hi[a] - box.lo[a]);
                r.org[b] = box.lo[b] + at * (box.hi[b] - box.lo[b]);
                r.org[up] = box.lo[up] - 2; /* t = 2 */
                r.dir[up] = 1;
                r.dir[a] = i % 2 ? -0.0f : 0.0f;
                if (end == 1)
                    r.tmin = 2;
                if (end == 2)
                    r.tmax = 2;
                if (end == 3) { /* in the plane */
                    r.org[up] = box.lo[up];
                    r.dir[up] = 0;
                    r.dir[a] = 1;
                    r.org[a] -= 3;
                }
                ray[count++] = r;
            }
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct opened o = open_named(which);
            assert_true(judged_hits(&o, &scene, (enum query)query, ray, count) > count / 8);
            o.engine->close(o.self);
        }
    scene_free(&scene);
}

static void an_empty_scene_and_no_rays_are_fine(void **state)
{
    (void)state;
    struct scene empty, one = trees_grid(1);
    assert_int_equal(scene_make(0, 0, &empty), STATUS_OK);
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct opened o = open_named(which);
            prepare(&o, &empty, (enum query)query);
            struct ray ray = {{0.03f, 0.03f, 4}, 0, {0, 0, -1}, TMAX};
            assert_int_equal(ask_one(&o, ray).prim, ABI_NO_PRIM);
            ask(&o, NULL, 0, NULL);
            prepare(&o, &one, (enum query)query);
            ask(&o, NULL, 0, NULL);
            assert_int_equal(ask_one(&o, ray).prim, 0);
            o.engine->close(o.self);
            o.engine->close(NULL);
        }
    scene_free(&empty);
    scene_free(&one);
}

static void triangles_without_area_are_never_hit(void **state)
{
    (void)state;
    static const float line[3][3] = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}};
    static const float point[3][3] = {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (int flat = 0; flat < 2; flat++) {
            struct scene scene = trees_copies(9, flat ? line : point);
            struct opened o = open_named(which);
            prepare(&o, &scene, QUERY_CLOSEST);
            struct ray ray = {{1, 1, 4}, 0, {0, 0, -1}, TMAX};
            assert_int_equal(ask_one(&o, ray).prim, ABI_NO_PRIM);
            o.engine->close(o.self);
            scene_free(&scene);
        }
}

static void the_last_prepare_counts_and_memory_is_its_own(void **state)
{
    (void)state;
    struct scene large = generated("soup:n=20000"), small = trees_grid(10);
    struct ray ray = {{0.03f, 0.03f, 4}, 0, {0, 0, -1}, TMAX};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        struct opened o = open_named(which);
        uint64_t first = 0;
        for (int again = 0; again < 3; again++) {
            prepare(&o, &large, QUERY_CLOSEST);
            prepare(&o, &large, QUERY_CLOSEST);
            ask_one(&o, ray);
            uint64_t bytes = o.report.memory_bytes;
            assert_true(bytes > 12 * ((uint64_t)large.vertex_count + large.tri_count));
            first = first ? first : bytes;
            assert_true(bytes < 2 * first); /* nothing piles up */
            prepare(&o, &small, QUERY_ANY);
            assert_int_equal(ask_one(&o, ray).prim, 0);
            assert_true(o.report.memory_bytes > 0 && o.report.memory_bytes < bytes);
        }
        o.engine->close(o.self);
    }
    scene_free(&large);
    scene_free(&small);
}

/* False if subnormals are flushed, read or written, on this thread. */
static bool subnormals_live(void)
{
    volatile float tiny = 1e-40f, least = FLT_MIN, one = 1, half = 0.5f;
    volatile float read = tiny * one, written = least * half;
    return read != 0 && written != 0 && tiny > 0;
}

/* Embree's build wants flush-to-zero; the reference computes on the same threads. */
static void subnormals_are_not_left_flushed(void **state)
{
    (void)state;
    struct scene scene = generated("soup:n=5000");
    assert_true(subnormals_live());
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        struct opened o = open_named(which);
        assert_true(subnormals_live());
        prepare(&o, &scene, QUERY_CLOSEST);
        assert_true(subnormals_live());
        ask_one(&o, (struct ray){{0.1f, 0.1f, 4}, 0, {0, 0, -1}, TMAX});
        int flushed = 0;
#pragma omp parallel for reduction(+ : flushed)
        for (int i = 0; i < 64; i++)
            flushed += !subnormals_live();
        assert_int_equal(flushed, 0);
        o.engine->close(o.self);
        assert_true(subnormals_live());
    }
    scene_free(&scene);
}

static void embree_says_what_it_is(void **state)
{
    (void)state;
    const struct engine_options options = {.threads = 1, .device = -1};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        const struct engine *engine = engine_find(names[which]);
        char text[200] = "", cut[8];
        assert_false(engine->needs_packed || engine_model(engine, NULL, tri_tests[0]).bits);
        engine_describe(engine, &options, text, sizeof text);
        assert_non_null(strstr(text, HAVE_EMBREE ? "Embree " : "built without Embree"));
        engine_describe(engine, &options, cut, sizeof cut);
        assert_true(strlen(cut) < sizeof cut);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(embree_agrees_with_the_exact_truth),
        cmocka_unit_test(modes_answer_as_single_rays),
        cmocka_unit_test(embree_hits_are_in_our_terms),
        cmocka_unit_test(rays_that_embree_asserts_on_are_misses),
        cmocka_unit_test(embrees_conventions_are_allowed),
        cmocka_unit_test(an_empty_scene_and_no_rays_are_fine),
        cmocka_unit_test(triangles_without_area_are_never_hit),
        cmocka_unit_test(the_last_prepare_counts_and_memory_is_its_own),
        cmocka_unit_test(subnormals_are_not_left_flushed),
        cmocka_unit_test(embree_says_what_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
