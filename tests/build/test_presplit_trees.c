/* Trees of triangles that are cut before the build: sound, from any builder; answers are right. */
#include "ref/build/presplit.h"
#include "ref/packed/refit.h"
#include "ref/match/match.h"
#include "scenes/rays/rays.h"
#include "tests/build/presplit_fixture.h"
#include "tests/support/counted.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

/* --- trees ------------------------------------------------------------------------------------ */

static bool takes_parts(const struct builder *builder)
{
    return builder_takes(builder, "presplit");
}

static struct bvh build(const struct builder *builder, const struct scene *scene,
                        const struct build_options *options)
{
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder, scene, options, &bvh, &reason))
        fail_msg("%s: %s", builder->name, reason.text);
    return bvh;
}

/* True if some inner node has nothing but one triangle below it. */
static bool has_lone_inner(const struct bvh *bvh)
{
    bool lone = false;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i], *last = node;
        while (last->item_count == 0)
            last = &bvh->node[last->snd];
        bool same = node->item_count == 0;
        for (uint32_t k = node->item_first; k < last->item_first + last->item_count; k++)
            same = same && bvh->prim[k] == bvh->prim[node->item_first];
        lone = lone || same;
    }
    return lone;
}

static void trees_of_any_builder_are_sound(void **state)
{
    (void)state;
    uint32_t split = 0;
    for (size_t s = 0; s < SCENES; s++)
        for (size_t b = 0; builders_all[b]; b++)
            for (uint32_t how = 0; how < 3 && takes_parts(builders_all[b]); how++) {
                const struct build_options options = {.leaf = 1 + (uint32_t)s % 5,
                                                      .passes = how > 0,
                                                      .rotates = how > 1,
                                                      .presplit = how == 1 ? 0.3f : 1};
                const char *what;
                struct reason reason = {""};
                struct scene scene = scene_of(s, &what);
                struct bvh bvh = build(builders_all[b], &scene, &options);
                if (bvh_check(&bvh, &scene, &reason))
                    fail_msg("%s, %s, way %u: %s", builders_all[b]->name, what, how, reason.text);
                struct bvh_stats stats = bvh_counted(&bvh, &scene);
                assert_in_range(stats.depth, 0, 60);
                assert_in_range(stats.largest_leaf, 1, options.leaf);
                assert_true(bvh.prim_count <= presplit_most(scene.tri_count, &options));
                assert_false(has_lone_inner(&bvh));
                split += bvh_is_split(&bvh);
                bvh_free(&bvh);
                scene_free(&scene);
            }
    assert_true(split > SCENES * 7 * 3 / 2);
}

/* A budget of no part at all: parts are whole triangles, and the tree is that of triangles. */
static void whole_triangles_make_the_tree_of_triangles(void **state)
{
    (void)state;
    const struct build_options none = {.leaf = 3}, least = {.leaf = 3, .presplit = 1e-9f};
    for (size_t s = 0; s < SCENES; s++)
        for (size_t b = 0; builders_all[b]; b++) {
            const char *what;
            if (!takes_parts(builders_all[b]))
                continue;
            struct scene scene = scene_of(s, &what);
            struct bvh bvh = build(builders_all[b], &scene, &none);
            struct bvh other = build(builders_all[b], &scene, &least);
            if (!built_same(&bvh, &other))
                fail_msg("%s, %s", builders_all[b]->name, what);
            bvh_free(&bvh);
            bvh_free(&other);
            scene_free(&scene);
        }
}

static void trees_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=17000");
    for (size_t b = 0; builders_all[b]; b++) {
        struct build_options options = {.leaf = 4, .presplit = 0.3f, .threads = 1};
        if (!takes_parts(builders_all[b]))
            continue;
        struct bvh one = build(builders_all[b], &scene, &options);
        assert_true(bvh_is_split(&one));
        for (options.threads = 2; options.threads <= 8; options.threads += 6) {
            struct bvh more = build(builders_all[b], &scene, &options);
            if (!built_same(&one, &more))
                fail_msg("%s, %u threads", builders_all[b]->name, options.threads);
            bvh_free(&more);
        }
        bvh_free(&one);
    }
    scene_free(&scene);
}

/* Those that cut triangles themselves, have integers in stages, or build as published. */
static void some_builders_take_no_parts(void **state)
{
    (void)state;
    static const char *const none[] = {"rtrs", "sbvh", "lbvh30", "lbvh63", "hploc"};
    struct scene scene = made("needles:n=200");
    for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
        const struct builder *builder = builder_find(none[i]);
        struct build_options options = {.leaf = 4, .eps = 1};
        struct bvh bvh = build(builder, &scene, &options), other;
        options.presplit = 2;
        other = build(builder, &scene, &options);
        assert_false(takes_parts(builder));
        assert_true(built_same(&bvh, &other));
        bvh_free(&bvh);
        bvh_free(&other);
    }
    scene_free(&scene);
}

static void more_items_than_a_tree_holds_are_refused(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 4, .presplit = BUILD_PRESPLIT_MOST};
    const struct scene scene = {.tri_count = 1u << 25}; /* is not read */
    struct reason reason = {""};
    for (size_t b = 0; builders_all[b]; b++) {
        struct bvh bvh;
        if (!takes_parts(builders_all[b]))
            continue;
        assert_int_equal(builders_all[b]->build(&scene, &options, &bvh, &reason), STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "use a smaller --presplit"));
        assert_null(bvh.node);
    }
}

/* --- answers ---------------------------------------------------------------------------------- */

static void a_tree_of_parts_is_not_refitted(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 4, .presplit = 1};
    struct scene scene = made("needles:n=200");
    struct bvh bvh = build(builder_find("sah_sweep"), &scene, &options);
    struct reason reason = {""};
    assert_int_equal(bvh_refit(&bvh, &scene, &reason), STATUS_LIMIT);
    bvh_free(&bvh);
    scene_free(&scene);
}

#define RAYS 1500

static void play(struct match *match, const char *what)
{
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        struct row row;
        match_set(match, box_test_find("robust"), query);
        match_run(match, engine_find("cpu"), &row);
        if (row.status != ROW_OK || row.differences || row.count[VERDICT_WRONG])
            fail_msg("%s, query %d: status %d, %zu wrong, %zu missed, %zu twice", what, (int)query,
                     (int)row.status, row.count[VERDICT_WRONG], row.wrong[WRONG_MISSED],
                     row.wrong[WRONG_TWICE]);
    }
}

/* Judged exactly: nothing is lost, and nothing is listed twice. */
static void answers_are_right(void **state)
{
    (void)state;
    static const char *const spec[] = {"needles:n=300", "sphere:n=5", "cornell:n=2"};
    static struct ray ray[RAYS];
    struct pool pool = {0};
    for (size_t s = 0; s < ARRAY_COUNT(spec); s++)
        for (size_t b = 0; builders_all[b]; b++) {
            struct scene scene = made(spec[s]);
            struct match match;
            struct reason reason = {""};
            const struct match_options options = {.builder = builders_all[b],
                                                  .build = {.leaf = 2, .presplit = 1},
                                                  .box = box_test_find("robust"),
                                                  .tri = tri_test_find("mt"),
                                                  .repeats = 1};
            assert_int_equal(ray_set_make(ray_set_find("mixed"), &scene, 7, RAYS, ray, &reason),
                             STATUS_OK);
            if (takes_parts(builders_all[b])) {
                if (match_make(&scene, ray, RAYS, &options, &pool, &match, &reason))
                    fail_msg("%s", reason.text);
                assert_true(bvh_is_split(&match.bvh));
                assert_int_equal(match_pack(&match, layout_find("f32"), &reason), STATUS_OK);
                play(&match, spec[s]);
                match_free(&match);
            }
            scene_free(&scene);
        }
    pool_free(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_of_any_builder_are_sound),
        cmocka_unit_test(whole_triangles_make_the_tree_of_triangles),
        cmocka_unit_test(trees_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(some_builders_take_no_parts),
        cmocka_unit_test(more_items_than_a_tree_holds_are_refused),
        cmocka_unit_test(a_tree_of_parts_is_not_refitted),
        cmocka_unit_test(answers_are_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
