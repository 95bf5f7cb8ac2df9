/* Builder sbvh, and what becomes of its trees: nothing of a triangle is lost, in the tree and in
 * every layout; budgets are kept; answers are right. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */

#include "ref/trace/all_hits.h"
#include "ref/build/clip.h"
#include "ref/tree/bvh_json.h"
#include "ref/match/match.h"
#include "ref/packed/packed_file.h"
#include "ref/packed/packed_unpack.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/counted.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

static struct bvh build(const char *builder, const struct scene *scene,
                        struct build_options options)
{
    struct bvh bvh;
    struct reason reason = {""};
    options.leaf = options.leaf ? options.leaf : 4;
    if (bvh_build(builder_find(builder), scene, &options, &bvh, &reason))
        fail_msg("%s: %s", builder, reason.text);
    return bvh;
}

static struct bvh sbvh(const struct scene *scene, float budget)
{
    return build("sbvh", scene, (struct build_options){.split_budget = budget});
}

static struct scene made(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static void must_be_sound(const struct bvh *bvh, const struct scene *scene, const char *what)
{
    struct reason reason = {""};
    if (bvh_check(bvh, scene, &reason))
        fail_msg("%s: %s", what, reason.text);
}

/* Triangles that need cutting: long, thin, in all directions, at very different scales. */
static struct scene long_ones(uint32_t count, float scale, float shift)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(count, 1);
    for (uint32_t i = 0; i < count; i++) {
        float *v = scene.vertex + 9 * (size_t)i;
        for (int c = 0; c < 9; c++)
            v[c] = shift + scale * rng_range(&rng, -1, 1);
        for (int k = 0; k < 3 && i % 3; k++) /* a third vertex beside the first */
            v[6 + k] = v[k] + scale * 0.01f * rng_range(&rng, -1, 1);
        if (i % 16 == 0)
            v[6] = v[3], v[7] = v[4], v[8] = v[5]; /* no area */
    }
    return scene;
}

static void sbvh_loses_nothing(void **state)
{
    (void)state;
    static const float scale[] = {1, 1e-38f, 1e37f, 1, 0x1p-140f};
    static const float shift[] = {0, 0, 0, 1000, 0};
    for (size_t s = 0; s < ARRAY_COUNT(scale); s++)
        for (uint32_t n = 3; n <= 600; n = n * 14 + 1) {
            struct scene scene = long_ones(n, scale[s], shift[s]);
            for (float budget = 0.25f; budget < 8; budget *= 4) {
                struct bvh bvh = sbvh(&scene, budget);
                char what[64];
                (void)snprintf(what, sizeof what, "%u, scale %g, budget %g", n, (double)scale[s],
                               (double)budget);
                must_be_sound(&bvh, &scene, what);
                assert_true((double)bvh.prim_count <= (1 + (double)budget) * n);
                assert_true(n < 600 || bvh_is_split(&bvh));
                bvh_free(&bvh);
            }
            scene_free(&scene);
        }
}

static void sbvh_keeps_its_budget(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=800");
    static const float budget[] = {-1, 0.01f, 0.1f, 0.5f, 1, 3};
    uint32_t before = 0;
    for (size_t i = 0; i < ARRAY_COUNT(budget); i++) {
        struct bvh bvh = sbvh(&scene, budget[i]);
        float share = budget[i] > 0 ? budget[i] : 0;
        assert_in_range(bvh.prim_count, 800, (uint32_t)(800 * (1 + share)));
        if (share == 0 || share >= 0.5f) /* little may be too little for any plane */
            assert_true(bvh_is_split(&bvh) == (share > 0));
        assert_true(bvh.prim_count >= before);
        before = bvh.prim_count;
        must_be_sound(&bvh, &scene, "needles");
        bvh_free(&bvh);
    }
    assert_true(before > 1000);
    scene_free(&scene);
}

/* Every hard scene, with and without its leaves put together anew. */
static void sbvh_of_every_hard_scene(void **state)
{
    (void)state;
    for (size_t i = 0; i < BUILT_SCENES; i++)
        for (uint32_t passes = 0; passes < 2; passes++) {
            const char *what;
            struct scene scene = built_scene(i, &what);
            struct bvh bvh =
                build("sbvh", &scene,
                      (struct build_options){
                          .leaf = 3, .passes = passes, .split_budget = 2, .split_alpha = -1});
            must_be_sound(&bvh, &scene, what);
            assert_in_range(bvh_counted(&bvh, &scene).depth, 0, 60);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

static void sbvh_does_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=17000");
    struct bvh one = build("sbvh", &scene, (struct build_options){.threads = 1});
    struct bvh three = build("sbvh", &scene, (struct build_options){.threads = 3});
    assert_true(bvh_is_split(&one));
    assert_int_equal(one.node_count, three.node_count);
    assert_int_equal(one.prim_count, three.prim_count);
    assert_memory_equal(one.node, three.node, one.node_count * sizeof *one.node);
    assert_memory_equal(one.prim, three.prim, one.prim_count * sizeof *one.prim);
    bvh_free(&one);
    bvh_free(&three);
    scene_free(&scene);
}

/* Every layout that takes it: what is decoded loses nothing either. */
static void split_trees_are_sound_in_every_layout(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=400");
    struct bvh bvh = sbvh(&scene, 1);
    uint32_t packed_in = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        struct packed packed;
        struct reason reason = {""};
        if (layouts_all[i]->faithful)
            continue;
        enum status status = packed_make(layouts_all[i], &bvh, &scene, &packed, &reason);
        if (status == STATUS_LIMIT)
            continue;
        packed_in++;
        assert_int_equal(status, STATUS_OK);
        assert_true(packed.split);
        struct packed_faults faults;
        if (packed_check(&packed, &scene, &faults, &reason))
            fail_msg("%s: %s", layouts_all[i]->name, reason.text);
        packed_free(&packed);
    }
    assert_true(packed_in >= 4);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* A record's box is made smaller, and an item another's: packed_check sees what bvh_check would. */
static void faults_of_a_packed_split_tree_are_found(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=100");
    struct bvh bvh = sbvh(&scene, 1);
    struct packed packed;
    struct packed_faults faults;
    struct reason reason = {""};
    assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, &reason), STATUS_OK);
    uint32_t cuts = 0;
    for (uint32_t i = 1; i < bvh.node_count; i++) {
        float kept = bvh.node[i].bounds.hi[0], *hi = &bvh.node[i].bounds.hi[0];
        *hi = nextafterf(kept, -INFINITY);
        cuts += bvh_check(&bvh, &scene, NULL) == STATUS_INPUT;
        *hi = kept;
    }
    /* Rounded outward, a bound may have an ulp to spare; whole triangles' have not. */
    assert_in_range(cuts, bvh.node_count / 4, bvh.node_count - 1);
    for (uint32_t i = 0; i < packed.item_count; i++) {
        uint32_t kept = packed.item[i];
        packed.item[i] = (kept + 1) % scene.tri_count;
        assert_int_equal(packed_check(&packed, &scene, &faults, &reason), STATUS_INPUT);
        assert_true(faults.loose_boxes + faults.lost_prims + faults.double_prims > 0);
        packed.item[i] = kept;
    }
    assert_int_equal(packed_check(&packed, &scene, &faults, &reason), STATUS_OK);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void split_trees_go_through_files(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=300");
    struct bvh bvh = sbvh(&scene, 1), again, decoded;
    struct packed packed, read;
    struct packed_faults faults;
    struct reason reason = {""};
    char *bytes = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&bytes, &size);
    bvh_json_write(&bvh, stream);
    assert_int_equal(fclose(stream), 0);
    if (bvh_json_read("t", bytes, size, &scene, &again, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(again.prim_count, bvh.prim_count);
    assert_memory_equal(again.prim, bvh.prim, bvh.prim_count * sizeof *bvh.prim);
    must_be_sound(&again, &scene, "from JSON");
    free(bytes);
    assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, &reason), STATUS_OK);
    stream = open_memstream(&bytes, &size);
    packed_file_write(&packed, stream);
    assert_int_equal(fclose(stream), 0);
    assert_int_equal(packed_file_read("t", bytes, size, &scene, &read, &faults, &reason),
                     STATUS_OK);
    assert_string_equal(reason.text, "");
    assert_true(read.split);
    assert_int_equal(packed_unpack(&read, &scene, &decoded, &reason), STATUS_OK);
    assert_memory_equal(decoded.prim, bvh.prim, bvh.prim_count * sizeof *bvh.prim);
    must_be_sound(&decoded, &scene, "decoded");
    free(bytes);
    packed_free(&packed);
    packed_free(&read);
    bvh_free(&again);
    bvh_free(&decoded);
    bvh_free(&bvh);
    scene_free(&scene);
}

#define RAYS 3000

static void make_rays(const struct scene *scene, struct ray **ray)
{
    struct reason reason = {""};
    *ray = calloc(RAYS, sizeof **ray);
    assert_non_null(*ray);
    if (ray_set_make(ray_set_find("mixed"), scene, 7, RAYS, *ray, &reason))
        fail_msg("%s", reason.text);
}

/* Judged exactly: nothing is lost, and nothing is listed twice. */
static void answers_of_split_trees_are_right(void **state)
{
    (void)state;
    static const char *const spec[] = {"needles:n=500", "sphere:n=6", "soup:n=300"};
    struct pool pool = {0};
    for (size_t s = 0; s < ARRAY_COUNT(spec); s++) {
        struct scene scene = made(spec[s]);
        struct ray *ray;
        struct match match;
        struct reason reason = {""};
        make_rays(&scene, &ray);
        struct match_options options = {.builder = builder_find("sbvh"),
                                        .build = {.leaf = 2, .split_budget = 3},
                                        .box = box_test_find("robust"),
                                        .tri = tri_test_find("mt"),
                                        .repeats = 1};
        if (match_make(&scene, ray, RAYS, &options, &pool, &match, &reason))
            fail_msg("%s", reason.text);
        assert_true(bvh_is_split(&match.bvh) || s == 1);
        assert_int_equal(match_pack(&match, layout_find("f32"), &reason), STATUS_OK);
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
            struct row row;
            match_set(&match, options.box, query);
            match_run(&match, engine_find("cpu"), &row);
            if (row.status != ROW_OK || row.differences || row.count[VERDICT_WRONG])
                fail_msg("%s, query %d: status %d, %zu wrong, %zu missed, %zu twice", spec[s],
                         (int)query, (int)row.status, row.count[VERDICT_WRONG],
                         row.wrong[WRONG_MISSED], row.wrong[WRONG_TWICE]);
        }
        match_free(&match);
        free(ray);
        scene_free(&scene);
    }
    pool_free(&pool);
}

static uint64_t triangles_visited(const char *builder, const struct scene *scene,
                                  const struct ray *ray)
{
    struct bvh bvh = build(builder, scene, (struct build_options){0});
    struct packed packed;
    struct trace_counts counts = {0};
    assert_int_equal(packed_make(layout_find("f32"), &bvh, scene, &packed, NULL), STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) {
        struct hit hit;
        assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                 .packed = &packed,
                                                 .box = box_test_find("robust"),
                                                 .tri = tri_test_find("mt"),
                                                 .query = QUERY_CLOSEST},
                                   &ray[i], &hit, &counts),
                         STATUS_OK);
    }
    packed_free(&packed);
    bvh_free(&bvh);
    return counts.tris;
}

static void long_thin_triangles_are_visited_less(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=4000");
    struct ray *ray;
    make_rays(&scene, &ray);
    double sweep = (double)triangles_visited("sah_sweep", &scene, ray);
    double split = (double)triangles_visited("sbvh", &scene, ray);
    if (!(sweep > 1.3 * split))
        fail_msg("sah_sweep visits %.0f triangles, sbvh %.0f", sweep, split);
    free(ray);
    scene_free(&scene);
}

static void clipping_is_never_inside_and_rarely_far_outside(void **state)
{
    (void)state;
    float v[3][3] = {{0, 0, 0}, {3, 1, 7}, {0, 5, 1}};
    struct box box = {{-9, -9, -9}, {9, 9, 9}};
    clip_between(v, 0, 1, 2, &box);
    assert_true(box.lo[0] == 1 && box.hi[0] == 2);
    /* From (1, 1/3) to (1, 11/3) and (2, 2/3) to (2, 7/3). */
    assert_true((double)box.lo[1] <= 1.0 / 3 && 1.0 / 3 - (double)box.lo[1] < 1e-7);
    assert_true((double)box.hi[1] >= 11.0 / 3 && (double)box.hi[1] - 11.0 / 3 < 1e-6);
    struct box beside = {{-9, -9, -9}, {9, 9, 9}};
    clip_between(v, 0, 4, 5, &beside);
    assert_true(clip_is_empty(&beside));
    struct box touch = {{-9, -9, -9}, {9, 9, 9}};
    clip_between(v, 0, 3, 5, &touch);
    assert_true(touch.lo[1] == 1 && touch.hi[1] == 1 && touch.lo[0] == 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sbvh_loses_nothing),
        cmocka_unit_test(sbvh_keeps_its_budget),
        cmocka_unit_test(sbvh_of_every_hard_scene),
        cmocka_unit_test(sbvh_does_not_depend_on_the_number_of_threads),
        cmocka_unit_test(split_trees_are_sound_in_every_layout),
        cmocka_unit_test(faults_of_a_packed_split_tree_are_found),
        cmocka_unit_test(split_trees_go_through_files),
        cmocka_unit_test(answers_of_split_trees_are_right),
        cmocka_unit_test(long_thin_triangles_are_visited_less),
        cmocka_unit_test(clipping_is_never_inside_and_rarely_far_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
