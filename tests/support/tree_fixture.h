/* Scenes and hand-made trees for tests of trees and layouts. */
#ifndef SUPPORT_TREE_FIXTURE_H
#define SUPPORT_TREE_FIXTURE_H

#include "ref/layout.h"

#include <stdlib.h>

/* `count` small triangles on a grid of 256 columns in the plane z = 0; all coordinates are
 * multiples of 1/8 and below 513. Aborts without memory. */
static inline struct scene trees_grid(uint32_t count)
{
    struct scene scene;
    if (scene_make(3 * count, count, &scene))
        abort();
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *p = scene.vertex + 9 * (size_t)i + 3 * (size_t)c;
            p[0] = 0.25f * (float)(i % 256) + (c == 1 ? 0.125f : 0);
            p[1] = 0.25f * (float)(i / 256) + (c == 2 ? 0.125f : 0);
            scene.index[3 * (size_t)i + c] = 3 * i + c;
        }
    return scene;
}

/* A row of triangles: triangle i lies across the z axis at z = i + 1. Aborts without memory. */
static inline struct scene trees_row(uint32_t count)
{
    struct scene scene;
    if (scene_make(3 * count, count, &scene))
        abort();
    for (uint32_t i = 0; i < 3 * count; i++) {
        scene.index[i] = i;
        scene.vertex[3 * i] = (float)(i % 3) - 1;
        scene.vertex[3 * i + 1] = i % 3 == 1 ? 2 : -1;
        scene.vertex[3 * i + 2] = (float)(i / 3 + 1);
    }
    return scene;
}

/* `count` copies of one triangle. */
static inline struct scene trees_copies(uint32_t count, const float v[3][3])
{
    struct scene scene;
    if (scene_make(3, count, &scene))
        abort();
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            scene.vertex[3 * c + k] = v[c][k];
    for (uint32_t i = 0; i < 3 * count; i++)
        scene.index[i] = i % 3;
    return scene;
}

enum trees_shape {
    TREES_BALANCED,
    TREES_LEFT,  /* every snd is a leaf: all inner nodes come first */
    TREES_RIGHT, /* every fst is a leaf */
};

static inline uint32_t trees_cut(enum trees_shape shape, uint32_t lo, uint32_t hi)
{
    if (shape == TREES_LEFT)
        return hi - 1;
    return shape == TREES_RIGHT ? lo + 1 : lo + (hi - lo) / 2;
}

/* Gives every node the exact bounds of its triangles. */
static inline void trees_fit(struct bvh *bvh, const struct scene *scene)
{
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        struct bvh_node *node = &bvh->node[i];
        node->bounds = box_empty();
        for (uint32_t k = 0; k < node->item_count; k++) {
            struct box one = scene_tri_bounds(scene, bvh->prim[node->item_first + k]);
            box_add_box(&node->bounds, &one);
        }
        if (node->item_count == 0) {
            box_add_box(&node->bounds, &bvh->node[node->fst].bounds);
            box_add_box(&node->bounds, &bvh->node[node->snd].bounds);
        }
    }
}

/* A tree whose leaves hold `leaf` triangles each (the last one the rest), in scene order. */
static inline struct bvh trees_make(const struct scene *scene, uint32_t leaf,
                                    enum trees_shape shape)
{
    struct waiting {
        uint32_t lo, hi, parent;
    };
    uint32_t leaves = (scene->tri_count + leaf - 1) / leaf;
    struct bvh bvh = {.node_count = 2 * leaves - 1,
                      .prim_count = scene->tri_count,
                      .tri_count = scene->tri_count};
    struct waiting *stack = calloc(leaves + 1, sizeof *stack);
    bvh.node = calloc(bvh.node_count, sizeof *bvh.node);
    bvh.prim = calloc(bvh.prim_count, sizeof *bvh.prim);
    if (!stack || !bvh.node || !bvh.prim)
        abort();
    for (uint32_t i = 0; i < bvh.prim_count; i++)
        bvh.prim[i] = i;
    uint32_t waiting = 0, made = 0;
    stack[waiting++] = (struct waiting){0, leaves, UINT32_MAX};
    while (waiting > 0) {
        struct waiting now = stack[--waiting];
        uint32_t i = made++;
        struct bvh_node *node = &bvh.node[i];
        if (now.parent != UINT32_MAX && i != now.parent + 1)
            bvh.node[now.parent].snd = i;
        node->item_first = now.lo * leaf;
        if (now.hi - now.lo == 1) {
            uint32_t rest = scene->tri_count - node->item_first;
            node->item_count = rest < leaf ? rest : leaf;
            continue;
        }
        uint32_t cut = trees_cut(shape, now.lo, now.hi);
        node->fst = i + 1;
        stack[waiting++] = (struct waiting){cut, now.hi, i};
        stack[waiting++] = (struct waiting){now.lo, cut, i};
    }
    free(stack);
    trees_fit(&bvh, scene);
    return bvh;
}

/* True if each leaf has triangles with consecutive numbers, in their order. */
static inline bool trees_leaves_are_whole(const struct bvh *bvh)
{
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        for (uint32_t k = 1; k < node->item_count; k++)
            if (bvh->prim[node->item_first + k] != bvh->prim[node->item_first] + k)
                return false;
    }
    return true;
}

#endif
