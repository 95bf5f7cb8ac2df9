/* Triangle storage: what it holds is the scene's, to the bit, and every answer is `indexed`'s. */
#include "ref/packed/packed_walk.h"
#include "ref/scene/quantise.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/packed/packed_check.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/tree_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RAYS 400u

/* Nothing shared; closed; the same triangle many times; many without area. */
static const char *const specs[] = {"soup:n=200", "sphere", "soup:n=60", "soup:n=61"};

/* On a grid, which one storage needs. */
#define ON_GRID 1u

static struct scene scene_of(size_t which)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(specs[which], 3, &scene, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < scene.tri_count && which == 2; i++)
        memcpy(scene.index + 3 * i, scene.index + 3 * (i % 7), 3 * sizeof *scene.index);
    for (uint32_t i = 0; i < scene.tri_count && which == 3; i += 2)
        scene.index[3 * i + 2] = scene.index[3 * i + i % 3 % 2];
    return scene;
}

static struct bvh tree_of(const struct scene *scene, uint32_t leaf)
{
    struct bvh bvh;
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    assert_int_equal(builder_find("median")->build(scene, &options, &bvh, NULL), STATUS_OK);
    return bvh;
}

static struct scene on_grid(struct scene scene)
{
    struct scene out;
    struct quantised moved;
    assert_int_equal(scene_quantise_even(&scene, QUANTISE_BITS_DEFAULT, &out, &moved, NULL),
                     STATUS_OK);
    scene_free(&scene);
    return out;
}

/* Layouts that have their items written by the storage, with boxes that hold what they must. */
static size_t stored_layouts(const struct layout **out)
{
    size_t count = 0;
    for (size_t i = 0; layouts_all[i] && count < 8; i++)
        if (!layouts_all[i]->item && !layouts_all[i]->faithful)
            out[count++] = layouts_all[i];
    assert_true(count > 0);
    return count;
}

/* All leaves: the vertices are the scene's. */
static void assert_vertices(const struct packed *packed, const struct scene *scene)
{
    uint32_t seen = 0;
    struct packed_walk walk;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        for (uint32_t s = 0; s < node.item_count && node.child_count == 0; s++, seen++) {
            float stored[3][3], own[3][3];
            uint32_t prim = packed_item(packed, &node, s);
            assert_in_range(prim, 0, scene->tri_count - 1);
            if (!packed->store->tri)
                continue;
            assert_true(packed->store->tri(packed, node.item_first, s, stored));
            scene_tri(scene, prim, own);
            assert_memory_equal(stored, own, sizeof own);
        }
    }
    packed_walk_free(&walk);
    assert_int_equal(seen, scene->tri_count);
}

/* Every query of every triangle test that the storage answers, against `indexed`. */
static size_t assert_same_answers(const struct packed *packed, const struct packed *base,
                                  const struct scene *scene, const struct ray *ray)
{
    size_t compared = 0;
    for (size_t t = 0; tri_tests[t]; t++) {
        if (!tri_store_answers(packed->store, tri_tests[t]->id))
            continue;
        for (size_t i = 0; i < RAYS; i++, compared++) {
            struct hit got, want;
            enum query query = i % 3 ? QUERY_CLOSEST : QUERY_ANY;
            assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                     .packed = base,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[t],
                                                     .query = query},
                                       &ray[i], &want, NULL),
                             STATUS_OK);
            assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                     .packed = packed,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[t],
                                                     .query = query},
                                       &ray[i], &got, NULL),
                             STATUS_OK);
            assert_memory_equal(&got, &want, sizeof got);
        }
    }
    return compared;
}

static void every_storage_answers_as_indexed(void **state)
{
    (void)state;
    const struct layout *layout[8];
    size_t count = stored_layouts(layout);
    for (size_t w = 0; w < sizeof specs / sizeof *specs; w++) {
        struct scene scene = w == ON_GRID ? on_grid(scene_of(w)) : scene_of(w);
        struct bvh bvh = tree_of(&scene, 4);
        struct ray ray[RAYS];
        assert_int_equal(ray_set_make(ray_sets[0], &scene, 3, RAYS, ray, NULL), STATUS_OK);
        for (size_t l = 0; l < count; l++) {
            struct packed base;
            struct reason reason = {""};
            if (packed_make(layout[l], &bvh, &scene, &base, &reason))
                fail_msg("%s", reason.text);
            for (size_t s = 0; tri_stores[s]; s++) {
                struct packed packed;
                if (tri_stores[s]->head && w != ON_GRID)
                    continue;
                if (packed_make_stored(layout[l], tri_stores[s], &bvh, &scene, &packed, &reason) ||
                    packed_check(&packed, &scene, NULL, &reason))
                    fail_msg("%s", reason.text);
                assert_ptr_equal(packed.store, tri_stores[s]);
                assert_vertices(&packed, &scene);
                assert_true(assert_same_answers(&packed, &base, &scene, ray) >= RAYS);
                packed_free(&packed);
            }
            packed_free(&base);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* A bit of a coordinate that is not the scene's is found, whichever coordinate it is. */
static void stored_vertices_are_checked_to_the_bit(void **state)
{
    (void)state;
    struct scene scene = scene_of(0);
    struct bvh bvh = tree_of(&scene, 4);
    for (uint32_t i = 0; i < 9; i++) {
        struct packed packed;
        struct packed_faults faults;
        struct reason reason = {""};
        assert_int_equal(
            packed_make_stored(layouts[0], tri_store_find("gathered"), &bvh, &scene, &packed, NULL),
            STATUS_OK);
        assert_int_equal(packed_check(&packed, &scene, &faults, &reason), STATUS_OK);
        packed.item[10 * (scene.tri_count - 1) + i] ^= 1;
        assert_int_equal(packed_check(&packed, &scene, &faults, &reason), STATUS_INPUT);
        assert_int_equal(faults.bad_tris, 1);
        assert_non_null(strstr(reason.text, "with other vertices"));
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Shared vertices are stored once. */
static void a_closed_mesh_is_smaller_compact(void **state)
{
    (void)state;
    struct scene scene = scene_of(1);
    struct bvh bvh = tree_of(&scene, 8);
    struct packed gathered, compact;
    assert_int_equal(
        packed_make_stored(layouts[0], tri_store_find("gathered"), &bvh, &scene, &gathered, NULL),
        STATUS_OK);
    assert_int_equal(
        packed_make_stored(layouts[0], tri_store_find("compact"), &bvh, &scene, &compact, NULL),
        STATUS_OK);
    assert_int_equal(gathered.item_count, 10 * scene.tri_count);
    assert_true(4 * compact.item_count < 3 * gathered.item_count);
    packed_free(&gathered);
    packed_free(&compact);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* A storage whose vertices are not the scene's is found by packed_check. */
static void damaged_vertices_are_found(void **state)
{
    (void)state;
    struct scene scene = scene_of(0);
    struct bvh bvh = tree_of(&scene, 4);
    static const char *const names[] = {"gathered", "compact"};
    for (size_t i = 0; i < 2; i++) {
        struct packed packed;
        struct packed_faults faults;
        struct reason reason = {""};
        assert_int_equal(
            packed_make_stored(layouts[0], tri_store_find(names[i]), &bvh, &scene, &packed, NULL),
            STATUS_OK);
        packed.item[5] ^= 1; /* a vertex of the first leaf in both */
        assert_int_equal(packed_check(&packed, &scene, &faults, &reason), STATUS_INPUT);
        assert_true(faults.bad_tris >= 1);
        assert_non_null(strstr(reason.text, names[i]));
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

static void expect_limit(const char *layout, const char *store, const struct bvh *bvh,
                         const struct scene *scene, const char *text)
{
    struct packed packed;
    struct reason reason = {""};
    assert_int_equal(packed_make_stored(layout_find(layout), tri_store_find(store), bvh, scene,
                                        &packed, &reason),
                     STATUS_LIMIT);
    if (!strstr(reason.text, text))
        fail_msg("'%s' has no '%s'", reason.text, text);
    assert_null(packed.item);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    struct scene scene = scene_of(0);
    struct bvh small = tree_of(&scene, 5), eight = tree_of(&scene, 8), large = tree_of(&scene, 200);
    struct packed packed;
    struct reason reason = {""};
    assert_int_equal(
        packed_make_stored(layouts[0], tri_store_find("compact"), &small, &scene, &packed, NULL),
        STATUS_OK); /* 15 vertices */
    packed_free(&packed);
    expect_limit("f32", "compact", &eight, &scene, "at most 16 vertices");
    expect_limit("f32", "compact", &large, &scene, "at most 8 triangles");
    expect_limit("rf16", "gathered", &small, &scene, "its own way");
    for (size_t i = 0; tri_stores[i]; i++)
        assert_ptr_equal(tri_store_find(tri_stores[i]->name), tri_stores[i]);
    assert_null(tri_store_find("none"));
    assert_int_equal(tri_store_check(tri_store_find("edges"), ABI_TRI_WOOP, "woop", &reason),
                     STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "storage edges holds no vertices: test woop needs them");
    bvh_free(&small);
    bvh_free(&eight);
    bvh_free(&large);
    scene_free(&scene);
}

/* Two leaves of triangles that share no vertex, the second too large: its first triangle is named,
 * and how many are beside it. */
static void refusals_count_what_a_leaf_has(void **state)
{
    (void)state;
    for (uint32_t beside = 4; beside <= 18; beside++) {
        const bool quantised = beside % 2;
        const uint32_t others = beside / 2 + 2; /* 4 to 11 beside the first */
        struct scene scene = trees_grid(6 + others);
        struct bvh bvh = trees_make(&scene, 6 + others, TREES_BALANCED);
        struct bvh_node node[3] = {bvh.node[0], bvh.node[0], bvh.node[0]}, *one = bvh.node;
        struct packed packed;
        struct reason reason = {""};
        char text[300] = "";
        node[0].fst = 1;
        node[0].snd = 2;
        node[0].item_count = 0;
        node[1].item_count = node[2].item_first = 5;
        node[2].item_count = 1 + others;
        bvh.node = node;
        bvh.node_count = 3;
        enum status status = packed_make_stored(layout_find("f32"),
                                                tri_store_find(quantised ? "quantised" : "compact"),
                                                &bvh, &scene, &packed, &reason);
        if (others > 4 && quantised)
            (void)snprintf(text, sizeof text,
                           "storage quantised: a leaf holds at most 8 triangles and 16 vertices, "
                           "that of triangle 5 and the %u beside it has more; use --leaf 5 or less",
                           others);
        else if (others > 7)
            (void)snprintf(text, sizeof text,
                           "storage compact: a leaf holds at most 8 triangles, this tree has one "
                           "of %u; use --leaf 8 or less",
                           1 + others);
        else if (others > 4)
            (void)snprintf(text, sizeof text,
                           "storage compact: a leaf's triangles have at most 16 vertices, those of "
                           "triangle 5 and the %u beside it have more; use --leaf 5 or less",
                           others);
        assert_string_equal(reason.text, text);
        assert_int_equal(status, others > 4 ? STATUS_LIMIT : STATUS_OK);
        packed_free(&packed);
        bvh.node = one;
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Rows keep a triangle's number in 30 bits. Only its count is read of this scene. */
static void rows_hold_numbers_of_thirty_bits(void **state)
{
    (void)state;
    static const char *const names[] = {"gathered", "edges", "baldwin_webber"};
    for (size_t n = 0; n < ARRAY_COUNT(names); n++)
        for (uint32_t more = 0; more < 3; more++) {
            const struct scene scene = {.tri_count = (1u << 30) - 1 + more};
            const struct packed packed = {.store = tri_store_find(names[n])};
            const uint32_t prim = 0;
            struct reason reason = {""};
            uint64_t words;
            char text[200] = "";
            enum status status = packed.store->measure(&packed, &scene, &prim, 1, &words, &reason);
            if (more > 0)
                (void)snprintf(text, sizeof text,
                               "storage %s: at most 1073741823 triangles, the scene has %u",
                               names[n], scene.tri_count);
            assert_int_equal(status, more > 0 ? STATUS_LIMIT : STATUS_OK);
            assert_string_equal(reason.text, text);
            assert_int_equal(words, 10);
        }
}

/* Random words in arrays of exactly their size: a sanitizer or malloc sees what is read beside. */
static void hostile_words_are_not_left(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 1);
    for (size_t s = 0; tri_stores[s]; s++)
        for (int round = 0; round < 4000; round++) {
            uint32_t count = rng_below(&rng, 80);
            uint32_t *word = malloc(4 * (size_t)count + 1);
            struct packed packed = {
                .layout = layouts[0], .store = tri_stores[s], .item = word, .item_count = count};
            struct ray ray = {.dir = {0, 0, 1}, .tmax = 1};
            struct tri_ray r = tri_ray_make(&ray);
            struct hit hit;
            float v[3][3];
            for (uint32_t i = 0; i < count; i++)
                word[i] = rng_below(&rng, 1u << 31) * 2;
            uint32_t first =
                round % 2 ? rng_below(&rng, count + 2) : UINT32_MAX - rng_below(&rng, 40);
            uint32_t slot = round % 3 ? rng_below(&rng, 12) : UINT32_MAX - rng_below(&rng, 3);
            uint32_t prim = tri_stores[s]->item(&packed, first, slot);
            if (first >= count && (uint32_t)(first + slot) >= count)
                assert_int_equal(prim, ABI_NO_PRIM);
            if (tri_stores[s]->tri && !tri_stores[s]->tri(&packed, first, slot, v))
                assert_int_equal(prim, ABI_NO_PRIM);
            if (tri_stores[s]->test)
                (void)tri_stores[s]->test(&packed, first, slot, ABI_TRI_MT, &r, &hit);
            free(word);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stored_vertices_are_checked_to_the_bit),
        cmocka_unit_test(every_storage_answers_as_indexed),
        cmocka_unit_test(a_closed_mesh_is_smaller_compact),
        cmocka_unit_test(damaged_vertices_are_found),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(refusals_count_what_a_leaf_has),
        cmocka_unit_test(rows_hold_numbers_of_thirty_bits),
        cmocka_unit_test(hostile_words_are_not_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
