/* Laws of the trees of ref/fast/: blocks, bounds, what is decoded, refused and read. */
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

/* --- what is read ----------------------------------------------------------------------------- */

/* Which bytes of a tree were read. */
struct bytes_seen {
    const struct fast_tree *tree;
    uint8_t *node, *block;
    uint64_t bytes;
    uint32_t last; /* word that was begun with last */
};

static void see(void *reader, const void *at, size_t bytes)
{
    struct bytes_seen *seen = reader;
    const struct fast_tree *tree = seen->tree;
    const uintptr_t node = tree->small ? (uintptr_t)tree->small : (uintptr_t)tree->node;
    const uintptr_t from = (uintptr_t)at, block = (uintptr_t)tree->block;
    seen->bytes += bytes;
    memcpy(&seen->last, at, sizeof seen->last);
    if (from >= node && from + bytes <= node + fast_node_bytes(tree) * tree->node_count) {
        assert_int_equal((from - node) % fast_node_bytes(tree), 0);
        assert_int_equal(bytes, fast_node_bytes(tree));
        memset(seen->node + (from - node), 1, bytes);
        return;
    }
    assert_true(from >= block && from + bytes <= block + 4 * tree->block_words);
    memset(seen->block + (from - block), 1, bytes);
}

/* Through the middle of a triangle, in a range in which it is alone if `turn` is well chosen. */
static struct ray middle_of(const struct scene *scene, uint32_t prim, uint32_t turn)
{
    struct rng rng = rng_make(prim, turn);
    struct ray ray = {.tmin = 0.99f, .tmax = 1.01f};
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++) {
        ray.dir[k] = rng_range(&rng, -1, 1);
        ray.org[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - ray.dir[k];
    }
    return ray;
}

/* Where each triangle is hit once, each node and each word of each leaf is read. */
static void a_tree_of_which_all_is_hit_is_read_to_its_last_word(void **state)
{
    (void)state;
    static const char *const kinds[] = {"soup", "grid", "sphere"};
    for (size_t form = 0; form < ARRAY_COUNT(fast_forms); form++)
        for (size_t i = 0; i < 3 * ARRAY_COUNT(kinds); i++) {
            struct scene scene = make_scene(kinds[i / 3], i / 3 ? 9 : 200);
            tested = &fast_forms[form];
            struct fast_tree tree = make_tree(&scene, 1 + (uint32_t)(i % 3) * 3);
            const size_t nodes = fast_node_bytes(&tree) * tree.node_count;
            struct bytes_seen seen = {.tree = &tree};
            seen.node = calloc(nodes, 1);
            seen.block = calloc(tree.block_words, 4);
            assert_true(seen.node && seen.block);
            for (uint32_t prim = 0; prim < scene.tri_count; prim++) {
                struct hit hit = {.prim = ABI_NO_PRIM};
                for (uint32_t turn = 0; turn < 200 && hit.prim != prim; turn++) {
                    const struct ray ray = middle_of(&scene, prim, turn);
                    fast_watched(&tree, &ray, false, see, &seen, &hit);
                }
                assert_int_equal(hit.prim, prim);
            }
            for (size_t k = 0; k < nodes; k++)
                assert_true(seen.node[k]);
            for (size_t k = 0; k < 4 * tree.block_words; k++)
                if (!seen.block[k])
                    fail_msg("%s, %s: byte %zu of %llu is never read", tested->name, kinds[i / 3],
                             k, 4 * (unsigned long long)tree.block_words);
            free(seen.node);
            free(seen.block);
            fast_free(&tree);
            scene_free(&scene);
        }
}

/* A fan of triangles in one leaf: a node, three words of corners, three for each vertex; where one
 * is hit its number, which is read last. */
static void a_leaf_is_read_once_and_one_number_of_it(void **state)
{
    (void)state;
    tested = &fast_forms[0];
    for (uint32_t count = 1; count <= BLOCK_TRIS; count++) {
        struct scene scene;
        assert_int_equal(scene_make(count + 2, count, &scene), STATUS_OK);
        for (uint32_t v = 1; v < count + 2; v++) {
            scene.vertex[3 * v] = (float)v;
            scene.vertex[3 * v + 1] = (float)(v * v); /* below y = (count + 1) x */
        }
        for (uint32_t i = 0; i < 3 * count; i++)
            scene.index[i] = i % 3 ? i / 3 + i % 3 : 0;
        struct fast_tree tree = make_tree(&scene, BLOCK_TRIS);
        assert_int_equal(tree.node_count, 1);
        const uint64_t leaf = sizeof(struct fast_node) + 4 * (3 + 3 * (count + 2));
        uint8_t node[sizeof(struct fast_node)], block[4 * 64];
        for (uint32_t prim = 0; prim <= count; prim++) { /* the last time beside all of them */
            struct bytes_seen seen = {.tree = &tree, .node = node, .block = block};
            struct ray ray = middle_of(&scene, prim < count ? prim : 0, 0);
            struct hit hit;
            if (prim == count)
                ray = (struct ray){{1, (float)count + 1.5f, -1}, 0, {0, 0, 1}, INFINITY};
            fast_watched(&tree, &ray, false, see, &seen, &hit);
            assert_int_equal(hit.prim, prim < count ? prim : ABI_NO_PRIM);
            assert_int_equal(seen.bytes, leaf + (prim < count ? 4 : 0));
            if (prim < count)
                assert_int_equal(seen.last, prim);
        }
        fast_free(&tree);
        scene_free(&scene);
    }
}

/* Where one triangle is all there is, a ray that hits it reads every byte of the tree once; one
 * that begins behind it all but its number, of one or two words. */
static void one_triangle_is_read_once(void **state)
{
    (void)state;
    struct rng rng = rng_make(12, 0);
    for (size_t form = 0; form < ARRAY_COUNT(fast_forms); form++) {
        uint32_t found = 0, missed = 0;
        for (uint32_t n = 0; n < 500; n++) {
            struct scene scene;
            struct hit hit;
            assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
            for (uint32_t i = 0; i < 9; i++) /* of any width in bits */
                scene.vertex[i] = (float)rng_below(&rng, 2u << n % 14) + (i % 4 ? 0 : 1);
            for (uint32_t i = 0; i < 3; i++)
                scene.index[i] = i;
            tested = &fast_forms[form];
            struct fast_tree tree = make_tree(&scene, 1);
            struct bytes_seen seen = {.tree = &tree};
            seen.node = calloc(tree.node_count, fast_node_bytes(&tree));
            seen.block = calloc(tree.block_words, 4);
            assert_true(seen.node && seen.block);
            struct ray ray = middle_of(&scene, 0, n);
            fast_watched(&tree, &ray, n % 2, see, &seen, &hit);
            const uint64_t bytes = seen.bytes;
            if (hit.prim == 0)
                assert_int_equal(bytes, fast_bytes(&tree));
            found += hit.prim == 0;
            seen.bytes = 0;
            ray.tmin = 1.0001f; /* behind it */
            fast_watched(&tree, &ray, n % 2, see, &seen, &hit);
            missed += hit.prim == ABI_NO_PRIM && seen.bytes + 8 >= bytes;
            free(seen.node);
            free(seen.block);
            fast_free(&tree);
            scene_free(&scene);
        }
        assert_true(found > 350 && missed > 350);
    }
}

/* `count` walls across z, one behind the other. */
static struct scene make_walls(uint32_t count)
{
    struct scene scene;
    assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * count; i++) {
        scene.vertex[3 * i] = i % 3 == 1 ? 4 : 0;
        scene.vertex[3 * i + 1] = i % 3 == 2 ? 4 : 0;
        scene.vertex[3 * i + 2] = (float)(i / 3);
        scene.index[i] = i;
    }
    return scene;
}

/* A ray that would go on reads the nodes that one which ends behind the first wall reads. */
static void what_lies_behind_the_first_hit_is_not_read(void **state)
{
    (void)state;
    enum { WALLS = 256 };
    for (size_t form = 0; form < ARRAY_COUNT(fast_forms); form++)
        for (uint32_t turn = 0; turn < 4; turn++) {
            struct scene scene = make_walls(WALLS);
            tested = &fast_forms[form];
            struct fast_tree tree = make_tree(&scene, 1);
            const size_t nodes = fast_node_bytes(&tree) * tree.node_count;
            const bool up = turn & 1, any = turn & 2;
            uint8_t *node[2], *block = calloc(tree.block_words, 4);
            uint64_t bytes[2];
            for (int ends = 0; ends < 2; ends++) {
                const struct ray ray = {
                    {1, 1, up ? -1 : WALLS}, 0, {0, 0, up ? 1 : -1}, ends ? 1.5f : INFINITY};
                struct bytes_seen seen = {.tree = &tree, .block = block};
                struct hit hit;
                node[ends] = seen.node = calloc(nodes, 1);
                assert_true(seen.node && block);
                fast_watched(&tree, &ray, any, see, &seen, &hit);
                bytes[ends] = seen.bytes;
                assert_true(any && !ends ? hit.prim < WALLS
                                         : hit.prim == (up ? 0 : WALLS - 1) && hit.t == 1);
            }
            assert_memory_equal(node[0], node[1], nodes);
            assert_true(memchr(node[0], 0, nodes) && bytes[0] < fast_bytes(&tree) / 2);
            free(node[0]);
            free(node[1]);
            free(block);
            fast_free(&tree);
            scene_free(&scene);
        }
}

/* Two walls in a leaf, met from either side: once the second of them in the block is nearer, and
 * its number, a word, is read as well; not where any hit is enough. */
static void any_hit_reads_one_number(void **state)
{
    (void)state;
    for (size_t form = 0; form < ARRAY_COUNT(fast_forms); form++) {
        struct scene scene = make_walls(2);
        uint64_t bytes[2];
        tested = &fast_forms[form];
        struct fast_tree tree = make_tree(&scene, BLOCK_TRIS);
        uint8_t node[sizeof(struct fast_node)], block[4 * 64];
        assert_int_equal(tree.node_count, 1);
        for (int any = 0; any < 2; any++) {
            struct bytes_seen seen = {.tree = &tree, .node = node, .block = block};
            for (int up = 0; up < 2; up++) {
                const struct ray ray = {{1, 1, up ? -1 : 2}, 0, {0, 0, up ? 1 : -1}, INFINITY};
                struct hit hit;
                fast_watched(&tree, &ray, any, see, &seen, &hit);
                assert_true(hit.t == 1 || any);
            }
            bytes[any] = seen.bytes;
        }
        assert_int_equal(bytes[0] - bytes[1], 4);
        if (form == 0)
            assert_int_equal(bytes[1], 2 * (sizeof(struct fast_node) + 4 * (3 + 3 * 6 + 1)));
        fast_free(&tree);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_hold_their_triangles),
        cmocka_unit_test(bounds_are_conservative),
        cmocka_unit_test(every_layout_is_decoded),
        cmocka_unit_test(empty_parts_fall_away),
        cmocka_unit_test(empty_and_too_deep_trees),
        cmocka_unit_test(a_tree_of_which_all_is_hit_is_read_to_its_last_word),
        cmocka_unit_test(a_leaf_is_read_once_and_one_number_of_it),
        cmocka_unit_test(one_triangle_is_read_once),
        cmocka_unit_test(what_lies_behind_the_first_hit_is_not_read),
        cmocka_unit_test(any_hit_reads_one_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
