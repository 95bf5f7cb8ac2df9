/* A tree written out by a slow builder, to be compared with that of a fast one. Include after
 * cmocka.h. */
#ifndef TESTS_SLOW_TREE_H
#define TESTS_SLOW_TREE_H

#include "tests/support/tree_fixture.h"

#include "ref/base/rng.h"

#include <math.h>
#include <string.h>

struct slow_tree {
    struct bvh_node *node;
    uint32_t *prim;
    uint32_t nodes, prims;
};

static inline struct slow_tree slow_room(uint32_t items)
{
    struct slow_tree tree = {.node = calloc(2 * (size_t)items, sizeof *tree.node),
                             .prim = calloc(items, sizeof *tree.prim)};
    assert_true(tree.node && tree.prim);
    return tree;
}

static inline void slow_free(struct slow_tree *tree)
{
    free(tree->node);
    free(tree->prim);
}

static inline uint32_t slow_open(struct slow_tree *tree)
{
    tree->node[tree->nodes].item_first = tree->prims;
    return tree->nodes++;
}

static inline void slow_leaf(struct slow_tree *tree, const uint32_t *prim, uint32_t count)
{
    uint32_t at = slow_open(tree);
    memcpy(tree->prim + tree->prims, prim, count * sizeof *prim);
    tree->node[at].item_count = count;
    tree->prims += count;
}

/* Every node, every item, and each box as the bounds of the triangles below it. */
static inline void slow_compare(const struct slow_tree *want, const struct bvh *got,
                                const struct scene *scene, const char *name)
{
    if (want->nodes != got->node_count || want->prims != got->prim_count)
        fail_msg("%s: %u nodes of %u items, not %u of %u", name, got->node_count, got->prim_count,
                 want->nodes, want->prims);
    for (uint32_t i = 0; i < want->prims; i++)
        if (want->prim[i] != got->prim[i])
            fail_msg("%s: item %u is %u, not %u", name, i, got->prim[i], want->prim[i]);
    for (uint32_t i = want->nodes; i-- > 0;) {
        struct bvh_node *a = &want->node[i];
        const struct bvh_node *b = &got->node[i];
        if (a->fst != b->fst || a->snd != b->snd || a->item_first != b->item_first ||
            a->item_count != b->item_count)
            fail_msg("%s: node %u", name, i);
        a->bounds = box_empty();
        for (uint32_t k = 0; k < a->item_count; k++) {
            struct box one = scene_tri_bounds(scene, want->prim[a->item_first + k]);
            box_add_box(&a->bounds, &one);
        }
        if (a->item_count == 0) {
            box_add_box(&a->bounds, &want->node[a->fst].bounds);
            box_add_box(&a->bounds, &want->node[a->snd].bounds);
        }
        for (int k = 0; k < 3; k++)
            if (a->bounds.lo[k] != b->bounds.lo[k] || a->bounds.hi[k] != b->bounds.hi[k])
                fail_msg("%s: box of node %u", name, i);
    }
}

/* Triangles with integer coordinates, of which many are equal: all areas are exact. */
static inline struct scene slow_scene(uint32_t count, uint32_t span, uint32_t size, uint64_t seed)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(seed, count);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t at = rng_below(&rng, span);
            for (uint32_t c = 0; c < 3; c++)
                scene.vertex[9 * i + 3 * c + k] = (float)(at + rng_below(&rng, size));
        }
    return scene;
}

/* A triangle with what orders it. */
struct slow_item {
    uint32_t prim;
    struct box box;
    double key;
    uint64_t code;
};

static inline float slow_centre(const struct slow_item *item, int axis)
{
    return 0.25f * item->box.lo[axis] + 0.25f * item->box.hi[axis];
}

static inline int slow_by_code(const void *left, const void *right)
{
    const struct slow_item *a = left, *b = right;
    return a->code < b->code ? -1 : a->code > b->code;
}

static inline struct slow_item *slow_items(const struct scene *scene)
{
    struct slow_item *item = calloc(scene->tri_count, sizeof *item);
    assert_non_null(item);
    for (uint32_t i = 0; i < scene->tri_count; i++)
        item[i] = (struct slow_item){.prim = i, .box = scene_tri_bounds(scene, i)};
    return item;
}

/* Sorted by code and index. Returns the bits of the index. */
static inline uint32_t slow_codes(struct slow_item *item, uint32_t count)
{
    float lo[3] = {INFINITY, INFINITY, INFINITY}, most = 0;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            lo[k] = fminf(lo[k], slow_centre(&item[i], k));
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            most = fmaxf(most, slow_centre(&item[i], k) - lo[k]);
    uint32_t index_bits = 0;
    while ((1u << index_bits) < count)
        index_bits++;
    uint32_t bits = (64 - index_bits) / 3 > 21 ? 21 : (64 - index_bits) / 3;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cell[3];
        for (int k = 0; k < 3; k++) {
            float scale = most > 0 ? (float)(1u << bits) / most : 0;
            float at = (slow_centre(&item[i], k) - lo[k]) * scale;
            cell[k] = at >= (float)(1u << bits) ? (1u << bits) - 1 : (uint32_t)at;
        }
        item[i].code = 0;
        for (uint32_t bit = bits; bit-- > 0;)
            for (int k = 0; k < 3; k++)
                item[i].code = item[i].code << 1 | (cell[k] >> bit & 1);
        item[i].code = item[i].code << index_bits | item[i].prim;
    }
    qsort(item, count, sizeof *item, slow_by_code);
    return index_bits;
}

#endif
