/* What the walk of a world is made of (ref/oracle/placing.h): boxes of instances that are no wider
 * than their sums are off by, rays in the space of a mesh with their errors by the formula, the
 * tree over the instances, and the filter's limits at both ends of double; and which pairs of
 * placed triangles take integers. */
#include "ref/base/rng.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/placed_filter.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

/* --- boxes ------------------------------------------------------------------------------------ */

/* The largest float that is not above x. */
static float float_under(long double x)
{
    if (x > (long double)FLT_MAX)
        return FLT_MAX;
    if (x < -(long double)FLT_MAX)
        return -INFINITY;
    float near = (float)x;
    return (long double)near > x ? nextafterf(near, -INFINITY) : near;
}

/* The least x of a placed box along axis k, and the sum of its terms' sizes. */
static long double least_of(const float m[3][4], const struct box *box, int k, bool upper,
                            long double *size)
{
    const long double sign = upper ? -1 : 1;
    long double sum = sign * (long double)m[k][3];
    *size = fabsl(sum);
    for (int j = 0; j < 3; j++) {
        long double a = sign * (long double)m[k][j] * (long double)box->lo[j];
        long double b = sign * (long double)m[k][j] * (long double)box->hi[j];
        sum += fminl(a, b);
        *size += fmaxl(fabsl(a), fabsl(b));
    }
    return sum;
}

static void expect_box(const float m[3][4], const struct box *box)
{
    const struct box placed = placing_bounds(m, box);
    for (int k = 0; k < 3; k++)
        for (int upper = 0; upper < 2; upper++) {
            long double size, least = least_of(m, box, k, upper, &size);
            float got = upper ? -placed.hi[k] : placed.lo[k];
            assert_true((long double)got <= least);
            assert_true(got >= float_under(least - 9.5L * 0x1p-53L * size));
            assert_true(got <= float_under(least - 2.5L * 0x1p-53L * size));
        }
}

static void boxes_are_as_tight_as_their_sums(void **state)
{
    (void)state;
    for (int kind = 0; kind < WORLD_TURNS; kind++) {
        struct rng rng = far_rng((uint64_t)kind + 7);
        for (int n = 0; n < 2000; n++) {
            float m[3][4];
            struct box box;
            world_turn_draw(&world_turns[kind], &rng, m);
            for (int k = 0; k < 3; k++) {
                box.lo[k] = rng_below(&rng, 4) ? rng_range(&rng, -2, 2) : 0;
                box.hi[k] = box.lo[k] + (rng_below(&rng, 3) ? rng_float(&rng) : 0);
                m[k][3] = rng_below(&rng, 4) ? m[k][3] : 0;
            }
            expect_box((const float(*)[4])m, &box);
        }
    }
}

/* A point that is a float after all stays one: 0, and what the widening itself takes to the ends of
 * float; beyond them a box is infinite. */
static void boxes_end_where_floats_do(void **state)
{
    (void)state;
    const struct box point = {{0, 0, 0}, {0, 0, 0}}, ones = {{1, 1, 0}, {1, 1, 0}};
    const float none[3][4] = {{1, 2, 3, 0}, {4, 5, 6, 0}, {7, 8, 10, 0}};
    struct box placed = placing_bounds(none, &point);
    assert_memory_equal(&placed, &point, sizeof point);
    for (int k = 0; k < 3; k++)
        for (int upper = 0; upper < 2; upper++)
            for (int n = 0; n < 3; n++) {
                const float sign = upper ? 1 : -1;
                float m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
                m[k][0] = sign * FLT_MAX;
                m[k][1] = n == 0 ? sign * -0x1.8p77f : n == 1 ? 0 : sign * -0x1p104f;
                m[k][2] = 0;
                placed = placing_bounds((const float(*)[4])m, &ones);
                const float got = upper ? placed.hi[k] : placed.lo[k];
                assert_true(got == (n == 1 ? sign * INFINITY : sign * FLT_MAX));
                const float inner = upper ? placed.lo[k] : placed.hi[k];
                assert_true(inner * sign <= FLT_MAX && inner * sign >= 0x1.fffff0p127f);
            }
}

/* The box of an instance in the tree over them is that of the nodes four levels below its mesh's
 * root, or of leaves above, placed one by one. */
static void add_below(const struct tree *tree, uint32_t at, int levels, const float m[3][4],
                      struct box *out)
{
    for (int side = 0; side < 2; side++) {
        const struct tree_node *node = &tree->node[at];
        struct box box;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = node->lo[k][side];
            box.hi[k] = node->hi[k][side];
        }
        if (node->count[side] == 0 && node->child[side] == 0)
            continue;
        if (levels > 0 && node->count[side] == 0) {
            add_below(tree, node->child[side], levels - 1, m, out);
            continue;
        }
        box = placing_bounds(m, &box);
        box_add_box(out, &box);
    }
}

static void draw_world(struct rng *rng, uint32_t tris, uint32_t count, struct scene *scene,
                       struct world *world)
{
    assert_int_equal(scene_make(3 * tris, tris, scene), STATUS_OK);
    for (uint32_t i = 0; i < 9 * tris; i++)
        scene->vertex[i] = rng_range(rng, -1, 1) + 4 * (float)(i / 9 % 7);
    for (uint32_t i = 0; i < 3 * tris; i++)
        scene->index[i] = i;
    assert_int_equal(world_of_scene(scene, world, &reason), STATUS_OK);
    const struct instance one = world->instance[0];
    free(world->instance);
    world->instance = alloc_zeroed(count, sizeof one);
    world->instance_count = count;
    for (uint32_t i = 0; i < count; i++) {
        world->instance[i] = one;
        world->instance[i].mask = rng_below(rng, 5) ? 1u : 0;
        if (rng_below(rng, 8))
            world_turn_draw(&world_turns[i % 2 ? 2 : 10 + i % 4], rng, world->instance[i].m);
    }
    assert_int_equal(world_finish(world, &reason), STATUS_OK);
}

static void instances_are_bounded_by_the_parts_of_their_meshes(void **state)
{
    (void)state;
    enum { COUNT = 30 };
    struct rng rng = rng_make(58, 0);
    static const uint32_t tris[] = {1, 4, 64, 65, 100, 1000};
    uint32_t found = 0;
    for (size_t s = 0; s < ARRAY_COUNT(tris); s++) {
        struct scene scene;
        struct world world;
        struct oracle *oracle;
        uint32_t active = 0, here = 0;
        draw_world(&rng, tris[s], COUNT, &scene, &world);
        assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
        const struct placing *placing = oracle->placing;
        for (uint32_t i = 0; i < COUNT; i++)
            active += world.instance[i].mask != 0;
        for (uint32_t n = 0; n < placing->top.node_count; n++)
            for (int side = 0; side < 2; side++) {
                const struct tree_node *node = &placing->top.node[n];
                if (node->count[side] == 0)
                    continue;
                assert_int_equal(node->count[side], 1);
                const uint32_t at = placing->top.order[node->child[side]];
                struct box box = box_empty();
                add_below(&placing->mesh[0]->tree, 0, 3, world.instance[at].m, &box);
                assert_int_not_equal(world.instance[at].mask, 0);
                for (int k = 0; k < 3; k++) {
                    assert_true(node->lo[k][side] == box.lo[k]);
                    assert_true(node->hi[k][side] == box.hi[k]);
                }
                here++;
            }
        assert_int_equal(here, active);
        for (uint32_t i = 0; i < COUNT; i++) {
            const bool identity = instance_is_identity(&world.instance[i]);
            assert_int_equal(placing->inverse[i].identity, identity);
            assert_int_equal(placing->inverse[i].det_sign,
                             identity ? 1 : instance_det_sign(world.instance[i].m));
        }
        found += here;
        oracle_free(oracle);
        world_free(&world);
        scene_free(&scene);
    }
    assert_true(found > 100);
}

/* --- rays ------------------------------------------------------------------------------------- */

static void rays_have_the_errors_of_their_sums(void **state)
{
    (void)state;
    struct rng rng = rng_make(59, 0);
    for (int n = 0; n < 5000; n++) {
        struct inverse inverse;
        struct instance instance = {.mask = 1};
        struct ray ray = {.tmax = 1};
        struct sight sight;
        for (int i = 0; i < 9; i++)
            inverse.w[i / 3][i % 3] = rng_below(&rng, 4) ? (double)rng_range(&rng, -1, 1) : 0;
        for (int k = 0; k < 3; k++) {
            instance.m[k][3] = rng_range(&rng, -1, 1);
            ray.org[k] = rng_below(&rng, 4) ? rng_range(&rng, -1, 1) : instance.m[k][3];
            ray.dir[k] = rng_below(&rng, 4) ? rng_range(&rng, -1, 1) : 0;
        }
        sight_make(&inverse, &instance, &ray, &sight);
        for (int i = 0; i < 3; i++) {
            long double o = 0, d = 0, o_size = 0, d_size = 0;
            for (int j = 0; j < 3; j++) {
                const long double w = inverse.w[i][j], to = ray.dir[j];
                const long double from = (long double)ray.org[j] - (long double)instance.m[j][3];
                o += w * from;
                d += w * to;
                o_size += fabsl(w * from);
                d_size += fabsl(w * to);
            }
            assert_true(fabsl(sight.o[i] - o) <= 4 * 0x1p-53L * o_size);
            assert_true(fabsl(sight.d[i] - d) <= 4 * 0x1p-53L * d_size);
            assert_true(fabsl(sight.o_err[i] - 0xep-53L * o_size) <= 1e-12L * 0xep-53L * o_size);
            assert_true(fabsl(sight.d_err[i] - 0xep-53L * d_size) <= 1e-12L * 0xep-53L * d_size);
        }
    }
}

/* --- the filter's limits ---------------------------------------------------------------------- */

static void quotients_stay_in_double(void **state)
{
    (void)state;
    static const struct {
        double x;
        bool moderate;
    } row[] = {{0, true},          {1, true},
               {0x1p-400, true},   {0x1.fffffffffffffp-401, false},
               {0x1p400, true},    {0x1.0000000000001p400, false},
               {0x1p-1074, false}, {DBL_MAX, false}};
    for (size_t i = 0; i < ARRAY_COUNT(row); i++)
        for (int slot = 0; slot < 5; slot++)
            for (int sign = -1; sign <= 1; sign += 2) {
                struct placed_filter placed = {.filter = {.w = {1, 2, -3}, .det = 4, .t = -5}};
                double *const at[5] = {&placed.filter.w[0], &placed.filter.w[1],
                                       &placed.filter.w[2], &placed.filter.det, &placed.filter.t};
                *at[slot] = sign * row[i].x;
                assert_int_equal(placed_is_moderate(&placed), row[i].moderate);
            }
}

/* A placed triangle that is met on an edge out of the range needs no integers where hits alone
 * count, whichever sense it has and whichever of its edges that is; in the range it does. */
static void out_of_range_needs_no_integers(void **state)
{
    (void)state;
    static const float m[3][4] = {{2, 0, 0, 1}, {0, 0.5f, 0, 2}, {0, 0, 4, -3}};
    float vertex[9] = {-1, 0, 0, 1, 0, 0, 0, 7, 0};
    for (uint32_t n = 0; n < 12; n++) {
        uint32_t index[3];
        for (uint32_t c = 0; c < 3; c++)
            index[c] = ((n & 1 ? 2 - c : c) + n / 4) % 3;
        struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
        struct world world;
        struct oracle *oracle;
        struct decided pair;
        assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
        memcpy(world.instance[0].m, m, sizeof m);
        assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
        struct located at = pair_locate(oracle, 0);
        struct ray ray = {{1.25f, 2, -8}, n & 2 ? 9 : -2, {0, 0, 1}, n & 2 ? 99 : 2};
        pair_decide(&at, &ray, 0, PAIR_HITS, &pair, NULL);
        assert_int_equal(pair.pair.class, ORACLE_MISS);
        assert_false(pair.have_exact);
        ray.tmin = -2;
        ray.tmax = 99;
        pair_decide(&at, &ray, 0, PAIR_HITS, &pair, NULL);
        assert_true(pair.have_exact && pair.pair.class == ORACLE_EDGE);
        oracle_free(oracle);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_as_tight_as_their_sums),
        cmocka_unit_test(boxes_end_where_floats_do),
        cmocka_unit_test(instances_are_bounded_by_the_parts_of_their_meshes),
        cmocka_unit_test(rays_have_the_errors_of_their_sums),
        cmocka_unit_test(quotients_stay_in_double),
        cmocka_unit_test(out_of_range_needs_no_integers),
    };
    return cmocka_run_group_tests_name("oracle_placing", tests, NULL, NULL);
}
