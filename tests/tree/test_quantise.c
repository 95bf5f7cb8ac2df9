/* Quantised scenes: how far vertices move is what was certified, what is stored is what was
 * decoded, and closed meshes stay closed. */
#include "ref/match/original.h"
#include "ref/packed/refit.h"
#include "ref/trace/trace.h"
#include "ref/packed/packed_check.h"
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

#define RAYS 400u

static const char *const specs[] = {"soup:n=300", "sphere", "soup:n=200,offset=10000"};
#define SPECS (sizeof specs / sizeof *specs)

static struct scene scene_of(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 3, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static struct scene decoded_of(const struct scene *scene, uint32_t bits, struct quantised *q)
{
    struct scene out;
    struct reason reason = {""};
    if (scene_quantise(scene, bits, &out, q, &reason))
        fail_msg("%s", reason.text);
    return out;
}

/* No vertex moved more than half a step or farther than said, and one did move that far. In long
 * double: 64 bits hold the differences and their squares. */
static void assert_moved(const struct scene *from, const struct scene *to,
                         const struct quantised *q)
{
    long double moved[3] = {0}, farthest = 0;
    for (uint32_t i = 0; i < from->vertex_count; i++) {
        long double square = 0;
        for (size_t k = 0; k < 3; k++) {
            long double x = from->vertex[3 * i + k], y = to->vertex[3 * i + k];
            long double n = y / q->grid.step[k] - q->grid.lo[k];
            assert_true(n == floorl(n) && n >= 0 && n < (1u << q->grid.bits));
            assert_true(fabsl(x - y) <= q->grid.step[k] / 2.0L);
            moved[k] = fmaxl(moved[k], fabsl(x - y));
            square += (x - y) * (x - y);
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
    for (size_t s = 0; s < SPECS; s++) {
        struct scene scene = scene_of(specs[s]);
        double before = INFINITY;
        for (uint32_t bits = QUANTISE_BITS_LEAST; bits <= QUANTISE_BITS_MOST; bits++) {
            struct quantised q, again;
            struct scene decoded = decoded_of(&scene, bits, &q), twice;
            assert_moved(&scene, &decoded, &q);
            assert_true(q.distance <= before);
            assert_memory_equal(decoded.index, scene.index,
                                3 * (size_t)scene.tri_count * sizeof *scene.index);
            before = q.distance;
            twice = decoded_of(&decoded, bits, &again);
            assert_memory_equal(twice.vertex, decoded.vertex,
                                3 * (size_t)scene.vertex_count * sizeof *scene.vertex);
            assert_true(again.distance == 0.0);
            scene_free(&twice);
            scene_free(&decoded);
        }
        scene_free(&scene);
    }
}

/* Every item of every leaf has the decoded scene's vertices, and every answer is `indexed`'s. */
static void what_is_stored_is_what_was_decoded(void **state)
{
    (void)state;
    static const uint32_t bits[] = {8, 13, 16, 21};
    for (size_t n = 0; n < SPECS * 4; n++) {
        struct scene scene = scene_of(specs[n / 4]);
        struct quantised q;
        struct scene decoded = decoded_of(&scene, bits[n % 4], &q);
        struct build_options options = {.leaf = 5, .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh;
        struct packed packed, base;
        struct packed_faults faults;
        struct reason reason = {""};
        struct ray ray[RAYS];
        assert_int_equal(builder_find("median")->build(&decoded, &options, &bvh, NULL), STATUS_OK);
        assert_int_equal(ray_set_make(ray_sets[0], &scene, 3, RAYS, ray, NULL), STATUS_OK);
        assert_int_equal(packed_make(layouts[0], &bvh, &decoded, &base, NULL), STATUS_OK);
        if (packed_make_stored(layouts[0], tri_store_find("quantised"), &bvh, &decoded, &packed,
                               &reason) ||
            packed_check(&packed, &decoded, &faults, &reason))
            fail_msg("%s, %u bits: %s", specs[n / 4], bits[n % 4], reason.text);
        for (size_t i = 0; i < RAYS; i++) {
            struct hit got, want;
            struct job job = {.scene = &decoded,
                              .packed = &base,
                              .box = box_tests[0],
                              .tri = tri_tests[i % 3],
                              .query = QUERY_CLOSEST};
            assert_int_equal(trace_ray(&job, &ray[i], &want, NULL), STATUS_OK);
            job.packed = &packed;
            assert_int_equal(trace_ray(&job, &ray[i], &got, NULL), STATUS_OK);
            assert_memory_equal(&got, &want, sizeof got);
        }
        assert_int_equal(packed_refit(&packed, &scene, &reason), STATUS_LIMIT);
        assert_string_equal(reason.text, "rebuild: storage quantised is of one scene's grid");
        packed_free(&packed);
        packed_free(&base);
        bvh_free(&bvh);
        scene_free(&decoded);
        scene_free(&scene);
    }
}

/* Rays from the middle of a closed mesh: none leaves it, at any number of bits. */
static void a_closed_mesh_stays_closed(void **state)
{
    (void)state;
    struct scene scene = scene_of("sphere");
    for (uint32_t bits = QUANTISE_BITS_LEAST; bits <= QUANTISE_BITS_MOST; bits += 4) {
        struct quantised q;
        struct scene decoded = decoded_of(&scene, bits, &q);
        size_t leaks = 0;
        const struct box middle = scene_bounds(&decoded);
        assert_int_equal(q.flat, 0);
        for (uint32_t i = 0; i < 3 * decoded.tri_count; i++) {
            const float *at = decoded.vertex + 3 * (size_t)decoded.index[i],
                        *to = decoded.vertex + 3 * (size_t)decoded.index[i - i % 3 + (i + 1) % 3];
            struct ray ray = {.tmax = INFINITY};
            struct hit hit;
            for (int k = 0; k < 3; k++) {
                ray.org[k] = 0.5f * (middle.lo[k] + middle.hi[k]);
                ray.dir[k] = (i % 2 ? at[k] : 0.5f * (at[k] + to[k])) - ray.org[k];
            }
            trace_brute(&decoded, tri_test_find("woop"), QUERY_CLOSEST, &ray, &hit);
            leaks += hit.prim == ABI_NO_PRIM;
        }
        assert_int_equal(leaks, 0);
        scene_free(&decoded);
    }
    scene_free(&scene);
}

static void expect(enum status want, const struct scene *scene, uint32_t bits, const char *text)
{
    struct scene out;
    struct quantised q;
    struct reason reason = {""};
    assert_int_equal(scene_quantise(scene, bits, &out, &q, &reason), want);
    if (!strstr(reason.text, text))
        fail_msg("'%s' has no '%s'", reason.text, text);
    assert_null(out.vertex);
}

static void what_has_no_grid_is_refused(void **state)
{
    (void)state;
    struct scene scene = scene_of("soup:n=20");
    struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct packed packed;
    struct reason reason = {""};
    expect(STATUS_INPUT, &scene, 7, "7 bits");
    expect(STATUS_INPUT, &scene, 22, "22 bits");
    assert_int_equal(builder_find("median")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    assert_int_equal(
        packed_make_stored(layouts[0], tri_store_find("quantised"), &bvh, &scene, &packed, &reason),
        STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "storage quantised: the scene's x coordinates"));
    assert_null(packed.item);
    bvh_free(&bvh);
    scene.vertex[4] = FLT_MAX;
    expect(STATUS_LIMIT, &scene, 16, "vertex 1: 0x1.fffffep+127 is above half");
    scene.vertex[4] = INFINITY;
    expect(STATUS_INPUT, &scene, 16, "vertex 1 is not finite");
    scene_free(&scene);
}

/* Subnormals and the largest numbers, all in one place, and triangles that fold to a line. */
static void hard_scenes_are_quantised(void **state)
{
    (void)state;
    static const float sets[][3] = {{0x1p-149f, 0x1.8p-130f, -0x1p-126f},
                                    {FLT_MAX / 2, -FLT_MAX / 2, 0x1p-149f},
                                    {0x1.000002p20f, 0x1.000004p20f, 0x1.000006p20f},
                                    {-0.0f, -0x1p-149f, 0.0f},
                                    {-3.0f, -3.0f, -3.0f}};
    for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
        for (uint32_t bits = QUANTISE_BITS_LEAST; bits <= QUANTISE_BITS_MOST; bits++) {
            struct scene scene;
            struct quantised q;
            struct grid grid;
            assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
            for (uint32_t i = 0; i < 9; i++)
                scene.vertex[i] = sets[s][(i + i / 3) % 3];
            for (uint32_t i = 0; i < 3; i++)
                scene.index[i] = i;
            struct scene decoded = decoded_of(&scene, bits, &q);
            assert_moved(&scene, &decoded, &q);
            assert_int_equal(grid_of_scene(&decoded, &grid, NULL), STATUS_OK);
            assert_true(grid.bits <= bits);
            if (s == 4 || s == 3)
                assert_int_equal(q.flat, 1);
            scene_free(&decoded);
            scene_free(&scene);
        }
}

/* Answers for the decoded scene need what was certified to be right for the original; nine
 * tenths of what they need do not excuse them all, nor a twentieth of what was certified. */
static void what_moved_excuses_and_no_more(void **state)
{
    (void)state;
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct scene scene = scene_of("sphere");
        struct quantised q;
        struct scene decoded = decoded_of(&scene, 10, &q);
        static struct ray ray[RAYS];
        struct reason reason = {""};
        struct pool pool = {0};
        struct match match;
        struct original original;
        struct row row;
        const struct match_options options = {
            .builder = builder_find("median"),
            .build = {.leaf = 5, .eps = BUILD_EPS_DEFAULT},
            .store = tri_store_find("quantised"),
            .box = box_tests[0],
            .tri = tri_test_find("mt"),
            .query = query,
            .repeats = 1,
        };
        assert_int_equal(ray_set_make(ray_sets[0], &scene, 3, RAYS, ray, NULL), STATUS_OK);
        if (match_make(&decoded, ray, RAYS, &options, &pool, &match, &reason) ||
            match_pack(&match, layouts[0], &reason) ||
            original_make(&scene, &q, ray, RAYS, &original, &reason))
            fail_msg("%s", reason.text);
        match_run(&match, engine_find("cpu"), &row);
        assert_int_equal(original_judge(&original, &match, &row), STATUS_OK);
        assert_int_equal(row.count[VERDICT_WRONG], 0);
        assert_int_equal(row.original.judged, RAYS);
        assert_int_equal(row.original.beyond, 0);
        assert_true(row.original.most > q.distance / 20 &&
                    row.original.most <= q.distance + row.original.most_decoded);
        const double less[] = {0.9 * row.original.most, q.distance / 20};
        for (size_t i = 0; i < ARRAY_COUNT(less); i++) {
            original.quantised.distance = less[i];
            memset(&row.original, 0, sizeof row.original);
            row.differences = 0;
            assert_int_equal(original_judge(&original, &match, &row), STATUS_OK);
            assert_true(row.original.beyond > 0 && row.differences == row.original.beyond);
        }
        original_free(&original);
        match_free(&match);
        pool_free(&pool);
        scene_free(&decoded);
        scene_free(&scene);
    }
}

/* Answers that are changed by hand are counted as what they are for the original: a hit taken away,
 * one put where there is none, another triangle's. Each needs far more than vertices moved. */
static void kinds_of_what_is_other_are_counted(void **state)
{
    (void)state;
    struct scene scene = scene_of("sphere");
    struct quantised q;
    struct scene decoded = decoded_of(&scene, 16, &q);
    static struct ray ray[RAYS];
    struct reason reason = {""};
    struct pool pool = {0};
    struct match match;
    struct original original;
    struct row row;
    const struct match_options options = {.builder = builder_find("median"),
                                          .build = {.leaf = 5, .eps = BUILD_EPS_DEFAULT},
                                          .store = tri_store_find("quantised"),
                                          .box = box_tests[0],
                                          .tri = tri_test_find("mt"),
                                          .query = QUERY_CLOSEST,
                                          .repeats = 1};
    assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 3, RAYS, ray, NULL), STATUS_OK);
    if (match_make(&decoded, ray, RAYS, &options, &pool, &match, &reason) ||
        match_pack(&match, layouts[0], &reason) ||
        original_make(&scene, &q, ray, RAYS, &original, &reason))
        fail_msg("%s", reason.text);
    match_run(&match, engine_find("cpu"), &row);
    size_t lost = 0, phantom = 0, other = 0, judged = 0;
    for (size_t i = 0; i < RAYS; i++) {
        struct hit *hit = &match.answer[i];
        judged += ray_in_contract(&ray[i]);
        if (!ray_in_contract(&ray[i]) || i % 3 > 0 || hit->prim != original.truth[i].prim)
            continue;
        if (hit->prim == ABI_NO_PRIM) {
            *hit = (struct hit){.t = 1, .prim = 0};
            phantom++;
        } else if (lost < 5) {
            *hit = (struct hit){.prim = ABI_NO_PRIM};
            lost++;
        } else {
            hit->prim = (hit->prim + decoded.tri_count / 2) % decoded.tri_count;
            other++;
        }
    }
    assert_true(lost == 5 && phantom > 6 && other > 6);
    row.differences = 7;
    assert_int_equal(original_judge(&original, &match, &row), STATUS_OK);
    assert_int_equal(row.original.judged, judged);
    assert_int_equal(row.original.lost, lost);
    assert_int_equal(row.original.phantom, phantom);
    assert_int_equal(row.original.other, other);
    assert_int_equal(row.differences, 7 + row.original.beyond);
    original_free(&original);
    match_free(&match);
    pool_free(&pool);
    scene_free(&decoded);
    scene_free(&scene);
}

/* What else a scene has comes along. */
static void all_else_of_a_scene_is_kept(void **state)
{
    (void)state;
    struct scene scene = scene_of("cornell");
    struct quantised q;
    struct scene decoded = decoded_of(&scene, 12, &q);
    assert_true(scene.material_of && scene.material_count > 0 && scene.light_count > 0);
    assert_memory_equal(decoded.material_of, scene.material_of,
                        scene.tri_count * sizeof *scene.material_of);
    assert_int_equal(decoded.material_count, scene.material_count);
    assert_memory_equal(decoded.material, scene.material,
                        scene.material_count * sizeof *scene.material);
    assert_int_equal(decoded.light_count, scene.light_count);
    assert_memory_equal(decoded.light, scene.light, scene.light_count * sizeof *scene.light);
    assert_int_equal(decoded.has_camera, scene.has_camera);
    assert_memory_equal(&decoded.camera, &scene.camera, sizeof scene.camera);
    assert_int_equal(decoded.normal != NULL, scene.normal != NULL);
    scene_free(&decoded);
    scene_free(&scene);
}

/* 2^21 codes fit, one more does not. */
static void the_widest_grid_has_an_end(void **state)
{
    (void)state;
    for (uint32_t more = 0; more < 2; more++) {
        struct scene scene;
        struct grid grid;
        assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 9; i++)
            scene.vertex[i] = i == 0   ? (float)((1u << QUANTISE_BITS_MOST) - 1 + more)
                              : i == 3 ? 1.0f
                                       : 0.0f;
        for (uint32_t i = 0; i < 3; i++)
            scene.index[i] = i;
        assert_int_equal(grid_of_scene(&scene, &grid, NULL), more ? STATUS_LIMIT : STATUS_OK);
        if (!more)
            assert_int_equal(grid.bits, QUANTISE_BITS_MOST);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moved_is_certified),
        cmocka_unit_test(what_is_stored_is_what_was_decoded),
        cmocka_unit_test(a_closed_mesh_stays_closed),
        cmocka_unit_test(what_has_no_grid_is_refused),
        cmocka_unit_test(hard_scenes_are_quantised),
        cmocka_unit_test(what_moved_excuses_and_no_more),
        cmocka_unit_test(all_else_of_a_scene_is_kept),
        cmocka_unit_test(the_widest_grid_has_an_end),
        cmocka_unit_test(kinds_of_what_is_other_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
