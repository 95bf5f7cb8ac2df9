/* K-d trees lose no point of a triangle. In rationals: what a leaf's voxel has of a triangle that
 * the leaf does not list lies in voxels beside it whose leaves do. */
#include "ref/kd/kd.h"
#include "scenes/scenes.h"

#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/kd/kd_fixture.h"

/* --- the law of nodes ------------------------------------------------------------------------- */

struct kd_laws {
    const struct kd_tree *tree;
    uint32_t leaves, deepest, items;
    uint32_t *seen; /* the last leaf, counted from 1, that listed a triangle */
};

static void one_leaf(void *user, const struct kd_node *leaf, const struct box *voxel,
                     uint32_t depth)
{
    struct kd_laws *laws = user;
    (void)voxel;
    laws->leaves++;
    laws->items += leaf->what >> 2;
    laws->deepest = depth > laws->deepest ? depth : laws->deepest;
    for (uint32_t i = 0; i < leaf->what >> 2; i++) {
        uint32_t prim = laws->tree->item[leaf->first + i];
        assert_true(prim < laws->tree->tri_count);
        assert_true(laws->seen[prim] != laws->leaves); /* once a leaf */
        laws->seen[prim] = laws->leaves;
    }
}

static void trees_keep_their_laws(void **state)
{
    (void)state;
    for (size_t i = 0; i < KD_SCENES; i++) {
        const char *what;
        struct scene scene = kd_scene(i, &what);
        struct kd_tree tree = kd_tree_of(&scene, what), again = kd_tree_of(&scene, what);
        struct kd_laws laws = {.tree = &tree, .seen = calloc(tree.tri_count, sizeof *laws.seen)};
        assert_non_null(laws.seen);
        kd_each_leaf(&tree, 0, tree.box, 0, one_leaf, &laws);
        assert_int_equal(tree.node_count, 2 * laws.leaves - 1);
        assert_int_equal(tree.item_count, laws.items);
        assert_int_equal(kd_node_bytes(&tree), 8 * (2 * (uint64_t)laws.leaves - 1));
        assert_int_equal(kd_item_bytes(&tree), 4 * (uint64_t)laws.items + 48 * scene.tri_count);
        assert_int_equal(tree.depth, laws.deepest);
        assert_true((double)laws.deepest <= 8 + 1.3 * log2((double)scene.tri_count));
        assert_int_equal(tree.tri_count, scene.tri_count);
        for (uint32_t prim = 0; prim < tree.tri_count; prim++)
            assert_true(laws.seen[prim] > 0);
        assert_int_equal(again.node_count, tree.node_count);
        assert_memory_equal(again.node, tree.node, tree.node_count * sizeof *tree.node);
        assert_memory_equal(again.item, tree.item, tree.item_count * sizeof *tree.item);
        print_message("%-16s %5u triangles, %5u leaves, %6u items, depth %2u\n", what,
                      scene.tri_count, laws.leaves, laws.items, laws.deepest);
        free(laws.seen);
        kd_free(&tree);
        kd_free(&again);
        scene_free(&scene);
    }
}

/* --- the law of points ------------------------------------------------------------------------ */

#define CORNERS 12 /* of a triangle that six planes cut */

struct kd_polygon {
    mpq_t at[CORNERS][3];
    uint32_t count;
};

struct cover {
    const struct scene *scene;
    const struct kd_tree *tree;
    const char *what;
    struct kd_polygon poly[2];
    mpq_t point[3], plane, part, whole;
    uint64_t looked;
};

static void cover_start(struct cover *c)
{
    for (int p = 0; p < 2; p++)
        for (int i = 0; i < CORNERS; i++)
            for (int k = 0; k < 3; k++)
                mpq_init(c->poly[p].at[i][k]);
    mpq_inits(c->point[0], c->point[1], c->point[2], c->plane, c->part, c->whole, NULL);
}

static void cover_end(struct cover *c)
{
    for (int p = 0; p < 2; p++)
        for (int i = 0; i < CORNERS; i++)
            for (int k = 0; k < 3; k++)
                mpq_clear(c->poly[p].at[i][k]);
    mpq_clears(c->point[0], c->point[1], c->point[2], c->plane, c->part, c->whole, NULL);
}

/* Whether a leaf whose voxel has the point lists the triangle. */
static bool is_listed(struct cover *c, uint32_t number, uint32_t prim)
{
    const struct kd_node *node = &c->tree->node[number];
    uint32_t axis = node->what & 3u, child = node->what >> 2;
    if (axis == KD_LEAF) {
        for (uint32_t i = 0; i < child; i++)
            if (c->tree->item[node->first + i] == prim)
                return true;
        return false;
    }
    mpq_set_d(c->plane, (double)node->at);
    int side = mpq_cmp(c->point[axis], c->plane);
    return (side <= 0 && is_listed(c, child, prim)) || (side >= 0 && is_listed(c, child + 1, prim));
}

/* Where the edge from a to b crosses the plane of `axis` at c->plane. */
static void cross_plane(struct cover *c, mpq_t a[3], mpq_t b[3], int axis, mpq_t out[3])
{
    mpq_sub(c->part, c->plane, a[axis]);
    mpq_sub(c->whole, b[axis], a[axis]);
    mpq_div(c->part, c->part, c->whole);
    for (int k = 0; k < 3; k++) {
        mpq_sub(c->whole, b[k], a[k]);
        mpq_mul(c->whole, c->whole, c->part);
        mpq_add(out[k], a[k], c->whole);
    }
}

/* Keeps of poly[0] what is at or above the plane (sign 1), or at or below it (-1). */
static void keep_side(struct cover *c, int axis, double plane, int sign)
{
    struct kd_polygon *from = &c->poly[0], *to = &c->poly[1];
    mpq_set_d(c->plane, plane);
    to->count = 0;
    for (uint32_t i = 0; i < from->count; i++) {
        mpq_t *a = from->at[i], *b = from->at[(i + 1) % from->count];
        int of_a = sign * mpq_cmp(a[axis], c->plane), of_b = sign * mpq_cmp(b[axis], c->plane);
        for (int k = 0; k < 3 && of_a >= 0; k++)
            mpq_set(to->at[to->count][k], a[k]);
        to->count += of_a >= 0;
        if ((of_a < 0 && of_b > 0) || (of_a > 0 && of_b < 0))
            cross_plane(c, a, b, axis, to->at[to->count++]);
        assert_true(to->count < CORNERS);
    }
    for (uint32_t i = 0; i < to->count; i++)
        for (int k = 0; k < 3; k++)
            mpq_swap(from->at[i][k], to->at[i][k]);
    from->count = to->count;
}

static void must_be_listed(struct cover *c, uint32_t prim)
{
    c->looked++;
    if (!is_listed(c, 0, prim))
        fail_msg("%s: triangle %u is lost at %a %a %a", c->what, prim, mpq_get_d(c->point[0]),
                 mpq_get_d(c->point[1]), mpq_get_d(c->point[2]));
}

/* What a voxel has of a triangle: its corners, and its middle. */
static void look_at(struct cover *c, uint32_t prim, const struct box *voxel)
{
    float v[3][3];
    struct kd_polygon *poly = &c->poly[0];
    scene_tri(c->scene, prim, v);
    poly->count = 3;
    for (int i = 0; i < 9; i++)
        mpq_set_d(poly->at[i / 3][i % 3], (double)v[i / 3][i % 3]);
    for (int k = 0; k < 3 && poly->count; k++)
        keep_side(c, k, (double)voxel->lo[k], 1);
    for (int k = 0; k < 3 && poly->count; k++)
        keep_side(c, k, (double)voxel->hi[k], -1);
    for (uint32_t i = 0; i < poly->count; i++) {
        for (int k = 0; k < 3; k++)
            mpq_set(c->point[k], poly->at[i][k]);
        must_be_listed(c, prim);
    }
    for (int k = 0; k < 3 && poly->count; k++) {
        mpq_set(c->point[k], poly->at[0][k]);
        for (uint32_t i = 1; i < poly->count; i++)
            mpq_add(c->point[k], c->point[k], poly->at[i][k]);
        mpq_set_ui(c->part, poly->count, 1);
        mpq_div(c->point[k], c->point[k], c->part);
    }
    if (poly->count)
        must_be_listed(c, prim);
}

static void look_around_leaf(void *user, const struct kd_node *leaf, const struct box *voxel,
                             uint32_t depth)
{
    struct cover *c = user;
    (void)depth;
    for (uint32_t prim = 0; prim < c->scene->tri_count; prim++) {
        struct box box = scene_tri_bounds(c->scene, prim);
        bool apart = false, listed = false;
        for (int k = 0; k < 3; k++)
            apart = apart || box.hi[k] < voxel->lo[k] || box.lo[k] > voxel->hi[k];
        for (uint32_t i = 0; i < leaf->what >> 2 && !apart; i++)
            listed = listed || c->tree->item[leaf->first + i] == prim;
        if (!apart && !listed)
            look_at(c, prim, voxel);
    }
}

static void no_point_of_a_triangle_is_lost(void **state)
{
    (void)state;
    struct cover c = {.what = NULL};
    cover_start(&c);
    for (size_t i = 0; i < KD_SCENES; i++) {
        struct scene scene = kd_scene(i, &c.what);
        struct kd_tree tree = kd_tree_of(&scene, c.what);
        c.scene = &scene;
        c.tree = &tree;
        c.looked = 0;
        kd_each_leaf(&tree, 0, tree.box, 0, look_around_leaf, &c);
        print_message("%-16s %8llu points\n", c.what, (unsigned long long)c.looked);
        kd_free(&tree);
        scene_free(&scene);
    }
    cover_end(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_keep_their_laws),
        cmocka_unit_test(no_point_of_a_triangle_is_lost),
    };
    return cmocka_run_group_tests_name("kd_cover", tests, NULL, NULL);
}
