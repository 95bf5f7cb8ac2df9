/* Moves of subtrees against slow ones: every place is tried by moving there and adding all areas
 * anew. Coordinates are small integers, so that every area and sum is exact. */
#include "ref/build/links.h"
#include "ref/builders/reinsert.h"
#include "ref/builders/spots.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/base/slow_tree.h"

#define NODES_MOST 128

/* A tree of nodes with two children or a box. */
struct slow_spots {
    uint32_t child[NODES_MOST][2], parent[NODES_MOST];
    struct box box[NODES_MOST];
    uint32_t count;
    double unit; /* areas of struct spots are scaled by the square of a power of two */
};

static struct box fit(struct slow_spots *s, uint32_t node)
{
    if (s->child[node][0] != LINKS_NONE) {
        struct box box = fit(s, s->child[node][0]), other = fit(s, s->child[node][1]);
        box_add_box(&box, &other);
        s->box[node] = box;
    }
    return s->box[node];
}

static double slow_area(const struct slow_spots *s, uint32_t node)
{
    double side[3];
    for (int k = 0; k < 3; k++)
        side[k] = ((double)s->box[node].hi[k] - (double)s->box[node].lo[k]) * s->unit;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* Of all inner nodes. */
static double cost(struct slow_spots *s)
{
    double sum = 0;
    (void)fit(s, 0);
    for (uint32_t i = 0; i < s->count; i++)
        sum += s->child[i][0] != LINKS_NONE ? slow_area(s, i) : 0;
    return sum;
}

static bool is_below(const struct slow_spots *s, uint32_t node, uint32_t top)
{
    while (node != top && node != LINKS_NONE)
        node = s->parent[node];
    return node == top;
}

/* The root and its children stay; a place below the node itself is none. */
static bool may_move(const struct slow_spots *s, uint32_t node, uint32_t target)
{
    return node != 0 && s->parent[node] != 0 && target != 0 && target != s->parent[node] &&
           !is_below(s, target, node);
}

static void replace(struct slow_spots *s, uint32_t parent, uint32_t old, uint32_t by)
{
    s->child[parent][s->child[parent][1] == old] = by;
    s->parent[by] = parent;
}

static struct slow_spots after(struct slow_spots s, uint32_t node, uint32_t target)
{
    uint32_t parent = s.parent[node], other = s.child[parent][s.child[parent][0] == node];
    replace(&s, s.parent[parent], parent, other);
    replace(&s, s.parent[target], target, parent);
    s.child[parent][0] = target;
    s.child[parent][1] = node;
    s.parent[target] = s.parent[node] = parent;
    return s;
}

static struct slow_spots from_bvh(const struct bvh *bvh)
{
    struct slow_spots s = {.count = bvh->node_count, .unit = 1};
    float most = 0;
    assert_true(bvh->node_count <= NODES_MOST);
    s.parent[0] = LINKS_NONE;
    for (uint32_t i = 0; i < s.count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        bool leaf = node->item_count > 0;
        s.box[i] = node->bounds;
        s.child[i][0] = leaf ? LINKS_NONE : node->fst;
        s.child[i][1] = leaf ? LINKS_NONE : node->snd;
        if (!leaf)
            s.parent[node->fst] = s.parent[node->snd] = i;
    }
    for (int k = 0; k < 3; k++)
        most = fmaxf(most, bvh->node[0].bounds.hi[k]);
    while (most * (float)s.unit >= 1)
        s.unit /= 2;
    return s;
}

/* The same tree; children may have changed places. */
static void same_tree(struct slow_spots *want, const struct spots *got, bool in_order)
{
    (void)fit(want, 0);
    for (uint32_t i = 0; i < want->count; i++) {
        const struct spot *spot = &got->spot[i];
        bool swapped = !in_order && spot->child[0] != want->child[i][0];
        assert_int_equal(spot->parent, want->parent[i]);
        assert_int_equal(spot->child[swapped], want->child[i][0]);
        assert_int_equal(spot->child[!swapped], want->child[i][1]);
        for (int k = 0; k < 3; k++) {
            assert_true((double)spot->box.lo[k] == (double)want->box[i].lo[k] * want->unit);
            assert_true((double)spot->box.hi[k] == (double)want->box[i].hi[k] * want->unit);
        }
        assert_true((double)spot->area == slow_area(want, i));
    }
}

/* Trees of all shapes: of equal halves or chains, of triangles in random places. */
static struct bvh tree_of(const struct scene *scene, uint32_t leaf, uint64_t seed)
{
    struct bvh bvh = trees_make(scene, leaf, (enum trees_shape)(seed % 3));
    return bvh;
}

static struct scene scene_of(uint32_t count, uint64_t seed)
{
    static const uint32_t spans[] = {2, 4, 9, 30};
    return slow_scene(count, spans[seed % 4], 1 + (uint32_t)(seed % 5), seed);
}

/* The best place of every node is found, and what it gains is told. */
static void the_best_place_is_found(void **state)
{
    (void)state;
    uint32_t better = 0, none = 0;
    for (uint64_t seed = 0; seed < 36; seed++) {
        struct scene scene = scene_of(2 + (uint32_t)seed, seed);
        struct bvh bvh = tree_of(&scene, 1, seed);
        struct slow_spots s = from_bvh(&bvh);
        struct spots spots;
        assert_int_equal(spots_make(&bvh, &spots), STATUS_OK);
        same_tree(&s, &spots, true);
        double now = cost(&s);
        for (uint32_t node = 0; node < s.count; node++) {
            float gain = -1;
            uint32_t found = spots_seek(&spots, node, &gain);
            double best = 0, here = 0;
            for (uint32_t target = 0; target < s.count; target++) {
                if (!may_move(&s, node, target))
                    continue;
                struct slow_spots moved = after(s, node, target);
                double fall = now - cost(&moved);
                best = fall > best ? fall : best;
                here = target == found ? fall : here;
            }
            assert_true((double)gain == best && here == best);
            assert_int_equal(found == LINKS_NONE, best == 0);
            better += best > 0;
            none += best == 0;
        }
        same_tree(&s, &spots, true); /* nothing has moved */
        spots_free(&spots);
        bvh_free(&bvh);
        scene_free(&scene);
    }
    if (better < 1000 || none < 150)
        fail_msg("%u and %u nodes are too few", better, none);
}

/* Of all pairs of nodes one after the other: what lowers the cost is done, nothing else. */
static void moves_are_made_where_they_pay(void **state)
{
    (void)state;
    uint32_t made = 0, refused = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        struct scene scene = scene_of(2 + (uint32_t)seed, seed);
        struct bvh bvh = tree_of(&scene, 1, seed);
        struct slow_spots s = from_bvh(&bvh);
        struct spots spots;
        struct rng rng = rng_make(seed, 1);
        assert_int_equal(spots_make(&bvh, &spots), STATUS_OK);
        for (uint32_t i = 0; i < 40 * s.count; i++) {
            uint32_t node = 1 + rng_below(&rng, s.count - 1), target = rng_below(&rng, s.count);
            struct slow_spots moved = s;
            bool may = may_move(&s, node, target);
            if (may)
                moved = after(s, node, target);
            double fall = cost(&s) - cost(&moved);
            assert_true(spots_move(&spots, node, target) == (fall > 0 ? fall : 0));
            made += fall > 0;
            refused += may && fall <= 0;
            if (fall > 0)
                s = moved;
            same_tree(&s, &spots, false);
            for (uint32_t k = 0; k < s.count; k++)
                memcpy(s.child[k], spots.spot[k].child, sizeof s.child[k]);
            if (!may)
                same_tree(&s, &spots, true);
        }
        spots_free(&spots);
        bvh_free(&bvh);
        scene_free(&scene);
    }
    assert_true(made > 100 && refused > 1000);
}

struct wish {
    float gain;
    uint32_t node, target;
};

static int by_gain(const void *left, const void *right)
{
    const struct wish *a = left, *b = right;
    if (a->gain != b->gain)
        return a->gain > b->gain ? -1 : 1;
    return a->node < b->node ? -1 : 1;
}

/* Places are searched for every fourth node at a time; then the greatest gains come first, of equal
 * ones the lower node. Returns the fall of the cost. */
static double slow_pass(struct spots *spots)
{
    double fall = 0;
    for (uint32_t turn = 0; turn < 4; turn++) {
        struct wish wish[NODES_MOST];
        uint32_t count = 0;
        for (uint32_t i = turn; i < spots->count; i += 4) {
            wish[count] = (struct wish){.node = i};
            wish[count].target = spots_seek(spots, i, &wish[count].gain);
            count += wish[count].target != LINKS_NONE;
        }
        qsort(wish, count, sizeof *wish, by_gain);
        for (uint32_t i = 0; i < count; i++)
            fall += spots_move(spots, wish[i].node, wish[i].target);
    }
    return fall;
}

static void write_spot(struct slow_tree *tree, const struct spots *spots, const struct bvh *bvh,
                       uint32_t from)
{
    const uint32_t *child = spots->spot[from].child;
    const struct bvh_node *old = &bvh->node[from];
    if (child[0] == LINKS_NONE) {
        slow_leaf(tree, bvh->prim + old->item_first, old->item_count);
        return;
    }
    uint32_t mine = slow_open(tree);
    tree->node[mine].fst = tree->nodes;
    write_spot(tree, spots, bvh, child[0]);
    tree->node[mine].snd = tree->nodes;
    write_spot(tree, spots, bvh, child[1]);
}

/* Trees of up to 3 leaves stay as they are. */
static void passes_are_the_slow_ones(void **state)
{
    static const uint32_t passes[] = {0, 1, 2, 30};
    (void)state;
    uint32_t changed = 0;
    for (uint64_t seed = 0; seed < 60; seed++)
        for (size_t p = 0; p < ARRAY_COUNT(passes); p++) {
            struct scene scene = scene_of(1 + (uint32_t)seed, seed);
            struct bvh bvh = tree_of(&scene, 1 + seed % 2, seed);
            struct slow_tree want = slow_room(scene.tri_count);
            struct spots spots;
            assert_int_equal(spots_make(&bvh, &spots), STATUS_OK);
            double fall = 1, all = 0;
            for (uint32_t i = 0; i < passes[p] && fall > 0 && bvh.node_count >= 7; i++) {
                fall = slow_pass(&spots);
                all += fall;
            }
            write_spot(&want, &spots, &bvh, 0);
            assert_int_equal(tree_reinsert(&bvh, passes[p], 1), STATUS_OK);
            slow_compare(&want, &bvh, &scene, "reinsert");
            changed += all > 0;
            slow_free(&want);
            spots_free(&spots);
            bvh_free(&bvh);
            scene_free(&scene);
        }
    assert_true(changed > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_best_place_is_found),
        cmocka_unit_test(moves_are_made_where_they_pay),
        cmocka_unit_test(passes_are_the_slow_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
