/* Which leaves a walk of the oracle's trees visits (ref/oracle/tree_walk.h, placed_walk.h), of
 * whole numbers and their quotients: exactly those whose box a point of the ray, or of a ray within
 * the errors, is in at a t of the range, borders included; each once, the nearer of two first. */
#include "ref/base/rng.h"
#include "ref/oracle/placed_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define BOXES 24

/* Boxes of whole numbers, `size` wide at most. */
static struct tree draw_tree(struct rng *rng, uint32_t count, uint32_t leaf, uint32_t size)
{
    struct oracle_part part[BOXES];
    struct tree tree;
    struct reason reason = {""};
    for (uint32_t i = 0; i < count; i++) {
        part[i].prim = i;
        for (int k = 0; k < 3; k++) {
            part[i].box.lo[k] = (float)rng_below(rng, 9) - 4;
            part[i].box.hi[k] = part[i].box.lo[k] + (float)rng_below(rng, size);
            part[i].middle[k] = 0.5f * (part[i].box.lo[k] + part[i].box.hi[k]);
        }
    }
    assert_int_equal(tree_make_parts(part, count, leaf, &tree, &reason), STATUS_OK);
    return tree;
}

/* t of a ray in a box, by two conditions an axis: t * speed is at least, or at most, a number. */
struct t_span {
    long double near, far;
};

static void at_least(struct t_span *span, long double number, long double speed)
{
    if (speed > 0)
        span->near = fmaxl(span->near, number / speed);
    else if (speed < 0)
        span->far = fminl(span->far, number / speed);
    else if (number > 0)
        span->far = -INFINITY;
}

static void at_most(struct t_span *span, long double number, long double speed)
{
    at_least(span, -number, -speed);
}

static bool meets(const struct t_span *span, double tmin, double reach)
{
    return span->near <= span->far && span->near <= (long double)reach &&
           span->far >= (long double)tmin;
}

struct boxed_ray {
    double o[3], d[3], o_err[3], d_err[3];
    long double least; /* t */
};

static struct t_span span_of(const struct boxed_ray *ray, const struct tree_node *node, int side)
{
    struct t_span span = {ray->least, INFINITY};
    for (int k = 0; k < 3; k++) {
        at_least(&span, (long double)node->lo[k][side] - (ray->o[k] + ray->o_err[k]),
                 ray->d[k] + ray->d_err[k]);
        at_most(&span, (long double)node->hi[k][side] - (ray->o[k] - ray->o_err[k]),
                ray->d[k] - ray->d_err[k]);
    }
    return span;
}

/* A leaf of a tree by its number in `child`; its node and side. */
static const struct tree_node *leaf_at(const struct tree *tree, uint32_t first, int *side)
{
    for (uint32_t n = 0; n < tree->node_count; n++)
        for (*side = 0; *side < 2; ++*side)
            if (tree->node[n].count[*side] && tree->node[n].child[*side] == first)
                return &tree->node[n];
    fail_msg("no leaf begins with %u", first);
    return NULL;
}

static void expect_leaf(const struct tree *tree, const struct boxed_ray *ray,
                        const struct tree_leaf *leaf, double tmin, double reach)
{
    int side;
    const struct tree_node *node = leaf_at(tree, leaf->first, &side);
    struct t_span span = span_of(ray, node, side);
    double largest = 0;
    assert_int_equal(leaf->count, node->count[side]);
    assert_true(meets(&span, tmin, reach));
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fmax(fabs((double)node->lo[k][side] - ray->o[k]),
                                     fabs((double)node->hi[k][side] - ray->o[k])));
    assert_true(leaf->largest == largest);
}

/* Either kind of walk. */
struct any_walk {
    bool placed;
    struct tree_walk plain;
    struct placed_walk walk;
};

static bool next(struct any_walk *any, double reach, struct tree_leaf *leaf)
{
    return any->placed ? placed_walk_next(&any->walk, reach, leaf)
                       : tree_walk_next(&any->plain, reach, leaf);
}

/* Walks; from one leaf to the next the reach is lowered to `later`. */
static uint32_t expect_walk(struct any_walk *any, const struct tree *tree,
                            const struct boxed_ray *ray, double tmin, double reach, double later)
{
    bool seen[BOXES] = {false};
    struct tree_leaf leaf;
    uint32_t visited = 0;
    double now = reach;
    while (next(any, now, &leaf)) {
        expect_leaf(tree, ray, &leaf, tmin, now);
        assert_false(seen[leaf.first]);
        seen[leaf.first] = true;
        now = later;
        visited++;
    }
    assert_false(next(any, now, &leaf));
    for (uint32_t n = 0; n < tree->node_count; n++)
        for (int side = 0; side < 2; side++)
            if (tree->node[n].count[side]) {
                struct t_span span = span_of(ray, &tree->node[n], side);
                if (meets(&span, tmin, later < reach ? later : reach))
                    assert_true(seen[tree->node[n].child[side]]);
            }
    return visited;
}

static const double stops[] = {0, 0.5, 1, 1.5, 2, 3, 5, 8, INFINITY};

static double draw_stop(struct rng *rng)
{
    return stops[rng_below(rng, ARRAY_COUNT(stops))];
}

static double draw_eighth(struct rng *rng, uint32_t most)
{
    return rng_below(rng, 3) ? 0.125 * (double)rng_below(rng, most + 1) : 0;
}

static void rays_visit_what_they_meet(void **state)
{
    (void)state;
    struct rng rng = rng_make(54, 0);
    uint32_t visited = 0, none = 0;
    for (uint32_t round = 0; round < 20000; round++) {
        const uint32_t leaf = 1 + rng_below(&rng, 4);
        struct tree tree = draw_tree(&rng, 1 + rng_below(&rng, BOXES), leaf, 4);
        struct boxed_ray ray = {.least = -INFINITY};
        struct ray given = {.tmin = -(float)rng_below(&rng, 9)};
        bool any = false;
        for (int k = 0; k < 3; k++) {
            given.org[k] = (float)rng_below(&rng, 13) - 6;
            given.dir[k] = rng_below(&rng, 3) ? (float)rng_below(&rng, 9) - 4 - given.org[k] : 0;
            ray.o[k] = (double)given.org[k];
            ray.d[k] = (double)given.dir[k];
            any = any || ray.d[k] != 0;
        }
        if (rng_below(&rng, 2))
            given.tmin = (float)(draw_stop(&rng) - 2);
        given.tmin = given.tmin < 9 ? given.tmin : 0;
        given.tmax = (float)fmax(draw_stop(&rng), (double)given.tmin);
        if (any) {
            struct any_walk walk = {.placed = false};
            const double later = fmin((double)given.tmax, draw_stop(&rng));
            tree_walk_start(&walk.plain, &tree, &given);
            uint32_t met = expect_walk(&walk, &tree, &ray, (double)given.tmin, (double)given.tmax,
                                       rng_below(&rng, 2) ? (double)given.tmax : later);
            visited += met;
            none += met == 0;
        }
        tree_free(&tree);
    }
    print_message("%u leaves, %u rays that meet none\n", visited, none);
    assert_true(visited > 10000 && none > 1000);
}

static void rays_within_errors_visit_what_they_may_meet(void **state)
{
    (void)state;
    struct rng rng = rng_make(55, 0);
    uint32_t visited = 0, none = 0;
    for (uint32_t round = 0; round < 30000; round++) {
        const uint32_t leaf = 1 + rng_below(&rng, 4);
        struct tree tree = draw_tree(&rng, 1 + rng_below(&rng, BOXES), leaf, 4);
        struct boxed_ray ray = {.least = 0};
        struct sight sight;
        struct any_walk walk = {.placed = true};
        const bool back = rng_below(&rng, 2);
        for (int k = 0; k < 3; k++) {
            ray.o[k] = sight.o[k] = (double)rng_below(&rng, 13) - 6;
            ray.d[k] = rng_below(&rng, 3) ? (double)rng_below(&rng, 9) - 4 : 0;
            ray.o_err[k] = sight.o_err[k] = draw_eighth(&rng, 8);
            ray.d_err[k] = sight.d_err[k] = draw_eighth(&rng, 16);
            sight.d[k] = back ? -ray.d[k] : ray.d[k];
        }
        double tmin = draw_stop(&rng), reach = draw_stop(&rng);
        tmin = isinf(tmin) ? 0 : tmin;
        const double later = fmin(reach, draw_stop(&rng));
        placed_walk_start(&walk.walk, &tree, &sight, back, tmin, reach);
        uint32_t met =
            expect_walk(&walk, &tree, &ray, tmin, reach, rng_below(&rng, 2) ? reach : later);
        visited += met;
        none += met == 0;
        tree_free(&tree);
    }
    assert_true(visited > 10000 && none > 1000);
}

/* Of two leaves the one that is entered first is visited first, the first child if both are
 * entered at once. */
static void the_nearer_is_visited_first(void **state)
{
    (void)state;
    struct rng rng = rng_make(56, 0);
    uint32_t both = 0, equal = 0;
    for (uint32_t round = 0; round < 20000; round++) {
        struct tree tree = draw_tree(&rng, 2, 1, 12);
        struct boxed_ray ray = {.least = -INFINITY};
        struct ray given = {.tmin = -99, .tmax = 99};
        struct tree_walk walk;
        struct tree_leaf one, two;
        for (int k = 0; k < 3; k++) {
            given.org[k] = (float)rng_below(&rng, 13) - 6;
            given.dir[k] = (float)rng_below(&rng, 9) - 4 - given.org[k];
            ray.o[k] = (double)given.org[k];
            ray.d[k] = (double)given.dir[k];
        }
        given.dir[0] = (float)(ray.d[0] = ray.d[0] != 0 ? ray.d[0] : 1);
        tree_walk_start(&walk, &tree, &given);
        if (tree_walk_next(&walk, 99, &one) && tree_walk_next(&walk, 99, &two)) {
            int side;
            const struct tree_node *node = leaf_at(&tree, one.first, &side);
            long double first = span_of(&ray, node, side).near;
            long double last = span_of(&ray, node, 1 - side).near;
            assert_true(first < last || (first == last && side == 0));
            both++;
            equal += first == last;
        }
        tree_free(&tree);
    }
    print_message("%u, %u at once\n", both, equal);
    assert_true(both > 1000 && equal > 50);
}

/* A t that is too small for an enclosure is 0 or FRACTION_LEAST there: a walk up to or from these
 * visits what it may lie in. So it does where quotients that are equal are rounded apart. */
static void tiny_t_is_not_lost(void **state)
{
    (void)state;
    struct oracle_part part = {.box = {{0, -1, -1}, {1, 0, 1}}, .prim = 0};
    struct tree tree;
    struct placed_walk walk;
    struct tree_leaf leaf;
    struct reason reason = {""};
    assert_int_equal(tree_make_parts(&part, 1, 1, &tree, &reason), STATUS_OK);
    struct sight sight = {.o = {-0x1p-150, -0.5, 0}, .d = {0x1p850, 0, 0}};
    placed_walk_start(&walk, &tree, &sight, false, 0, 0);
    assert_true(placed_walk_next(&walk, 0, &leaf));
    sight = (struct sight){.o = {0.5, -0x1p-151, 0}, .d = {0, 0x1p850, 0}};
    placed_walk_start(&walk, &tree, &sight, false, FRACTION_LEAST, INFINITY);
    assert_true(placed_walk_next(&walk, INFINITY, &leaf));
    placed_walk_start(&walk, &tree, &sight, false, 0x1p-990, INFINITY);
    assert_false(placed_walk_next(&walk, INFINITY, &leaf));
    sight = (struct sight){.o = {-0x3p-225, -0x9p-225, 0}, .d = {0x1p850, 0x3p850, 0}};
    placed_walk_start(&walk, &tree, &sight, false, 0, INFINITY);
    assert_true(placed_walk_next(&walk, INFINITY, &leaf));
    tree_free(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_visit_what_they_meet),
        cmocka_unit_test(rays_within_errors_visit_what_they_may_meet),
        cmocka_unit_test(the_nearer_is_visited_first),
        cmocka_unit_test(tiny_t_is_not_lost),
    };
    return cmocka_run_group_tests_name("oracle_boxes", tests, NULL, NULL);
}
