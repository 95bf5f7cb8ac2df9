/* What is not opaque, in the oracle of a world: cells of the filter end exactly on their lines, and
 * the kinds of filters that pass all or none. */
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

static void closest(const struct oracle *oracle, const struct ray *ray, const struct ray_mode *mode,
                    size_t count, struct oracle_answer *out)
{
    assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, mode, count, 1,
                                          out, NULL, &reason),
                     STATUS_OK);
}

/* --- the filter ------------------------------------------------------------------------------- */

/* Rays straight at points of a right triangle whose u and v are exact floats: on the lines of the
 * cells, at corners, and next to the lines. */
static void cells_end_on_their_lines(void **state)
{
    (void)state;
    static const float m[3][4] = {{0, -2, 0, 3}, {0.5f, 0, 0, -5}, {0, 0, 4, 1}};
    float vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t index[3] = {0, 1, 2}, on_line = 0, open = 0;
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct world world;
    struct oracle *oracle;
    assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
    memcpy(world.instance[0].m, m, sizeof m);
    world.mesh[0].geometry[0].opaque = false;
    assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
    for (uint32_t seed = 0; seed < 40; seed++)
        for (int n = 0; n < 19 * 19; n++) {
            float weight[2], step = ldexpf(1, -(int)(seed % 15) - 5);
            for (int a = 0; a < 2; a++) { /* around 0, 1/4 .. 1; and a last place off */
                int i = a ? n / 19 : n % 19;
                weight[a] = (float)(i / 3) * 0.25f + (float)(i % 3 - 1) * step;
            }
            struct oracle_pair pair;
            const struct ray ray = {{3 - 2 * weight[1], -5 + 0.5f * weight[0], -7},
                                    0,
                                    {0, 0, seed % 2 ? 1 : 1.5f},
                                    INFINITY};
            world.filter = (struct filter_rule){FILTER_CELLS, seed, 128};
            oracle_pair(oracle, &ray, 0, &pair);
            bool hit = weight[0] >= 0 && weight[1] >= 0 && weight[0] + weight[1] <= 1;
            assert_int_equal(oracle_is_hit(&pair), hit);
            if (!hit)
                continue;
            struct oracle_answer answer;
            struct place place = world_place(&world, 0);
            double u[2], v[2];
            bool passes = filter_passes(&world.filter, &place, weight[0], weight[1]);
            closest(oracle, &ray, NULL, 1, &answer);
            assert_int_equal(answer.prim != ABI_NO_PRIM, passes);
            assert_int_equal(oracle_admit(oracle, &ray, ray_mode_all(), 0, &pair),
                             passes ? ORACLE_ADMITTED : ORACLE_FILTERED);
            oracle_weights(oracle, &ray, 0, u, v);
            assert_true(u[0] <= (double)weight[0] && (double)weight[0] <= u[1]);
            assert_true(v[0] <= (double)weight[1] && (double)weight[1] <= v[1]);
            assert_true(u[1] - u[0] <= 0x1p-50 && v[1] - v[0] <= 0x1p-50);
            on_line += n % 3 == 1 && n / 19 % 3 == 1;
            /* Open within a step exactly if one of the nine points around differs. */
            bool differs = false;
            for (int i = 0; i < 9; i++)
                differs |= filter_passes(&world.filter, &place,
                                         weight[0] + (float)(i % 3 - 1) * 1.5f * step,
                                         weight[1] + (float)(i / 3 - 1) * 1.5f * step) != passes;
            assert_int_equal(oracle_filter_is_open(oracle, &ray, ray_mode_all(), 0,
                                                   1.5 * (double)step, 1.5 * (double)step),
                             differs);
            assert_false(oracle_filter_is_open(oracle, &ray,
                                               (struct ray_mode){0xFF, ABI_RAY_OPAQUE}, 0, 1, 1));
            open += differs;
        }
    assert_true(on_line > 200 && open > 500);
    oracle_free(oracle);
    world_free(&world);
}

/* A filter that passes all is an opaque geometry; one that passes none leaves nothing of it. */
static void a_filter_of_all_is_opaque(void **state)
{
    (void)state;
    uint32_t hits = 0;
    for (int k = 0; k < WORLD_TURNS; k++) {
        struct world_case c;
        struct ray_mode mode[3][WORLD_RAYS];
        struct oracle_answer got[3][WORLD_RAYS];
        world_case_make(&world_turns[k], 4000, &c);
        for (int i = 0; i < WORLD_RAYS; i++)
            for (int m = 0; m < 3; m++)
                mode[m][i] = (struct ray_mode){0xFF, m ? ABI_RAY_NO_OPAQUE : ABI_RAY_OPAQUE};
        for (int m = 0; m < 3; m++) {
            c.world.filter.kind = m == 2 ? FILTER_NONE : FILTER_ALL;
            closest(c.oracle, c.ray, mode[m], WORLD_RAYS, got[m]);
        }
        for (int i = 0; i < WORLD_RAYS; i++) {
            assert_true(answer_same(&got[0][i], &got[1][i]));
            assert_int_equal(got[2][i].prim, ABI_NO_PRIM);
            hits += got[0][i].prim != ABI_NO_PRIM;
        }
        world_case_free(&c);
    }
    assert_true(hits > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_end_on_their_lines),
        cmocka_unit_test(a_filter_of_all_is_opaque),
    };
    return cmocka_run_group_tests_name("oracle_world_filter", tests, NULL, NULL) ? 1 : 0;
}
