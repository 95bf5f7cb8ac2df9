/* Triangles that are cut before the build: nothing of them is lost, the budget is kept, the parts lie
 * on both sides of planes, and trees of them are sound, whoever builds. */
#include "ref/build/presplit.h"
#include "ref/build/room.h"
#include "ref/packed/refit.h"
#include "ref/match/match.h"
#include "ref/tree/cover.h"
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

static const float shares[] = {0.04f, 0.3f, 1, 6};

static struct scene made(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

/* Long thin triangles in all directions, some without area; `scale` 0x1p-146 makes subnormals. */
static struct scene slivers(uint32_t count, float scale)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(count, 3);
    for (uint32_t i = 0; i < count; i++) {
        float *v = scene.vertex + 9 * (size_t)i;
        for (int c = 0; c < 9; c++)
            v[c] = scale * rng_range(&rng, -1, 1);
        for (int k = 0; k < 3 && i % 3; k++)
            v[6 + k] = v[k] + scale * 0.001f * rng_range(&rng, -1, 1);
        if (i % 8 == 0)
            v[6] = v[3], v[7] = v[4], v[8] = v[5];
    }
    return scene;
}

#define SPECS   5u
#define SLIVERS 4u
#define SCENES  (BUILT_SCENES + SPECS + SLIVERS)

/* Scene i of SCENES: soups, slivers, needles, axis-aligned, degenerate and subnormal triangles. */
static struct scene scene_of(size_t i, const char **what)
{
    static const char *const spec[SPECS] = {"needles:n=500", "cornell:n=2", "sphere:n=6",
                                            "platonic:which=4,rows=3", "terrain:k=3"};
    static const float scale[SLIVERS] = {1, 0x1p-146f, 1e37f, 1e-20f};
    if (i < BUILT_SCENES)
        return built_scene(i, what);
    i -= BUILT_SCENES;
    *what = i < SPECS ? spec[i] : "slivers";
    return i < SPECS ? made(spec[i]) : slivers(300, scale[i - SPECS]);
}

static struct part *parts_of(const struct scene *scene, float share, uint32_t threads,
                             uint32_t *count)
{
    const struct build_options options = {.leaf = 4, .presplit = share};
    struct part *part;
    assert_int_equal(presplit_make(scene, &options, threads, &part, count, NULL), STATUS_OK);
    return part;
}

/* --- parts ------------------------------------------------------------------------------------ */

/* As leaves of one node, by the exact check. */
static uint32_t uncovered(const struct scene *scene, const struct part *part, uint32_t count)
{
    struct cover_node *node = calloc(count + 1, sizeof *node);
    uint32_t *item = calloc(count, sizeof *item);
    struct cover_faults faults;
    assert_true(node && item);
    node[0].box = (struct box){{-FLT_MAX, -FLT_MAX, -FLT_MAX}, {FLT_MAX, FLT_MAX, FLT_MAX}};
    for (uint32_t i = 0; i < count; i++) {
        node[i + 1] = (struct cover_node){.box = part[i].box, .item_first = i, .item_count = 1};
        item[i] = part[i].prim;
    }
    const struct cover_tree tree = {node, item, count + 1};
    assert_int_equal(cover_check(&tree, scene, &faults), STATUS_OK);
    free(node);
    free(item);
    return faults.prims;
}

/* Returns the number of triangles that are cut. */
static uint32_t check_parts(const struct scene *scene, const struct part *part, uint32_t count,
                            const char *what)
{
    uint32_t cut = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct box whole = scene_tri_bounds(scene, part[i].prim);
        uint32_t before = i ? part[i - 1].prim : UINT32_MAX;
        bool again = i && part[i].prim == before;
        cut += again && (i < 2 || part[i - 2].prim != before);
        if (!again && part[i].prim != before + 1)
            fail_msg("%s: part %u is of triangle %u", what, i, part[i].prim);
        if (!box_contains_box(&whole, &part[i].box))
            fail_msg("%s: part %u is larger than triangle %u", what, i, part[i].prim);
    }
    assert_int_equal(part[count - 1].prim, scene->tri_count - 1);
    return cut;
}

static void parts_cover_their_triangles_within_the_budget(void **state)
{
    (void)state;
    for (size_t s = 0; s < SCENES; s++)
        for (size_t k = 0; k < ARRAY_COUNT(shares); k++) {
            const char *what;
            struct scene scene = scene_of(s, &what);
            uint32_t count, most = scene.tri_count + (uint32_t)((double)shares[k] * scene.tri_count);
            struct part *part = parts_of(&scene, shares[k], 1, &count);
            assert_in_range(count, scene.tri_count, most);
            (void)check_parts(&scene, part, count, what);
            if (uncovered(&scene, part, count))
                fail_msg("%s, %g: %u triangles have parts in no box", what, (double)shares[k],
                         uncovered(&scene, part, count));
            room_free(part);
            scene_free(&scene);
        }
}

/* Two parts of a triangle have a plane between them. */
static void parts_lie_beside_each_other(void **state)
{
    (void)state;
    struct scene scene = slivers(400, 1);
    uint32_t count, pairs = 0;
    struct part *part = parts_of(&scene, 3, 1, &count);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count && part[j].prim == part[i].prim; j++) {
            const struct box *a = &part[i].box, *b = &part[j].box;
            bool apart = false;
            for (int k = 0; k < 3; k++)
                apart = apart || a->hi[k] <= b->lo[k] || b->hi[k] <= a->lo[k];
            assert_true(apart);
            pairs++;
        }
    assert_true(pairs > 1000);
    room_free(part);
    scene_free(&scene);
}

/* Nearly all of it: what is left is less than equal triangles would take together, and planes that
 * miss the triangle. */
static void the_budget_is_used(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=4000");
    for (size_t k = 0; k < ARRAY_COUNT(shares); k++) {
        uint32_t count;
        struct part *part = parts_of(&scene, shares[k], 1, &count);
        double budget = (double)shares[k] * scene.tri_count;
        assert_true((double)(count - scene.tri_count) > 0.97 * budget);
        room_free(part);
    }
    scene_free(&scene);
}

static void parts_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=3000");
    uint32_t count, other;
    struct part *one = parts_of(&scene, 0.7f, 1, &count);
    for (uint32_t threads = 2; threads <= 8; threads += 3) {
        struct part *more = parts_of(&scene, 0.7f, threads, &other);
        assert_int_equal(count, other);
        for (uint32_t i = 0; i < count; i++) {
            assert_memory_equal(&one[i].box, &more[i].box, sizeof one[i].box);
            assert_int_equal(one[i].prim, more[i].prim);
        }
        room_free(more);
    }
    room_free(one);
    scene_free(&scene);
}

/* --- planes and priorities -------------------------------------------------------------------- */

/* Thin triangles between the corners of boxes, in the scene [0, 8]^3 that the last two, points at
 * its corners, make of them. */
static struct scene thin(uint32_t count, const float box[][2][3])
{
    struct scene scene = trees_grid(count + 2);
    for (uint32_t i = 0; i < count + 2; i++)
        for (int k = 0; k < 3; k++) {
            float *v = scene.vertex + 9 * (size_t)i + k;
            v[0] = i < count ? box[i][0][k] : i == count ? 0 : 8;
            v[3] = v[6] = i < count ? box[i][1][k] : v[0];
            v[6] -= i < count && k == 0 ? 0x1p-10f : 0;
        }
    return scene;
}

/* The triangle that the budget for one cut is spent on. */
static uint32_t first_cut(const struct scene *scene, struct part piece[2])
{
    uint32_t count, cut = UINT32_MAX;
    struct part *part = parts_of(scene, 1.01f / (float)scene->tri_count, 1, &count);
    assert_in_range(count, scene->tri_count, scene->tri_count + 1);
    for (uint32_t i = 1; i < count; i++)
        if (part[i].prim == part[i - 1].prim) {
            cut = part[i].prim;
            piece[0] = part[i - 1];
            piece[1] = part[i];
        }
    room_free(part);
    return cut;
}

static void what_the_coarsest_plane_cuts_comes_first(void **state)
{
    (void)state;
    static const float box[][2][3] = {
        {{0, 0, 0}, {2, 2, 2}}, {{3, 3, 3}, {5, 5, 5}}, {{5, 5, 5}, {7, 7, 7}}};
    struct scene scene = thin(3, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 1);
    assert_true(piece[0].box.hi[0] == 4 && piece[1].box.lo[0] == 4);
    scene_free(&scene);
}

static void a_plane_at_the_end_of_a_box_does_not_cut_it(void **state)
{
    (void)state;
    static const float box[][2][3] = {{{0, 0, 0}, {4, 4, 4}}, {{1, 1, 1}, {1, 3, 3}}};
    struct scene scene = thin(2, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[0] == 2 && piece[1].box.lo[0] == 2);
    scene_free(&scene);
}

static void the_most_room_is_cut_first(void **state)
{
    (void)state;
    static const float box[][2][3] = {
        {{3, 1, 1}, {5, 1, 1}}, {{3, 2, 2}, {5, 2.5f, 2.5f}}, {{3, 1, 2}, {5, 3, 4}}};
    struct scene scene = thin(3, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 2);
    scene_free(&scene);
}

static void the_coarsest_of_three_planes_cuts(void **state)
{
    (void)state;
    static const float two[][2][3] = {{{2.5f, 3.5f, 5}, {3.75f, 4.5f, 5.5f}}};
    static const float equal[][2][3] = {{{3.5f, 1, 3}, {4.5f, 7, 5}}};
    struct scene scene = thin(1, two);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[1] == 4 && piece[1].box.lo[1] == 4); /* not 3, nor 5.25 */
    scene_free(&scene);
    scene = thin(1, equal);
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[1] == 4 && piece[1].box.lo[1] == 4);
    assert_true(piece[0].box.hi[0] < 4.1f && piece[1].box.lo[0] > 3.9f);
    scene_free(&scene);
}

/* Cuts are shared out by the cube root of what is spare: 8 times as large a triangle, in each axis
 * 2 sqrt(2) times, has twice as many. */
static void cuts_grow_as_the_cube_root(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    static const float size[3] = {8, 8 / 2.828427f, 0};
    for (uint32_t i = 0; i < 27; i++)
        scene.vertex[i] = (i % 9 < 3 ? 0 : size[i / 9]) - (i % 9 == 6 ? 0x1p-10f * size[i / 9] : 0);
    uint32_t count, of[3] = {0};
    struct part *part = parts_of(&scene, 40, 1, &count);
    for (uint32_t i = 0; i < count; i++)
        of[part[i].prim]++;
    assert_int_equal(of[2], 1);
    /* The smaller one's coarsest plane is one level finer: that is another cube root of 2. */
    double ratio = (double)of[0] / of[1];
    if (!(ratio > 0.95 * 2 * cbrt(2) && ratio < 1.05 * 2 * cbrt(2)))
        fail_msg("%u and %u parts", of[0], of[1]);
    room_free(part);
    scene_free(&scene);
}

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

static void trees_are_sound_whoever_builds(void **state)
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
    for (size_t s = 0; s < SCENES; s++)
        for (size_t b = 0; builders_all[b]; b++) {
            const char *what;
            struct scene scene = scene_of(s, &what);
            const struct build_options none = {.leaf = 3, .eps = 1}, least = {.leaf = 3,
                                                                             .eps = 1,
                                                                             .presplit = 1e-9f};
            struct bvh bvh = {0}, other = {0};
            if (!builders_all[b]->faithful) {
                bvh = build(builders_all[b], &scene, &none);
                other = build(builders_all[b], &scene, &least);
            }
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
        cmocka_unit_test(parts_cover_their_triangles_within_the_budget),
        cmocka_unit_test(parts_lie_beside_each_other),
        cmocka_unit_test(the_budget_is_used),
        cmocka_unit_test(parts_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(what_the_coarsest_plane_cuts_comes_first),
        cmocka_unit_test(a_plane_at_the_end_of_a_box_does_not_cut_it),
        cmocka_unit_test(the_most_room_is_cut_first),
        cmocka_unit_test(the_coarsest_of_three_planes_cuts),
        cmocka_unit_test(cuts_grow_as_the_cube_root),
        cmocka_unit_test(trees_are_sound_whoever_builds),
        cmocka_unit_test(whole_triangles_make_the_tree_of_triangles),
        cmocka_unit_test(trees_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(some_builders_take_no_parts),
        cmocka_unit_test(more_items_than_a_tree_holds_are_refused),
        cmocka_unit_test(a_tree_of_parts_is_not_refitted),
        cmocka_unit_test(answers_are_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
