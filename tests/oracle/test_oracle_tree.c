/* Laws of the oracle's own tree (ref/oracle/oracle_tree.h): every triangle is in one leaf, every
 * node has one parent, boxes are tight to the bit, leaves are no larger than they may be, the
 * tree below a node is the one that its triangles alone would get, and a split that a brute-force
 * search finds to be cheaper is taken. */
#include "ref/base/rng.h"
#include "ref/oracle/early.h"
#include "ref/oracle/tree_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define SLABS 16 /* of equal width, between which a node is split */

static float offset(struct rng *rng, uint32_t kind, uint32_t c, uint32_t k)
{
    if (kind == 5 || kind == 6)
        return 0;
    return kind == 3 ? (float)(c == k) : rng_range(rng, -1, 1);
}

/* Small triangles, spread evenly, in groups, along an axis, in few places, or at one end of an axis
 * with a few at the other; or without any area, on a line or all in one point. */
static struct scene draw_scene(struct rng *rng, uint32_t count, uint32_t kind)
{
    struct scene scene;
    assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < count; i++) {
        float at[3];
        for (uint32_t k = 0; k < 3; k++) {
            at[k] = rng_range(rng, -100, 100);
            if (kind == 1)
                at[k] = ldexpf(at[k], -(int)rng_below(rng, 12));
            else if (kind == 2)
                at[k] = k == i % 3 ? at[k] : 0;
            else if (kind == 3)
                at[k] = (float)rng_below(rng, 3);
            else if (kind == 4)
                at[k] *= k == count % 3 ? 0.05f : 0.02f;
        }
        if (kind == 5 || kind == 6)
            at[0] = at[1] = at[2] = kind == 5 ? at[0] : 7;
        if (kind == 4 && i <= count % 4)
            at[count % 3] = count % 2 ? 150 : -150;
        for (uint32_t c = 0; c < 3; c++) {
            scene.index[3 * i + c] = 3 * i + c;
            for (uint32_t k = 0; k < 3; k++)
                scene.vertex[9 * i + 3 * c + k] = at[k] + offset(rng, kind, c, k);
        }
    }
    return scene;
}

static struct tree make(const struct scene *scene)
{
    struct tree tree;
    struct reason reason = {""};
    if (tree_make(scene, &tree, &reason))
        fail_msg("%s", reason.text);
    return tree;
}

/* What lies below a child: its triangles, in the tree's order. */
struct below {
    uint32_t first, count, levels;
    struct box box;
};

struct tree_seen {
    const struct scene *scene;
    const struct tree *tree;
    uint32_t most;   /* of a leaf */
    uint32_t *nodes; /* how often each was met */
};

static struct below below_of(const struct tree_seen *seen, uint32_t at, int side)
{
    const struct tree_node *node = &seen->tree->node[at];
    struct below out = {.first = node->child[side], .count = node->count[side]};
    out.box = box_empty();
    if (node->count[side] == 0 && node->lo[0][side] <= node->hi[0][side]) {
        assert_in_range(node->child[side], at + 1, seen->tree->node_count - 1);
        seen->nodes[node->child[side]]++;
        struct below left = below_of(seen, node->child[side], 0);
        struct below right = below_of(seen, node->child[side], 1);
        assert_int_equal(right.first, left.first + left.count);
        out =
            (struct below){left.first, left.count + right.count,
                           1 + (left.levels > right.levels ? left.levels : right.levels), left.box};
        box_add_box(&out.box, &right.box);
        assert_true(left.count > 0 && right.count > 0 && out.count > seen->most);
    } else {
        assert_in_range(out.count, 0, seen->most);
        for (uint32_t i = 0; i < out.count; i++) {
            struct box one = scene_tri_bounds(seen->scene, seen->tree->order[out.first + i]);
            box_add_box(&out.box, &one);
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_true(node->lo[k][side] == out.box.lo[k]);
        assert_true(node->hi[k][side] == out.box.hi[k]);
    }
    return out;
}

static void check_tree(const struct scene *scene, const struct tree *tree)
{
    const uint32_t count = scene->tri_count;
    struct tree_seen seen = {scene, tree, count <= EARLY_MOST ? EARLY_MOST : TREE_LEAF, NULL};
    uint32_t *times = alloc_zeroed(count, sizeof *times);
    seen.nodes = alloc_zeroed(tree->node_count, sizeof *seen.nodes);
    struct below left = below_of(&seen, 0, 0), right = below_of(&seen, 0, 1);
    assert_int_equal(left.first, 0);
    assert_int_equal(left.count + right.count, count);
    assert_true(right.count == 0 || right.first == left.count);
    assert_true((right.count > 0) == (count > seen.most));
    assert_true(left.levels < TREE_DEPTH && right.levels < TREE_DEPTH);
    assert_int_equal(seen.nodes[0], 0);
    for (uint32_t n = 1; n < tree->node_count; n++)
        assert_int_equal(seen.nodes[n], 1);
    for (uint32_t i = 0; i < count; i++)
        times[tree->order[i]]++;
    for (uint32_t i = 0; i < count; i++)
        assert_int_equal(times[i], 1);
    free(seen.nodes);
    free(times);
}

static void all_is_in_one_place_and_bounded(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 4, 5, 63, 64, 65, 66, 127, 500, 1500};
    struct rng rng = rng_make(71, 0);
    for (uint32_t kind = 0; kind < 7; kind++)
        for (size_t n = 0; n < sizeof counts / sizeof counts[0]; n++) {
            struct scene scene = draw_scene(&rng, counts[n], kind);
            struct tree tree = make(&scene);
            check_tree(&scene, &tree);
            tree_free(&tree);
            scene_free(&scene);
        }
}

/* One triangle at each power of two and each size: what any split leaves is as uneven as before,
 * and only halving by count ends that in time. */
static void uneven_scenes_do_not_get_too_deep(void **state)
{
    (void)state;
    enum { LEAST = -120, POWERS = 240 };
    for (uint32_t each = 1; each <= 16; each *= 4) {
        struct scene scene;
        const uint32_t count = POWERS * each;
        assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 3 * count; i++) {
            const float size = ldexpf(1, LEAST + (int)(i / 3 / each));
            scene.index[i] = i;
            for (uint32_t k = 0; k < 3; k++)
                scene.vertex[3 * i + k] = size * (i % 3 == k ? 1.5f : 1.0f);
        }
        struct tree tree = make(&scene);
        check_tree(&scene, &tree);
        struct tree_seen seen = {&scene, &tree, TREE_LEAF, alloc_zeroed(tree.node_count, 4)};
        uint32_t left = below_of(&seen, 0, 0).levels, right = below_of(&seen, 0, 1).levels;
        assert_true(left + right > TREE_DEPTH / 2);
        free(seen.nodes);
        tree_free(&tree);
        scene_free(&scene);
    }
}

/* --- splits ----------------------------------------------------------------------------------- */

static float middle_of(const struct box *box, int axis)
{
    return 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
}

/* The half areas of two sides by their counts; infinite if one is empty. */
static double cost_of(const struct box *box, const bool *right, uint32_t count)
{
    struct box both[2] = {box_empty(), box_empty()};
    uint32_t size[2] = {0, 0};
    for (uint32_t i = 0; i < count; i++) {
        box_add_box(&both[right[i]], &box[i]);
        size[right[i]]++;
    }
    if (size[0] == 0 || size[1] == 0)
        return INFINITY;
    double cost = 0;
    for (int s = 0; s < 2; s++) {
        double e[3];
        for (int k = 0; k < 3; k++)
            e[k] = (double)both[s].hi[k] - (double)both[s].lo[k];
        cost += size[s] * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
    }
    return cost;
}

/* The least cost at 15 planes an axis, 1/16 of the middles' extent apart. What lies on a plane to
 * within rounding may go to either side, so these are left out of the count of planes. */
static double least_cost(const struct box *box, uint32_t count, bool *right)
{
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            low = fmin(low, (double)middle_of(&box[i], axis));
            high = fmax(high, (double)middle_of(&box[i], axis));
        }
        for (int plane = 1; plane < SLABS && high > low; plane++) {
            double at = low + (high - low) * plane / SLABS, gap = INFINITY;
            for (uint32_t i = 0; i < count; i++) {
                right[i] = (double)middle_of(&box[i], axis) > at;
                gap = fmin(gap, fabs((double)middle_of(&box[i], axis) - at));
            }
            if (gap > 1e-9 * (high - low))
                least = fmin(least, cost_of(box, right, count));
        }
    }
    return least;
}

/* Whether the middles of the first `left` lie below those of the others on an axis. */
static bool is_below(const struct box *box, uint32_t count, uint32_t left)
{
    bool below = false;
    for (int axis = 0; axis < 3; axis++) {
        float low = -INFINITY, high = INFINITY;
        for (uint32_t i = 0; i < left; i++)
            low = fmaxf(low, middle_of(&box[i], axis));
        for (uint32_t i = left; i < count; i++)
            high = fminf(high, middle_of(&box[i], axis));
        below = below || low < high;
    }
    return below;
}

/* The root's split costs what the cheapest one does; the lower side is the first child. */
static void the_cheapest_split_is_taken(void **state)
{
    (void)state;
    enum { TRIS = 400 };
    struct rng rng = rng_make(72, 0);
    static struct box box[TRIS];
    static bool right[TRIS];
    for (uint32_t round = 0; round < 120; round++) {
        uint32_t count = EARLY_MOST + 1 + rng_below(&rng, TRIS - EARLY_MOST - 1);
        struct scene scene = draw_scene(&rng, count, round % 3 == 2 ? 4 : round % 3);
        struct tree tree = make(&scene);
        const struct tree_node *root = tree.node;
        for (uint32_t i = 0; i < count; i++)
            box[i] = scene_tri_bounds(&scene, tree.order[i]);
        double least = least_cost(box, count, right);
        struct tree_seen seen = {&scene, &tree, TREE_LEAF, alloc_zeroed(tree.node_count, 4)};
        uint32_t left = below_of(&seen, 0, 0).count;
        for (uint32_t i = 0; i < count; i++)
            right[i] = i >= left;
        double cost = cost_of(box, right, count);
        assert_true(is_below(box, count, left));
        if (!(cost <= least * (1 + 1e-12)) || root->count[0] + root->count[1] > 2 * TREE_LEAF)
            fail_msg("round %u: %u of %u at the left cost %a, another split %a", round, left, count,
                     cost, least);
        free(seen.nodes);
        tree_free(&tree);
        scene_free(&scene);
    }
}

/* The triangles first .. first + count - 1 of the tree's order, as a scene. */
static struct scene part_of(const struct scene *scene, const struct tree *tree, uint32_t first,
                            uint32_t count)
{
    struct scene out;
    assert_int_equal(scene_make(3 * count, count, &out), STATUS_OK);
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, tree->order[first + i], v);
        memcpy(out.vertex + 9 * (size_t)i, v, sizeof v);
        for (uint32_t c = 0; c < 3; c++)
            out.index[3 * i + c] = 3 * i + c;
    }
    return out;
}

/* Two nodes hold as many triangles in the same boxes, all the way down. */
static void expect_alike(const struct tree *a, uint32_t x, const struct tree *b, uint32_t y)
{
    const struct tree_node *p = &a->node[x], *q = &b->node[y];
    assert_memory_equal(p->lo, q->lo, sizeof p->lo);
    assert_memory_equal(p->hi, q->hi, sizeof p->hi);
    assert_memory_equal(p->count, q->count, sizeof p->count);
    for (int side = 0; side < 2; side++)
        if (p->count[side] == 0)
            expect_alike(a, p->child[side], b, q->child[side]);
}

/* A part that is split further depends on its own triangles alone, not on what is beside it. */
static void a_part_is_split_as_if_alone(void **state)
{
    (void)state;
    struct rng rng = rng_make(73, 0);
    uint32_t parts = 0;
    for (uint32_t round = 0; round < 30; round++) {
        struct scene scene = draw_scene(&rng, 1000, round % 3);
        struct tree tree = make(&scene);
        struct tree_seen seen = {&scene, &tree, TREE_LEAF, alloc_zeroed(tree.node_count, 4)};
        for (uint32_t n = 0; n < tree.node_count; n++)
            for (int side = 0; side < 2; side++) {
                struct below below = below_of(&seen, n, side);
                if (below.count <= EARLY_MOST || tree.node[n].count[side])
                    continue;
                struct scene part = part_of(&scene, &tree, below.first, below.count);
                struct tree alone = make(&part);
                expect_alike(&tree, tree.node[n].child[side], &alone, 0);
                tree_free(&alone);
                scene_free(&part);
                parts++;
            }
        free(seen.nodes);
        tree_free(&tree);
        scene_free(&scene);
    }
    assert_true(parts > 200);
}

/* The larger and the smaller of two numbers are the same in either order. */
static void order_does_not_matter_to_the_larger(void **state)
{
    (void)state;
    static const double x[] = {-INFINITY, -1, -0x1p-1074, 0, 0x1p-1074, 1, 1.5, INFINITY};
    for (size_t i = 0; i < ARRAY_COUNT(x); i++)
        for (size_t j = 0; j < ARRAY_COUNT(x); j++) {
            assert_true(tree_max(x[i], x[j]) == x[i > j ? i : j]);
            assert_true(tree_min(x[i], x[j]) == x[i < j ? i : j]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_is_in_one_place_and_bounded),
        cmocka_unit_test(uneven_scenes_do_not_get_too_deep),
        cmocka_unit_test(the_cheapest_split_is_taken),
        cmocka_unit_test(order_does_not_matter_to_the_larger),
        cmocka_unit_test(a_part_is_split_as_if_alone),
    };
    return cmocka_run_group_tests_name("oracle_tree", tests, NULL, NULL);
}
