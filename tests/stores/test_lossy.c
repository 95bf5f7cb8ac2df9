/* Laws of every lossy storage: how far vertices move is what was certified, what is stored is what
 * was decoded, and what moved excuses answers, no more. */
#include "ref/match/original.h"
#include "ref/packed/packed_check.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <string.h>

#define RAYS 300u

static const char *const specs[] = {"soup:n=200", "sphere:n=3", "soup:n=100,offset=1000",
                                    "terrain"};

static struct scene scene_of(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 3, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static struct scene decoded_of(const struct lossy *lossy, const struct scene *scene, uint32_t bits,
                               struct quantised *q)
{
    struct scene out;
    struct reason reason = {""};
    if (lossy->move(scene, bits, &out, q, &reason))
        fail_msg("%s", reason.text);
    return out;
}

/* In long double: 64 bits hold the differences and their squares. */
static void expect_certified(const struct scene *from, const struct scene *to,
                             const struct quantised *q)
{
    long double moved[3] = {0}, farthest = 0;
    for (uint32_t i = 0; i < from->vertex_count; i++) {
        long double square = 0;
        for (size_t k = 0; k < 3; k++) {
            long double off = fabsl((long double)from->vertex[3 * i + k] - to->vertex[3 * i + k]);
            moved[k] = fmaxl(moved[k], off);
            square += off * off;
        }
        farthest = fmaxl(farthest, sqrtl(square));
    }
    for (int k = 0; k < 3; k++)
        assert_true(moved[k] == (long double)q->moved[k]);
    assert_true((long double)q->distance >= farthest);
    assert_true((long double)q->distance <= farthest * (1 + 0x1p-49L));
}

static void what_moved_is_certified(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++) {
        const struct lossy *lossy = tri_stores[s]->lossy;
        for (size_t n = 0; lossy && n < ARRAY_COUNT(specs); n++)
            for (uint32_t bits = lossy->bits_least; bits <= lossy->bits_most; bits++) {
                struct quantised q, again;
                struct scene scene = scene_of(specs[n]);
                struct scene decoded = decoded_of(lossy, &scene, bits, &q);
                struct scene twice = decoded_of(lossy, &decoded, bits, &again);
                expect_certified(&scene, &decoded, &q);
                assert_int_equal(q.grid.bits, bits);
                assert_memory_equal(twice.vertex, decoded.vertex,
                                    3 * (size_t)scene.vertex_count * sizeof *scene.vertex);
                assert_true(again.distance == 0);
                assert_memory_equal(decoded.index, scene.index,
                                    3 * (size_t)scene.tri_count * sizeof *scene.index);
                scene_free(&twice);
                scene_free(&decoded);
                scene_free(&scene);
            }
    }
}

static void expect_refused(const struct lossy *lossy, const struct scene *scene, uint32_t bits,
                           enum status want, const char *text)
{
    struct scene out;
    struct quantised q;
    struct reason reason = {""};
    assert_int_equal(lossy->move(scene, bits, &out, &q, &reason), want);
    if (!strstr(reason.text, text))
        fail_msg("'%s' has no '%s'", reason.text, text);
    assert_null(out.vertex);
}

static void bits_and_numbers_that_are_none_are_refused(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++) {
        const struct lossy *lossy = tri_stores[s]->lossy;
        if (!lossy)
            continue;
        struct scene scene = scene_of("soup:n=5");
        expect_refused(lossy, &scene, lossy->bits_least - 1, STATUS_INPUT, "bits; ");
        expect_refused(lossy, &scene, lossy->bits_most + 1, STATUS_INPUT, "bits; ");
        scene.vertex[7] = NAN;
        expect_refused(lossy, &scene, lossy->bits_default, STATUS_INPUT, "vertex 2 is not finite");
        scene.vertex[7] = -INFINITY;
        expect_refused(lossy, &scene, lossy->bits_default, STATUS_INPUT, "vertex 2 is not finite");
        scene_free(&scene);
    }
}

/* A match of the decoded scene, judged for the original too. Returns the row. */
static struct row play(const struct tri_store *store, const struct scene *scene,
                       const struct scene *decoded, const struct quantised *q, double share)
{
    static struct ray ray[RAYS];
    struct reason reason = {""};
    struct pool pool = {0};
    struct match match;
    struct original original;
    struct row row;
    const struct match_options options = {.builder = builder_find("median"),
                                          .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                          .store = store,
                                          .box = box_tests[0],
                                          .tri = tri_test_find("mt"),
                                          .query = QUERY_CLOSEST,
                                          .repeats = 1};
    assert_int_equal(ray_set_make(ray_sets[0], scene, 3, RAYS, ray, NULL), STATUS_OK);
    if (match_make(decoded, ray, RAYS, &options, &pool, &match, &reason) ||
        match_pack(&match, layouts[0], &reason) ||
        packed_check(&match.packed, decoded, NULL, &reason) ||
        original_make(scene, q, ray, RAYS, &original, &reason))
        fail_msg("%s", reason.text);
    match_run(&match, engine_find("cpu"), &row);
    original.quantised.distance *= share;
    assert_int_equal(original_judge(&original, &match, &row), STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) { /* and as `indexed` answers */
        struct job job = {.scene = decoded,
                          .packed = &match.packed,
                          .box = box_tests[0],
                          .tri = tri_tests[i % 3],
                          .query = QUERY_CLOSEST};
        struct hit got, want;
        assert_int_equal(trace_ray(&job, &ray[i], &got, NULL), STATUS_OK);
        struct packed base;
        assert_int_equal(packed_make(layouts[0], &match.bvh, decoded, &base, NULL), STATUS_OK);
        job.packed = &base;
        assert_int_equal(trace_ray(&job, &ray[i], &want, NULL), STATUS_OK);
        assert_memory_equal(&got, &want, sizeof got);
        packed_free(&base);
    }
    original_free(&original);
    match_free(&match);
    pool_free(&pool);
    return row;
}

static void what_moved_excuses_and_no_more(void **state)
{
    (void)state;
    for (size_t s = 0; tri_stores[s]; s++) {
        const struct lossy *lossy = tri_stores[s]->lossy;
        if (!lossy)
            continue;
        for (size_t n = 0; n < 2; n++) {
            struct quantised q;
            struct scene scene = scene_of(specs[n]);
            /* Coarse, so that what moved is more than rounding. */
            uint32_t bits = lossy->bits_least == 1 ? 13 : 10;
            struct scene decoded = decoded_of(lossy, &scene, bits, &q);
            struct row row = play(tri_stores[s], &scene, &decoded, &q, 1);
            assert_int_equal(row.count[VERDICT_WRONG], 0);
            assert_int_equal(row.original.beyond, 0);
            assert_true(row.original.most > q.distance / 20);
            row = play(tri_stores[s], &scene, &decoded, &q, 0.02);
            assert_true(row.original.beyond > 0);
            scene_free(&decoded);
            scene_free(&scene);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moved_is_certified),
        cmocka_unit_test(bits_and_numbers_that_are_none_are_refused),
        cmocka_unit_test(what_moved_excuses_and_no_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
