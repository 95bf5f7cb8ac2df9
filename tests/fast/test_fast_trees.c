/* Laws of the trees of ref/fast/: blocks, bounds, what is decoded and what is refused. */
#include "tests/fast/fast_fixture.h"

static void blocks_hold_their_triangles(void **state)
{
    (void)state;
    struct scene scene = make_scene("grid", 8);
    uint32_t most = 0;
    for (uint32_t first = 0; first + BLOCK_TRIS <= scene.tri_count; first += 5) {
        struct block block;
        uint32_t prim[BLOCK_TRIS + 1], word[128];
        for (uint32_t i = 0; i <= BLOCK_TRIS; i++)
            prim[i] = (first + i * (first % 3 ? 1 : 2)) % scene.tri_count;
        assert_false(block_make(&scene, prim, BLOCK_TRIS + 1, &block));
        uint32_t count = BLOCK_TRIS;
        while (!block_make(&scene, prim, count, &block))
            count--;
        assert_true(count >= BLOCK_VERTICES / 3);
        assert_true(block_words(&block) <= ARRAY_COUNT(word));
        block_write(&block, word);
        for (uint32_t i = 0; i < count; i++) {
            float v[3][3], w[3];
            scene_tri(&scene, prim[i], v);
            assert_int_equal(block_prim(word, block.vertex_count, i), prim[i]);
            for (int c = 0; c < 3; c++) {
                block_corner(word, block.vertex_count, i, c, w);
                assert_memory_equal(v[c], w, sizeof w);
            }
        }
        most = block.vertex_count > most ? block.vertex_count : most;
    }
    assert_true(most > 8);
    scene_free(&scene);
}

static void bounds_are_conservative(void **state)
{
    (void)state;
    struct scene scene = make_scene("soup", 500);
    struct fast_tree tree = make_tree(&scene, 1);
    uint32_t leaves = 0;
    for (uint32_t n = 0; n < tree.node_count; n++)
        for (uint32_t i = 0; i < FAST_WIDTH; i++) {
            uint32_t ref = tree.node[n].ref[i];
            if (!(ref & FAST_LEAF))
                continue;
            const uint32_t *word = tree.block + (ref & (FAST_LEAF_WORDS - 1));
            uint32_t vertices = (ref >> FAST_LEAF_COUNT & 15u) + 1;
            leaves++;
            for (uint32_t v = 0; v < vertices; v++)
                for (uint32_t k = 0; k < 3; k++) {
                    double x = (double)float_from_bits(word[BLOCK_CORNERS + k * vertices + v]);
                    double lo = (double)tree.lo[k], step = (double)tree.step[k];
                    assert_true(lo + step * tree.node[n].bound[0][k][i] <= x);
                    assert_true(lo + step * tree.node[n].bound[1][k][i] >= x);
                }
        }
    assert_true(leaves > 60);
    fast_free(&tree);
    scene_free(&scene);
}

/* A soup and one triangle, of every layout that loses nothing: a sound tree with each triangle
 * once, and the hits of all triangles. */
static void every_layout_is_decoded(void **state)
{
    (void)state;
    size_t played = 0;
    for (uint32_t n = 1; n <= 120; n += 119) {
        struct scene scene = make_scene("soup", n);
        struct build_options options = {.leaf = 3};
        struct ray ray[200];
        struct bvh bvh;
        make_rays("mixed", &scene, 5, ARRAY_COUNT(ray), ray);
        assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed;
            struct fast_tree tree;
            struct bvh decoded;
            struct reason reason = {""};
            if (layouts_all[l]->faithful ||
                packed_make(layouts_all[l], &bvh, &scene, &packed, &reason))
                continue;
            if (fast_decode(&packed, &scene, &decoded, &reason) ||
                bvh_check(&decoded, &scene, &reason) || fast_make(&decoded, &scene, &tree, &reason))
                fail_msg("%s: %s", layouts_all[l]->name, reason.text);
            check_rays(&tree, &scene, ray, ARRAY_COUNT(ray));
            fast_free(&tree);
            bvh_free(&decoded);
            packed_free(&packed);
            played++;
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
    assert_true(played >= 4);
}

/* A scene that has only the first of the packed triangles: leaves and whole subtrees without any
 * fall away, wherever they are. What is left is a sound tree of that scene, with its hits. */
static void empty_parts_fall_away(void **state)
{
    (void)state;
    struct scene scene = make_scene("soup", 120);
    struct build_options options = {.leaf = 1};
    struct ray ray[60];
    struct bvh bvh;
    uint32_t fewer = 0;
    make_rays("mixed", &scene, 5, ARRAY_COUNT(ray), ray);
    assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct reason reason = {""};
        if (layouts_all[l]->faithful || packed_make(layouts_all[l], &bvh, &scene, &packed, &reason))
            continue;
        for (uint32_t count = 1; count <= scene.tri_count; count += 7) {
            struct scene some = scene;
            struct fast_tree tree;
            struct bvh decoded;
            some.tri_count = count;
            if (fast_decode(&packed, &some, &decoded, &reason) ||
                bvh_check(&decoded, &some, &reason) || fast_make(&decoded, &some, &tree, &reason))
                fail_msg("%s, %u triangles: %s", layouts_all[l]->name, count, reason.text);
            assert_true(decoded.node_count <= 2 * count - 1);
            fewer += decoded.node_count < bvh.node_count;
            check_rays(&tree, &some, ray, ARRAY_COUNT(ray));
            fast_free(&tree);
            bvh_free(&decoded);
        }
        packed_free(&packed);
    }
    assert_true(fewer > 50);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void empty_and_too_deep_trees(void **state)
{
    (void)state;
    empty_and_too_deep(fast_make, 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_hold_their_triangles), cmocka_unit_test(bounds_are_conservative),
        cmocka_unit_test(every_layout_is_decoded),     cmocka_unit_test(empty_parts_fall_away),
        cmocka_unit_test(empty_and_too_deep_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
