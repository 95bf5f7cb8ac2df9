/* Scenes of numbers of all kinds, and laws of trees and hits, for tests of small and tiny trees. */
#ifndef SMALL_FIXTURE_H
#define SMALL_FIXTURE_H

#include "tests/fast/fast_fixture.h"

#include "ref/fast/fast_frame.h"
#include "ref/fast/small_tree.h"

/* Floats of one kind, some of them twice. */
static inline float any_float(struct rng *rng, uint32_t kind)
{
    const float unit = rng_range(rng, -1, 1);
    switch (kind) {
    case 0:
        return unit;
    case 1:
        return unit * 1e30f;
    case 2:
        return unit * 0x1p-140f;
    case 3:
        return rng_below(rng, 2) ? 0.0f : -0.0f;
    case 4:
        return ldexpf(unit, (int)rng_below(rng, 250) - 125);
    case 5:
        return unit * 1e12f;
    case 6:
        return 4096.0f + (float)rng_below(rng, 3);
    default:
        return (float)rng_below(rng, 5) - 2;
    }
}

#define KINDS 8u

/* A scene of `count` triangles over `vertices` vertices. */
static inline struct scene any_scene(struct rng *rng, uint32_t kind, uint32_t vertices,
                                     uint32_t count)
{
    struct scene scene;
    assert_int_equal(scene_make(vertices, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        scene.vertex[i] = any_float(rng, kind < KINDS ? kind : rng_below(rng, KINDS));
    for (uint32_t i = 0; i < 3 * count; i++)
        scene.index[i] = rng_below(rng, vertices);
    return scene;
}

/* --- trees ------------------------------------------------------------------------------------ */

static inline bool is_tiny(void)
{
    return tested == &fast_forms[2];
}

static inline uint32_t leaf_tris(const uint32_t *block)
{
    return is_tiny() ? tiny_tris(*block) : small_tris(*block);
}

/* The number and the corners of a triangle of a block. */
static inline uint32_t leaf_tri(const struct fast_tree *tree, const uint32_t *block, uint32_t i,
                                float v[3][3])
{
    if (is_tiny()) {
        tiny_tri(&tree->tiny, block, i, v);
        return tiny_prim(&tree->tiny, block, i, NULL);
    }
    small_tri(block, i, v);
    return small_prim(block, i);
}

/* The true box of what is below a reference, and what is counted there. */
static inline struct box box_below(const struct fast_tree *tree, uint32_t ref, uint8_t *seen,
                                   uint32_t *leaves)
{
    struct box box = box_empty();
    if (ref & FAST_LEAF) {
        const uint32_t *block = tree->block + (ref & ~FAST_LEAF);
        ++*leaves;
        for (uint32_t i = 0; i < leaf_tris(block); i++) {
            float v[3][3];
            seen[leaf_tri(tree, block, i, v)]++;
            for (int c = 0; c < 3; c++)
                box_add_point(&box, v[c]);
        }
        return box;
    }
    const struct fast_small_node *node = &tree->small[ref];
    uint32_t least[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, most[3] = {0};
    assert_in_range(small_children(node), 1, FAST_WIDTH);
    for (uint32_t i = 0; i < small_children(node); i++) {
        struct box child = box_below(tree, small_ref(node, i), seen, leaves);
        for (int k = 0; k < 3; k++) {
            const double lo = (double)tree->lo[k], step = (double)tree->step[k];
            const uint32_t lower = small_code(node, 0, k, i), upper = small_code(node, 1, k, i);
            const double unit = 1u << (node->shifts >> 4 * k & 15u);
            assert_true(lower <= upper && upper <= 65536);
            assert_true(lo + step * lower <= (double)child.lo[k]);
            assert_true(lo + step * upper >= (double)child.hi[k]);
            /* No more than a unit and a code beyond, in steps that are rounded. */
            assert_true(lo + step * (lower + unit + 1) >= (double)child.lo[k]);
            assert_true(lo + step * (upper - unit - 1) <= (double)child.hi[k]);
            const uint32_t down = frame_down(tree, k, child.lo[k]);
            const uint32_t up = frame_up(tree, k, child.hi[k]);
            least[k] = down < least[k] ? down : least[k];
            most[k] = up > most[k] ? up : most[k];
        }
        box_add_box(&box, &child);
    }
    for (int k = 0; k < 3; k++) { /* half of the unit would not reach */
        const uint32_t shift = node->shifts >> 4 * k & 15u;
        assert_true(shift == 0 || most[k] - least[k] > 255u << (shift - 1));
    }
    return box;
}

/* Every triangle is in one leaf, in boxes that hold it and are not much larger. */
static inline void check_tree(struct scene *scene)
{
    struct fast_tree tree = make_tree(scene, 1);
    uint8_t *seen = calloc(scene->tri_count, 1);
    uint32_t leaves = 0;
    assert_non_null(seen);
    assert_int_equal(fast_bytes(&tree), 80u * tree.node_count + 4 * tree.block_words);
    (void)box_below(&tree, 0, seen, &leaves);
    for (uint32_t i = 0; i < scene->tri_count; i++)
        assert_int_equal(seen[i], 1);
    assert_true(leaves >= scene->tri_count / (is_tiny() ? TINY_TRIS : SMALL_TRIS));
    free(seen);
    fast_free(&tree);
}

/* The trees of scenes of all kinds.
 *   bits   of the grid that they are moved onto; 0: none */
static inline void check_trees(uint32_t bits)
{
    static const char *const specs[] = {
        "soup:n=1",    "soup:n=2", "soup:n=500",   "sphere:n=20",   "platonic", "cornell",
        "terrain:k=5", "stack",    "needles:n=99", "flake:depth=2", "grid:n=12"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene;
        struct reason reason = {""};
        if (scene_open(specs[s], 1, &scene, &reason))
            fail_msg("%s", reason.text);
        if (bits)
            settle(&scene, bits);
        check_tree(&scene);
        scene_free(&scene);
    }
}

/* --- hits ------------------------------------------------------------------------------------- */

#define HIT_RAYS 400

/* Rays to points of triangles from around the scene. Returns how many hit something. */
static inline size_t check_hits(struct rng *rng, struct scene *scene, float size)
{
    static struct ray ray[HIT_RAYS];
    struct fast_tree tree = make_tree(scene, 1);
    size_t hits = 0;
    for (size_t i = 0; i < HIT_RAYS; i++) {
        float v[3][3], w[3] = {rng_range(rng, 0.1f, 1), rng_range(rng, 0.1f, 1), 0.5f};
        struct hit hit;
        scene_tri(scene, rng_below(rng, scene->tri_count), v);
        ray[i] = (struct ray){.tmax = RAY_TMAX};
        for (int k = 0; k < 3; k++) {
            const float sum = w[0] + w[1] + w[2];
            const float to =
                v[0][k] * (w[0] / sum) + v[1][k] * (w[1] / sum) + v[2][k] * (w[2] / sum);
            ray[i].org[k] = rng_range(rng, -2, 2) * size;
            ray[i].dir[k] = (to - ray[i].org[k]) / size;
        }
        trace_brute(scene, woop(), QUERY_CLOSEST, &ray[i], &hit);
        hits += hit.prim != ABI_NO_PRIM;
    }
    check_rays(&tree, scene, ray, HIT_RAYS);
    fast_free(&tree);
    return hits;
}

#endif
