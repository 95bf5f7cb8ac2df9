/* Laws of small trees (ref/fast/small_tree.h): what nodes hold, and hits in scenes that use all of
 * the ranges of blocks. */
#include "tests/fast/small_fixture.h"

/* --- trees ------------------------------------------------------------------------------------ */

static void trees_hold_all_triangles(void **state)
{
    (void)state;
    check_trees(0);
}

/* Triangles at the upper end of the frame, of which the last codes are used: where the bounds of a
 * node are as far apart as codes go, and where a unit more would be beyond the last of them. */
static void bounds_at_the_ends_of_the_frame(void **state)
{
    (void)state;
    static const float top = 65535.0f - 0x1p-8f; /* so that a code is 1 */
    struct rng rng = rng_make(3, 1);
    for (int round = 0; round < 400; round++) {
        const bool whole = round % 2; /* as many codes as a unit reaches, exactly */
        const float span =
            whole ? ldexpf(255, (int)rng_below(&rng, 8))
                  : rng_range(&rng, 0.5f, 1) * ldexpf(65536, -(int)rng_below(&rng, 12));
        const uint32_t count = 2 + rng_below(&rng, whole ? 300 : 60);
        struct scene scene;
        assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t c = 0; c < 3; c++)
                for (uint32_t k = 0; k < 3; k++) {
                    const float from = whole ? 65000.0f : top;
                    const float end = rng_below(&rng, 2) ? from : from - span;
                    const float at = !whole ? fmaxf(end - rng_range(&rng, 0, 4), 0)
                                     : rng_below(&rng, 4)
                                         ? from - (float)rng_below(&rng, (uint32_t)span)
                                         : end;
                    scene.vertex[9 * i + 3 * c + k] = i == 0 ? 0 : i == 1 ? top : at;
                    scene.index[3 * i + c] = 3 * i + c;
                }
        struct fast_tree tree = make_tree(&scene, 1);
        assert_true(tree.step[0] == 1);
        fast_free(&tree);
        check_tree(&scene);
        scene_free(&scene);
    }
}

static void closed_meshes_take_little(void **state)
{
    (void)state;
    struct scene scene = make_scene("sphere", 120);
    struct build_options options = {.leaf = 1};
    struct fast_tree tree, plain;
    struct bvh bvh;
    assert_true(scene.tri_count > 20000);
    assert_int_equal(bvh_build(builder_find("sah_sweep"), &scene, &options, &bvh, NULL), STATUS_OK);
    assert_int_equal(fast_make_small(&bvh, &scene, &tree, NULL), STATUS_OK);
    assert_int_equal(fast_make(&bvh, &scene, &plain, NULL), STATUS_OK);
    assert_true(fast_bytes(&tree) <= 14 * (uint64_t)scene.tri_count);
    assert_true(10 * fast_bytes(&tree) < 6 * fast_bytes(&plain));
    fast_free(&plain);
    fast_free(&tree);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* --- hits ------------------------------------------------------------------------------------- */

/* Blocks of coordinates of both signs, of all sizes in one row, of huge and tiny ones, of zeros of
 * both signs: 16 vertices, so that leaves are full. */
static void any_coordinates_are_hit(void **state)
{
    (void)state;
    static const float size[KINDS + 1] = {1, 1e30f, 0x1p-140f, 1, 0x1p20f, 1e12f, 4096, 2, 1e30f};
    struct rng rng = rng_make(4, 1);
    for (uint32_t kind = 0; kind <= KINDS; kind++) {
        size_t hits = 0;
        for (int round = 0; round < 6; round++) {
            struct scene scene = any_scene(&rng, kind, round % 2 ? 16 : 90, 120);
            hits += check_hits(&rng, &scene, size[kind]);
            scene_free(&scene);
        }
        if (kind == 0 || kind >= 5) /* products of the others overflow or underflow, or are 0 */
            assert_true(hits > HIT_RAYS || kind == KINDS);
    }
}

/* As many triangles as fit in a leaf, and each of them is the only one that some rays meet: side by
 * side in a row over the vertices of a strip, or 24 of which no two share a vertex. */
static void every_place_in_a_leaf_is_tested(void **state)
{
    (void)state;
    struct rng rng = rng_make(6, 1);
    for (uint32_t count = 1; count <= SMALL_TRIS; count++)
        for (int apart = 0; apart < 2; apart++) {
            const uint32_t vertices = apart ? 3 * count : 10;
            struct scene scene;
            assert_int_equal(scene_make(vertices, count, &scene), STATUS_OK);
            for (uint32_t i = 0; i < 3 * vertices; i++)
                scene.vertex[i] = rng_range(&rng, -1, 1);
            for (uint32_t i = 0; i < count; i++) /* of ten vertices, three that are different */
                for (uint32_t c = 0; c < 3; c++)
                    scene.index[3 * i + c] = apart ? 3 * i + c : (i + c * (1 + i / 10)) % 10;
            struct fast_tree tree = make_tree(&scene, 1);
            if (!apart) {
                assert_int_equal(tree.node_count, 1);
                assert_int_equal(small_children(tree.small), 1);
                assert_int_equal(small_tris(tree.block[0]), count);
            } else {
                assert_true(small_vertices(tree.block[0]) <= SMALL_VERTICES);
            }
            fast_free(&tree);
            assert_true(check_hits(&rng, &scene, 1) > HIT_RAYS / 2);
            scene_free(&scene);
        }
}

/* Many triangles at one place, whose numbers are far apart: a leaf keeps their numbers. */
static void equal_triangles_have_their_own_numbers(void **state)
{
    (void)state;
    const uint32_t count = 70000;
    struct scene scene;
    struct ray ray = {.org = {0.1f, 0.1f, 1}, .dir = {0, 0, -1}, .tmax = INFINITY};
    assert_int_equal(scene_make(6, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 18; i++)
        scene.vertex[i] = (float)(i / 9 * 40) + (float)(i % 9 == 3 || i % 9 == 7);
    for (uint32_t i = 0; i < 3 * count; i++) /* all but 24 are far away */
        scene.index[i] = i % 3 + (i / 3 % 3043 == 0 ? 0 : 3);
    struct fast_tree tree = make_tree(&scene, 1);
    struct hit hit[64];
    uint32_t found = fast_all(&tree, &ray, ARRAY_COUNT(hit), hit), seen = 0;
    assert_int_equal(found, (count + 3042) / 3043);
    for (uint32_t i = 0; i < found; i++) {
        assert_int_equal(hit[i].prim % 3043, 0);
        seen |= 1u << hit[i].prim / 3043;
    }
    assert_int_equal(seen, (1u << found) - 1);
    for (size_t k = 0; kernels()[k]; k++) {
        if (!kernels()[k]->runs())
            continue;
        kernels()[k]->closest(&tree, &ray, 1, hit);
        assert_int_equal(hit[0].prim % 3043, 0);
        assert_true(hit[0].t == 1);
    }
    fast_free(&tree);
    scene_free(&scene);
}

static void empty_and_too_deep_trees(void **state)
{
    (void)state;
    empty_and_too_deep(fast_make_small, 3000);
}

int main(void)
{
    tested = &fast_forms[1];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_hold_all_triangles),
        cmocka_unit_test(bounds_at_the_ends_of_the_frame),
        cmocka_unit_test(closed_meshes_take_little),
        cmocka_unit_test(any_coordinates_are_hit),
        cmocka_unit_test(every_place_in_a_leaf_is_tested),
        cmocka_unit_test(equal_triangles_have_their_own_numbers),
        cmocka_unit_test(empty_and_too_deep_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
