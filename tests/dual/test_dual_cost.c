/* Where a dual-split tree has a plane: by the rule, computed anew. */
#include "ref/dual/dual.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdio.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/dual/dual_fixture.h"

struct dual_cost {
    struct box box;
    double cost;
};

static double area(const struct box *box)
{
    double side[3];
    for (int k = 0; k < 3; k++) {
        side[k] = (double)box->hi[k] - (double)box->lo[k];
        if (side[k] < 0)
            return 0;
    }
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* The best side to carve from `in`, alone; 6: none is loose. */
static uint32_t best_side(const struct box *in, const struct box *own)
{
    uint32_t best = 6;
    double least = 0;
    for (uint32_t side = 0; side < 6; side++) {
        struct box cut = dual_cut(*in, side, dual_bound(own, side));
        if (dual_bound(in, side) == dual_bound(own, side) || (best < 6 && area(&cut) >= least))
            continue;
        best = side;
        least = area(&cut);
    }
    return best;
}

static bool is_worth(double cost, const struct box *in, const struct box *cut, double doubt)
{
    return 15 * area(in) + cost * area(cut) < cost * area(in) * (1 + doubt);
}

/* A carving takes the best side, then the best one beside it, and only where it is worth it; where
 * none stands it would not be. */
static void must_be_the_rule(const struct dual_cost *own, const struct dual_seen *seen,
                             const struct box *in)
{
    uint32_t first = best_side(in, &own->box);
    struct box cut = *in;
    if (first < 6) {
        cut = dual_cut(cut, first, dual_bound(&own->box, first));
        uint32_t second = best_side(&cut, &own->box);
        second = second < 6 ? second : first;
        cut = dual_cut(cut, second, dual_bound(&own->box, second));
        if (seen->kind == DUAL_IS_CARVE) {
            assert_int_equal(seen->side[0], first);
            assert_int_equal(seen->side[1], second);
        }
    }
    if (seen->kind == DUAL_IS_CARVE)
        assert_true(first < 6 && is_worth(own->cost, in, &cut, 1e-9));
    else
        assert_false(first < 6 && is_worth(own->cost, in, &cut, -1e-9));
}

static double child_work(const struct dual_cost *child, const struct box *in)
{
    double all = child->cost * area(in);
    return fmin(all, 15 * area(in) + child->cost * area(&child->box));
}

/* No axis and order of two children is expected to cost less. */
static void must_be_cheapest(const struct dual_cost child[2], uint32_t axis, const struct box *in)
{
    double chosen = 0, least = INFINITY;
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t low = 0; low < 2; low++) {
            struct box below = *in, above = *in;
            below.hi[k] = child[low].box.hi[k];
            above.lo[k] = child[1 - low].box.lo[k];
            double work = child_work(&child[low], &below) + child_work(&child[1 - low], &above);
            least = fmin(least, work);
            chosen = k == axis && low == 0 ? work : chosen;
        }
    assert_true(chosen <= least * (1 + 1e-9));
}

/* What a node costs, without its carvings. */
static struct dual_cost cost_of(const struct dual_stand *s, uint32_t at)
{
    struct dual_seen seen = dual_look(&s->tree, at);
    struct dual_cost own = {.box = box_empty()};
    while (seen.kind == DUAL_IS_CARVE)
        seen = dual_look(&s->tree, seen.next);
    if (seen.kind == DUAL_IS_LEAF) {
        for (uint32_t i = 0; i < s->bvh.node_count; i++)
            if (s->bvh.node[i].item_count > 0 && s->bvh.node[i].item_first == seen.first)
                own.box = s->bvh.node[i].bounds;
        own.cost = 20 * (double)seen.count;
        return own;
    }
    struct dual_cost child[2] = {cost_of(s, seen.at + 3), cost_of(s, seen.next)};
    double below = 0;
    for (int c = 0; c < 2; c++)
        box_add_box(&own.box, &child[c].box);
    for (int c = 0; c < 2; c++)
        below += area(&own.box) > 0 ? child[c].cost * area(&child[c].box) / area(&own.box)
                                    : child[c].cost;
    own.cost = 15 + below;
    return own;
}

static void look_at_costs(const struct dual_stand *s, uint32_t at, struct box in)
{
    struct dual_seen seen = dual_look(&s->tree, at);
    const struct dual_cost own = cost_of(s, at);
    must_be_the_rule(&own, &seen, &in);
    if (seen.kind == DUAL_IS_CARVE) {
        in = dual_cut(in, seen.side[0], seen.plane[0]);
        look_at_costs(s, seen.next, dual_cut(in, seen.side[1], seen.plane[1]));
    } else if (seen.kind == DUAL_IS_SPLIT) {
        const struct dual_cost child[2] = {cost_of(s, at + 3), cost_of(s, seen.next)};
        must_be_cheapest(child, seen.side[1], &in);
        look_at_costs(s, at + 3, dual_cut(in, seen.side[0], seen.plane[0]));
        look_at_costs(s, seen.next, dual_cut(in, seen.side[1], seen.plane[1]));
    }
}

static void planes_are_chosen_by_the_rule(void **state)
{
    (void)state;
    static const char *const spec[] = {"sphere:n=6", "needles:n=120", "soup:n=150", "cornell"};
    uint32_t carved = 0, splits = 0;
    for (size_t i = 0; i < ARRAY_COUNT(spec); i++) {
        struct dual_stand s = {.what = spec[i]};
        struct scene scene;
        assert_int_equal(scene_open(spec[i], 2, &scene, NULL), STATUS_OK);
        dual_stand_of(&s, scene, "sah_binned", DUAL_BY_COST);
        look_at_costs(&s, 0, s.tree.box);
        carved += s.tree.carve_count;
        splits += s.tree.split_count;
        dual_stand_free(&s);
    }
    assert_in_range(carved, splits / 10, splits); /* so that the rule says both */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_are_chosen_by_the_rule),
    };
    return cmocka_run_group_tests_name("dual_cost", tests, NULL, NULL);
}
