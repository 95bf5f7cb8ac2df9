/* What the tests of fast trees share. */
#ifndef FAST_FIXTURE_H
#define FAST_FIXTURE_H

#include "ref/fast/block.h"
#include "ref/fast/decoded.h"
#include "ref/fast/fast.h"
#include "ref/layout.h"
#include "ref/base/rng.h"
#include "tests/support/ray_fixture.h"
#include "tests/support/tree_fixture.h"
#include "ref/primitives/test_run.h"
#include <math.h>
#include <string.h>

static const struct tri_test *woop(void)
{
    return tri_test_find("woop");
}

static const struct fast_form *tested = &fast_forms[0]; /* of the trees that are made */

static inline const struct fast_kernel *const *kernels(void)
{
    return tested->kernels;
}

/* Moves the vertices onto a grid of so many bits. */
static inline void settle(struct scene *scene, uint32_t bits)
{
    struct scene moved;
    struct quantised quantised;
    struct reason reason = {""};
    if (scene_quantise(scene, bits, &moved, &quantised, &reason))
        fail_msg("%s", reason.text);
    scene_free(scene);
    *scene = moved;
}

/* For a form of vertices on a grid the scene is moved onto one. */
static inline struct fast_tree make_tree(struct scene *scene, uint32_t leaf)
{
    struct grid grid;
    struct reason why;
    if (tested == &fast_forms[2] && grid_of_scene(scene, &grid, &why))
        settle(scene, 16);
    struct build_options options = {.leaf = leaf};
    struct reason reason = {""};
    struct fast_tree tree;
    struct bvh bvh;
    assert_int_equal(builders[0]->build(scene, &options, &bvh, NULL), STATUS_OK);
    if (tested->make(&bvh, scene, &tree, &reason))
        fail_msg("%s", reason.text);
    bvh_free(&bvh);
    return tree;
}

/* The same bits; at the same t another triangle may be named. */
static bool same(const struct hit *a, const struct hit *b)
{
    if (a->prim != b->prim && a->prim != ABI_NO_PRIM && b->prim != ABI_NO_PRIM)
        return a->t == b->t;
    return memcmp(a, b, sizeof *a) == 0;
}

static inline void check_any(const struct scene *scene, const struct ray *ray,
                             const struct hit *truth, const struct hit *hit)
{
    float v[3][3];
    struct hit one;
    struct tri_ray r = tri_ray_make(ray);
    assert_int_equal(hit->prim == ABI_NO_PRIM, truth->prim == ABI_NO_PRIM);
    if (hit->prim == ABI_NO_PRIM)
        return;
    scene_tri(scene, hit->prim, v);
    assert_true(tri_test_run(ABI_TRI_WOOP, &r, v, &one));
    one.prim = hit->prim;
    assert_memory_equal(&one, hit, sizeof one);
}

static inline void check_kernel(const struct fast_kernel *kernel, const struct fast_tree *tree,
                                const struct scene *scene, const struct ray *ray, size_t count,
                                const struct hit *truth)
{
    struct hit *hit = calloc(count, sizeof *hit);
    assert_non_null(hit);
    kernel->closest(tree, ray, count, hit);
    for (size_t i = 0; i < count; i++)
        if (!same(&truth[i], &hit[i]))
            fail_msg("%s%s%s%s, ray %zu: t %a prim %d, expected t %a prim %d", kernel->name,
                     tree->in_pairs ? " in pairs" : "", tree->in_packets ? " in packets" : "",
                     tree->in_stream ? " in a stream" : "", i, (double)hit[i].t, (int)hit[i].prim,
                     (double)truth[i].t, (int)truth[i].prim);
    kernel->any(tree, ray, count, hit);
    for (size_t i = 0; i < count; i++)
        check_any(scene, &ray[i], &truth[i], &hit[i]);
    free(hit);
}

/* Sets how kernels trace, by the bits of `way`: in pairs whatever the size of the tree, in packets
 * of rays that are alike, however far apart, in a stream. */
#define TREE_WAYS 8
static inline void set_way(struct fast_tree *tree, int way)
{
    tree->in_pairs = way & 1;
    tree->in_packets = way & 2;
    tree->packet_width = INFINITY;
    tree->in_stream = way & 4;
}

/* Ray by ray, and in all ways. */
static inline void check_rays(struct fast_tree *tree, const struct scene *scene,
                              const struct ray *ray, size_t count)
{
    struct hit *truth = calloc(count, sizeof *truth);
    assert_non_null(truth);
    for (size_t i = 0; i < count; i++)
        trace_brute(scene, woop(), QUERY_CLOSEST, &ray[i], &truth[i]);
    for (size_t k = 0; kernels()[k]; k++)
        for (int way = 0; way < TREE_WAYS && kernels()[k]->runs(); way++) {
            set_way(tree, way);
            check_kernel(kernels()[k], tree, scene, ray, count, truth);
        }
    free(truth);
}

/* A scene without triangles has a tree without nodes, which hits nothing. A tree that is too deep,
 * a chain of so many links, is refused, and nothing is left of it. */
static inline void empty_and_too_deep(enum status (*make)(const struct bvh *, const struct scene *,
                                                          struct fast_tree *, struct reason *),
                                      uint32_t links)
{
    struct scene none, chain = trees_grid(links);
    struct bvh bvh = {.node = NULL};
    struct fast_tree tree;
    struct reason reason = {""};
    struct ray ray = {.dir = {0, 0, 1}, .tmax = 1};
    struct hit hit;
    assert_int_equal(scene_make(0, 0, &none), STATUS_OK);
    assert_int_equal(make(&bvh, &none, &tree, &reason), STATUS_OK);
    assert_int_equal(tree.node_count, 0);
    assert_int_equal(fast_bytes(&tree), 0);
    assert_int_equal(fast_all(&tree, &ray, 1, &hit), 0);
    fast_free(&tree);
    bvh = trees_make(&chain, 1, TREES_LEFT);
    assert_int_equal(make(&bvh, &chain, &tree, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "256 entries"));
    assert_true(tree.node == NULL && tree.small == NULL && tree.block == NULL);
    bvh_free(&bvh);
    scene_free(&chain);
    scene_free(&none);
}

#endif
