/* The trees of the builders, node by node, against slow ones that follow what is published: every
 * position is tried anew, every code is made bit by bit, every cluster looks at all neighbours. */
#include "ref/tree/bvh.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/base/slow_tree.h"

struct slow_grower {
    struct slow_tree tree;
    const struct scene *scene;
    uint32_t leaf, depth;
    bool deep; /* the rule would exceed the depth of 60 */
    /* Orders the items and returns how many are in front; 0: a leaf. */
    uint32_t (*split)(const struct slow_grower *grower, struct slow_item *item, uint32_t count);
};

/* No tree is deeper than 60, whatever its rule says: then halves take its place. */
static bool too_deep(const struct slow_grower *g, uint32_t left, uint32_t count)
{
    uint32_t more = 0, larger = left > count - left ? left : count - left;
    while ((1u << more) < larger)
        more++;
    return left > 0 && g->depth + 1 + more > 60;
}

static void slow_grow(struct slow_grower *g, struct slow_item *item, uint32_t count)
{
    uint32_t left = count > 1 ? g->split(g, item, count) : 0;
    g->deep = g->deep || too_deep(g, left, count);
    if (left == 0) {
        uint32_t prim[64];
        assert_true(count <= 64);
        for (uint32_t i = 0; i < count; i++)
            prim[i] = item[i].prim;
        slow_leaf(&g->tree, prim, count);
        return;
    }
    uint32_t node = slow_open(&g->tree);
    g->depth++;
    g->tree.node[node].fst = g->tree.nodes;
    slow_grow(g, item, left);
    g->tree.node[node].snd = g->tree.nodes;
    slow_grow(g, item + left, count - left);
    g->depth--;
}

static int by_key(const void *left, const void *right)
{
    const struct slow_item *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->prim < b->prim ? -1 : a->prim > b->prim;
}

static struct box bounds(const struct slow_item *item, uint32_t count)
{
    struct box all = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box_add_box(&all, &item[i].box);
    return all;
}

/* The three sides, the longest of which is `most`. */
static float sides(const struct box *box, float side[3])
{
    float most = 0;
    for (int k = 0; k < 3; k++) {
        side[k] = 0.5f * box->hi[k] - 0.5f * box->lo[k];
        most = fmaxf(most, side[k]);
    }
    return most;
}

/* Relative to the length `of`. */
static float area(const struct box *box, float of)
{
    float side[3], unit = fminf(1 / of, FLT_MAX);
    (void)sides(box, side);
    for (int k = 0; k < 3; k++)
        side[k] *= unit;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* --- median ----------------------------------------------------------------------------------- */

static uint32_t split_median(const struct slow_grower *g, struct slow_item *item, uint32_t count)
{
    struct slow_item behind[512];
    struct box box = bounds(item, count);
    uint32_t left = 0, right = 0;
    int axis = 0;
    if (count <= g->leaf)
        return 0;
    for (int k = 1; k < 3; k++)
        if (box.hi[k] - box.lo[k] > box.hi[axis] - box.lo[axis])
            axis = k;
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(g->scene, item[i].prim, v);
        double sum = (double)v[0][axis] + (double)v[1][axis] + (double)v[2][axis];
        item[i].key = (double)(float)(sum / 3);
        item[i].code = i;
    }
    double middle = ((double)box.lo[axis] + (double)box.hi[axis]) / 2;
    struct slow_item sorted[512];
    for (uint32_t i = 0; i < count; i++)
        left += item[i].key <= middle;
    bool halves = left == 0 || left == count || too_deep(g, left, count);
    memcpy(sorted, item, count * sizeof *item);
    qsort(sorted, count, sizeof *sorted, by_key); /* indices rise within equal centroids */
    left = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool front = item[i].key <= middle;
        if (halves) {
            front = false;
            for (uint32_t k = 0; k < count / 2; k++)
                front = front || sorted[k].prim == item[i].prim;
        }
        if (front)
            item[left++] = item[i];
        else
            behind[right++] = item[i];
    }
    memcpy(item + left, behind, right * sizeof *item);
    return left;
}

/* --- sah_sweep -------------------------------------------------------------------------------- */

static void sort_axis(struct slow_item *item, uint32_t count, int axis)
{
    for (uint32_t i = 0; i < count; i++)
        item[i].key = (double)slow_centre(&item[i], axis);
    qsort(item, count, sizeof *item, by_key);
}

static uint32_t split_sweep(const struct slow_grower *g, struct slow_item *item, uint32_t count)
{
    struct box all = bounds(item, count);
    float side[3], most = sides(&all, side);
    float best = count <= g->leaf ? area(&all, most) * ((float)count - 1) : INFINITY;
    uint32_t left = 0;
    int longest = side[1] > side[0] ? 1 : 0, axis = 0;
    bool point = true;
    longest = side[2] > side[longest] ? 2 : longest;
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 1; i < count; i++)
            point = point && slow_centre(&item[i], k) == slow_centre(&item[0], k);
    for (int k = 0; k < 3 && !point; k++) {
        sort_axis(item, count, k);
        for (uint32_t i = 1; i < count; i++) {
            struct box fst = bounds(item, i), snd = bounds(item + i, count - i);
            float above = area(&snd, most) * (float)(count - i);
            float cost = area(&fst, most) * (float)i + above;
            if (cost < best) {
                best = cost;
                left = i;
                axis = k;
            }
        }
    }
    if (point && count > g->leaf) {
        left = count / 2;
        axis = longest;
    }
    sort_axis(item, count, left ? axis : 0);
    return left;
}

/* --- lbvh ------------------------------------------------------------------------------------- */

static uint32_t split_lbvh(const struct slow_grower *g, struct slow_item *item, uint32_t count)
{
    uint32_t left = 1;
    if (count <= g->leaf)
        return 0;
    uint64_t differ = item[0].code ^ item[count - 1].code;
    while (differ & (differ - 1))
        differ &= differ - 1;
    while (!(item[left].code & differ))
        left++;
    return too_deep(g, left, count) ? count / 2 : left;
}

/* --- each against its builder ----------------------------------------------------------------- */

/* Returns whether they could be compared. */
static bool grown_alike(const char *name, const struct scene *scene, uint32_t leaf,
                        uint32_t (*split)(const struct slow_grower *, struct slow_item *, uint32_t))
{
    struct slow_grower g = {.scene = scene, .leaf = leaf, .split = split};
    struct slow_item *item = slow_items(scene);
    const struct build_options options = {.leaf = leaf};
    struct bvh bvh;
    assert_int_equal(builder_find(name)->build(scene, &options, &bvh, NULL), STATUS_OK);
    g.tree = slow_room(scene->tri_count);
    if (split == split_lbvh)
        (void)slow_codes(item, scene->tri_count);
    slow_grow(&g, item, scene->tri_count);
    /* Otherwise the sweep halves an order that its rejected cut has changed. */
    if (!g.deep)
        slow_compare(&g.tree, &bvh, scene, name);
    slow_free(&g.tree);
    free(item);
    bvh_free(&bvh);
    return !g.deep;
}

static void grown_as(const char *name,
                     uint32_t (*split)(const struct slow_grower *, struct slow_item *, uint32_t))
{
    static const uint32_t spans[] = {1, 2, 5, 40, 5000}, sizes[] = {1, 2, 9};
    uint32_t compared = 0;
    for (uint32_t count = 1; count <= 400; count += 1 + count / 3)
        for (size_t s = 0; s < ARRAY_COUNT(spans) * ARRAY_COUNT(sizes); s++)
            for (uint32_t leaf = 1; leaf <= 4; leaf += leaf) {
                struct scene scene = slow_scene(count, spans[s / 3], sizes[s % 3], s);
                compared += grown_alike(name, &scene, leaf, split);
                scene_free(&scene);
            }
    assert_in_range(compared, 600, 1000);
}

static void median_is_the_slow_one(void **state)
{
    (void)state;
    grown_as("median", split_median);
}

static void sweep_is_the_slow_one(void **state)
{
    (void)state;
    grown_as("sah_sweep", split_sweep);
}

static void codes_are_the_slow_ones(void **state)
{
    (void)state;
    grown_as("lbvh", split_lbvh);
}

static void place(struct scene *scene, uint32_t tri, float x, float y, float z)
{
    const float at[3] = {x, y, z};
    for (uint32_t c = 0; c < 9; c++)
        scene->vertex[9 * (size_t)tri + c] = at[c % 3];
}

/* Points of which each has another highest bit, and many that have none: 57 bits of codes are a
 * chain, below which there is no room for all others. */
static void codes_that_are_a_chain_are_halved(void **state)
{
    (void)state;
    for (uint32_t equal = 1; equal <= 64; equal += equal) {
        struct scene scene = trees_grid(58 + equal);
        for (uint32_t i = 0; i < 57; i++) {
            float at[3] = {0, 0, 0};
            at[i % 3] = (float)(1u << (i / 3));
            place(&scene, i, at[0], at[1], at[2]);
        }
        place(&scene, 57, 1u << 19, 1u << 19, 1u << 19);
        for (uint32_t i = 58; i < scene.tri_count; i++)
            place(&scene, i, 0, 0, 0);
        for (uint32_t leaf = 1; leaf <= 4; leaf++)
            assert_true(grown_alike("lbvh", &scene, leaf, split_lbvh));
        scene_free(&scene);
    }
}

/* All coordinates times a power of two: the same trees at any scale, also if they are optimized. */
static void scale_changes_no_tree(void **state)
{
    static const float by[] = {0x1p-90f, 0x1p-40f, 2, 0x1p100f};
    (void)state;
    for (size_t b = 0; builders_all[b]; b++)
        for (uint32_t k = 0; k < 2 * ARRAY_COUNT(by) && !builders_all[b]->faithful; k++) {
            struct scene scene = slow_scene(300, 50, 9, b);
            const struct build_options options = {.leaf = 2, .passes = k % 2};
            struct bvh plain, scaled;
            assert_int_equal(bvh_build(builders_all[b], &scene, &options, &plain, NULL), 0);
            for (size_t i = 0; i < 3 * (size_t)scene.vertex_count; i++)
                scene.vertex[i] *= by[k / 2];
            assert_int_equal(bvh_build(builders_all[b], &scene, &options, &scaled, NULL), 0);
            assert_int_equal(plain.node_count, scaled.node_count);
            assert_int_equal(plain.prim_count, scaled.prim_count);
            assert_memory_equal(plain.prim, scaled.prim, plain.prim_count * sizeof *plain.prim);
            for (uint32_t i = 0; i < plain.node_count; i++) {
                const struct bvh_node *one = &plain.node[i], *other = &scaled.node[i];
                assert_true(one->fst == other->fst && one->snd == other->snd &&
                            one->item_first == other->item_first &&
                            one->item_count == other->item_count);
            }
            bvh_free(&plain);
            bvh_free(&scaled);
            scene_free(&scene);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_is_the_slow_one),
        cmocka_unit_test(sweep_is_the_slow_one),
        cmocka_unit_test(codes_are_the_slow_ones),
        cmocka_unit_test(codes_that_are_a_chain_are_halved),
        cmocka_unit_test(scale_changes_no_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
