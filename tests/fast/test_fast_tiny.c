/* Laws of tiny trees (ref/fast/tiny_block.h): what blocks and nodes hold, how large they are, and
 * which scenes have none. What is hit is held by test_fast, too. */
#include "tests/fast/small_fixture.h"

#include "ref/store.h"
#include "ref/store/bits.h"

/* --- blocks ----------------------------------------------------------------------------------- */

/* A scene of `all` triangles over `vertices` points of a grid of so many bits, no two the same.
 * Two corners of the grid are among them, so that it is the scene's own. */
static struct scene grid_scene(struct rng *rng, uint32_t bits, uint32_t vertices, uint32_t all)
{
    struct scene scene;
    const uint32_t most = (1u << bits) - 1, low = rng_below(rng, 1000);
    assert_int_equal(scene_make(vertices, all, &scene), STATUS_OK);
    for (uint32_t i = 0; i < vertices; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t code = i == 0 ? 0 : i == 1 ? most : rng_below(rng, most + 1);
            if (k == 0 && i > 1)
                code = i; /* so that they differ */
            scene.vertex[3 * i + k] = ldexpf((float)((int32_t)code - (int32_t)low), 3 - (int)k);
        }
    for (uint32_t i = 0; i < 3 * all; i++)
        scene.index[i] = rng_below(rng, vertices);
    return scene;
}

/* `count` numbers below `all` in any order: in a row, evenly apart, or a few far from the rest. */
static void any_numbers(struct rng *rng, uint32_t all, uint32_t count, uint32_t *prim)
{
    const uint32_t kind = rng_below(rng, 3), step = all / count;
    const uint32_t first = rng_below(rng, all - count + 1);
    for (uint32_t i = 0; i < count; i++)
        prim[i] = kind == 0   ? first + i
                  : kind == 1 ? i * step + rng_below(rng, step)
                              : (i + 2 < count || count < 3 ? i : all - count + i);
    for (uint32_t i = count - 1; i > 0; i--) {
        const uint32_t k = rng_below(rng, i + 1), kept = prim[i];
        prim[i] = prim[k];
        prim[k] = kept;
    }
}

/* Bits of all gaps of ascending numbers with a parameter, by writing them out. */
static uint32_t gap_bits(const uint32_t *prim, uint32_t count, uint32_t parameter)
{
    uint64_t bits = 0;
    for (uint32_t i = 1; i < count; i++) {
        bits += parameter + 1;
        for (uint64_t rest = prim[i] - prim[i - 1] - 1; rest >> parameter; bits++)
            rest -= UINT64_C(1) << parameter;
    }
    return bits > UINT32_MAX ? UINT32_MAX : (uint32_t)bits;
}

/* What was written is read again, in as few bits as the gaps and the widths allow. */
static void check_block(const struct scene *scene, const uint32_t *prim, uint32_t count)
{
    static struct tiny_block block;
    uint32_t word[TINY_WORDS + 1] = {0}, least = UINT32_MAX, end = 0, rows = 0;
    struct tiny_form form;
    struct reason reason = {""};
    assert_int_equal(tiny_form_make(scene, &form, &reason), STATUS_OK);
    if (!tiny_block_make(&form, scene, prim, count, &block))
        fail_msg("%u triangles do not fit", count);
    const uint32_t words = tiny_block_words(&form, &block);
    assert_in_range(words, 1, TINY_WORDS);
    tiny_block_write(&form, &block, word);
    assert_int_equal(tiny_tris(word[0]), count);
    uint64_t named = 0;
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3], own[3][3];
        const uint32_t number = tiny_prim(&form, word, i, &end);
        assert_true(i == 0 || number > block.prim[i - 1]);
        assert_int_equal(number, block.prim[i]);
        tiny_tri(&form, word, i, v);
        scene_tri(scene, number, own);
        assert_memory_equal(v, own, sizeof v);
        for (uint32_t k = 0; k < count; k++)
            named |= (uint64_t)(prim[k] == number) << k;
    }
    assert_true(named == (UINT64_C(1) << count) - 1);
    for (uint32_t p = 0; p < 32; p++) {
        const uint32_t bits = gap_bits(block.prim, count, p);
        least = bits < least ? bits : least;
    }
    assert_int_equal(end - tiny_row(&form, word[0], 3), least);
    assert_int_equal(words, (end + 31) / 32);
    assert_int_equal(word[words], 0);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t lo = UINT32_MAX, hi = 0;
        for (uint32_t i = 0; i < 3 * count; i++) {
            const uint32_t at = scene->index[3 * prim[i / 3] + i % 3];
            const uint32_t code = grid_code(&form.grid, (int)k, scene->vertex[3 * at + k]);
            lo = code < lo ? code : lo;
            hi = code > hi ? code : hi;
        }
        assert_int_equal(tiny_width(word[0], k), bits_of(hi - lo));
        rows += tiny_vertices(word[0]) * bits_of(hi - lo);
    }
    assert_int_equal(tiny_row(&form, word[0], 3),
                     32 + 15 * count + 3 * form.grid.bits + bits_of(scene->tri_count - 1) + rows);
}

/* Of every number of triangles and vertices, on grids of every number of bits. */
static void blocks_are_read_as_they_were_written(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 1);
    for (uint32_t count = 1; count <= TINY_TRIS; count++)
        for (uint32_t bits = QUANTISE_BITS_LEAST; bits <= QUANTISE_BITS_MOST; bits++) {
            static const uint32_t most[] = {TINY_TRIS, 100, 70000};
            const uint32_t vertices = 3 + rng_below(&rng, TINY_VERTICES - 2);
            struct scene scene = grid_scene(&rng, bits, vertices, most[rng_below(&rng, 3)]);
            uint32_t prim[TINY_TRIS];
            any_numbers(&rng, scene.tri_count, count, prim);
            check_block(&scene, prim, count);
            scene_free(&scene);
        }
}

/* 48 triangles and 32 vertices fit, one more of either does not. */
static void limits_of_a_block(void **state)
{
    (void)state;
    static struct tiny_block block;
    struct rng rng = rng_make(12, 1);
    struct scene scene = grid_scene(&rng, 12, TINY_VERTICES + 1, TINY_TRIS + 1);
    struct tiny_form form;
    struct reason reason;
    uint32_t prim[TINY_TRIS + 1];
    for (uint32_t i = 0; i <= TINY_TRIS; i++) {
        prim[i] = i;
        for (uint32_t c = 0; c < 3; c++)
            scene.index[3 * i + c] = (i + c) % TINY_VERTICES;
    }
    assert_int_equal(tiny_form_make(&scene, &form, &reason), STATUS_OK);
    assert_true(tiny_block_make(&form, &scene, prim, TINY_TRIS, &block));
    assert_int_equal(block.vertex_count, TINY_VERTICES);
    assert_false(tiny_block_make(&form, &scene, prim, TINY_TRIS + 1, &block));
    for (uint32_t c = 0; c < 3 * TINY_TRIS; c++) {
        const uint32_t kept = scene.index[c];
        scene.index[c] = TINY_VERTICES; /* in the place of any one corner; each vertex has four */
        assert_false(tiny_block_make(&form, &scene, prim, TINY_TRIS, &block));
        scene.index[c] = kept;
    }
    scene_free(&scene);
}

/* --- trees ------------------------------------------------------------------------------------ */

static void trees_hold_all_triangles(void **state)
{
    (void)state;
    check_trees(8);
    check_trees(21);
}

/* 6 bytes a triangle on a grid whose steps are a thirtieth of an edge. */
static void closed_meshes_take_little(void **state)
{
    (void)state;
    struct scene scene = make_scene("sphere", 120);
    struct build_options options = {.leaf = 1};
    struct fast_tree tree;
    struct reason reason = {""};
    struct bvh bvh;
    assert_true(scene.tri_count > 20000);
    settle(&scene, 12);
    assert_int_equal(bvh_build(builder_find("sah_sweep"), &scene, &options, &bvh, NULL), STATUS_OK);
    assert_int_equal(fast_make_tiny(&bvh, &scene, &tree, &reason), STATUS_OK);
    assert_true(fast_bytes(&tree) <= 6 * (uint64_t)scene.tri_count);
    fast_free(&tree);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* A coordinate between two points of the finest grid, and a negative zero. */
static void scenes_off_a_grid_are_refused(void **state)
{
    (void)state;
    static const float off[] = {0.5f, -0.0f};
    for (size_t i = 0; i < ARRAY_COUNT(off); i++)
        for (uint32_t k = 0; k < 3; k++) {
            struct scene scene = make_scene("sphere", 5);
            struct bvh bvh;
            struct fast_tree tree;
            struct reason reason = {""};
            settle(&scene, 21);
            for (uint32_t v = 0; v < scene.vertex_count; v++)
                scene.vertex[3 * v + k] *= i == 0 ? 0x1p22f : 1;
            scene.vertex[3 + k] = off[i];
            bvh = trees_make(&scene, 1, TREES_LEFT);
            assert_int_equal(fast_make_tiny(&bvh, &scene, &tree, &reason), STATUS_UNSUPPORTED);
            assert_non_null(strstr(reason.text, "fast_small: the scene's"));
            assert_true(tree.small == NULL && tree.block == NULL);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

/* Engine fast has plain trees. Those of fast_small are tiny where vertices were quantised. */
static void forms_of_engines(void **state)
{
    (void)state;
    for (size_t i = 0; tri_stores[i]; i++) {
        const struct packed packed = {.store = tri_stores[i]};
        const bool moved = strcmp(tri_stores[i]->name, "quantised") == 0;
        assert_string_equal(fast_form_of(false, &packed)->name, "fast");
        assert_string_equal(fast_form_of(true, &packed)->name, moved ? "fast_tiny" : "fast_small");
    }
    for (size_t i = 0; i < ARRAY_COUNT(fast_forms); i++)
        assert_true(fast_forms[i].kernel()->runs());
}

static void empty_and_too_deep_trees(void **state)
{
    (void)state;
    empty_and_too_deep(fast_make_tiny, 3000);
}

/* --- hits ------------------------------------------------------------------------------------- */

/* As many triangles as fit in a leaf, over 3 to 32 vertices; each is the only one that some rays
 * meet. */
static void every_place_in_a_leaf_is_tested(void **state)
{
    (void)state;
    struct rng rng = rng_make(6, 1);
    for (uint32_t count = 1; count <= TINY_TRIS; count++) {
        const uint32_t most = count < TINY_VERTICES ? count : TINY_VERTICES;
        const uint32_t vertices = count < 11 ? 3 * count : 8 + rng_below(&rng, most - 7);
        struct scene scene = grid_scene(&rng, 14, vertices, count);
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t c = 0; c < 3; c++)
                scene.index[3 * i + c] =
                    count < 11 ? 3 * i + c : (i + c * (1 + i / vertices)) % vertices;
        for (uint32_t i = 0; i < 3 * vertices; i++)
            scene.vertex[i] *= 0x1p-14f;
        struct fast_tree tree = make_tree(&scene, 1);
        assert_int_equal(tree.node_count, 1);
        assert_int_equal(small_children(tree.small), 1);
        assert_int_equal(tiny_tris(tree.block[0]), count);
        assert_int_equal(tiny_vertices(tree.block[0]), vertices);
        fast_free(&tree);
        assert_true(check_hits(&rng, &scene, 1) > HIT_RAYS / 2);
        scene_free(&scene);
    }
}

int main(void)
{
    tested = &fast_forms[2];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_read_as_they_were_written),
        cmocka_unit_test(limits_of_a_block),
        cmocka_unit_test(trees_hold_all_triangles),
        cmocka_unit_test(closed_meshes_take_little),
        cmocka_unit_test(scenes_off_a_grid_are_refused),
        cmocka_unit_test(forms_of_engines),
        cmocka_unit_test(empty_and_too_deep_trees),
        cmocka_unit_test(every_place_in_a_leaf_is_tested),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
