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

/* What lies beside the grid has the answer of the cell next to it. */
static void beyond_the_grid_is_its_border(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 64; n++) {
        const struct filter_rule rule = {FILTER_CELLS, n / 4, 128};
        const struct place place = {.prim = 0};
        const float beside = 0.125f + 0.25f * (float)(n % 4);
        for (int k = 1; k < 8; k++) {
            const float far[2] = {-0.125f * (float)k, 1 + 0.125f * (float)k}, near[2] = {0, 0.875f};
            for (int end = 0; end < 2; end++) {
                assert_int_equal(filter_passes(&rule, &place, far[end], beside),
                                 filter_passes(&rule, &place, near[end], beside));
                assert_int_equal(filter_passes(&rule, &place, beside, far[end]),
                                 filter_passes(&rule, &place, beside, near[end]));
            }
        }
    }
}

/* Whether the filter differs between two places along u or v, the other of which is `beside`. */
static bool cell_differs(const struct world *world, int axis, float one, float two, float beside)
{
    struct place place = world_place(world, 0);
    return filter_passes(&world->filter, &place, axis ? beside : one, axis ? one : beside) !=
           filter_passes(&world->filter, &place, axis ? beside : two, axis ? two : beside);
}

static bool is_open(const struct oracle *oracle, const struct ray *ray, int axis, double by)
{
    return oracle_filter_is_open(oracle, ray, ray_mode_all(), 0, axis ? 0 : by, axis ? by : 0);
}

/* Rays through u = v = 5/17 and 8/17: the answer is open from the displacement on that takes the
 * exact u or v over a line into a cell of the other answer, in all four senses, and not a little
 * before. And where u or v is a double: by a displacement after which doubles are back on the line
 * that was left, and by one that ends on a line, which belongs to the upper cell. */
static void open_is_from_the_line_on(void **state)
{
    (void)state;
    static const struct {
        double at, by;
        float to;
    } row[] = {{0.5625 + 0x1p-19, 0.0625 + 0x1p-19 + 0x1p-56, 0.375f}, {0.6875, 0.0625, 0.875f}};
    float vertex[9] = {0, 0, 0, 17, 0, 0, 0, 17, 0};
    uint32_t index[3] = {0, 1, 2}, seen[8] = {0};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct oracle *oracle;
    struct world world;
    struct ray ray = {{5, 5, -1}, 0, {0, 0, 1}, INFINITY};
    double w[2][2][2];
    assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
    world.mesh[0].geometry[0].opaque = false;
    assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
    for (int up = 0; up < 2; up++) {
        ray.org[0] = ray.org[1] = (float)(5 + 3 * up);
        oracle_weights(oracle, &ray, 0, w[up][0], w[up][1]);
    }
    for (uint32_t n = 0; n < 64 * 4; n++) {
        int axis = n % 2, up = n / 2 % 2;
        const double *at = w[up][axis];
        double more = (up ? 0.5 - at[0] : at[1] - 0.25) - 0x1p-54;
        double none = (up ? 0.5 - at[1] : at[0] - 0.25) - 0x1p-50;
        assert_true(up ? 0.5L - (long double)more < 8 / 17.0L
                       : 0.25L + (long double)more > 5 / 17.0L);
        world.filter = (struct filter_rule){FILTER_CELLS, n / 4, 128};
        ray.org[0] = ray.org[1] = (float)(5 + 3 * up);
        bool open = cell_differs(&world, axis, 0.375f, up ? 0.625f : 0.125f, 0.375f);
        assert_int_equal(is_open(oracle, &ray, axis, more), open);
        assert_false(is_open(oracle, &ray, axis, none));
        seen[n % 4] += open;
        ray.org[axis] = (float)(17 * row[up].at);
        ray.org[1 - axis] = 2;
        open = cell_differs(&world, axis, 0.625f, row[up].to, 0.125f);
        assert_int_equal(is_open(oracle, &ray, axis, row[up].by), open);
        seen[4 + n % 4] += open;
    }
    for (int i = 0; i < 8; i++)
        assert_true(seen[i] > 10 && seen[i] < 60);
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
        cmocka_unit_test(beyond_the_grid_is_its_border),
        cmocka_unit_test(open_is_from_the_line_on),
        cmocka_unit_test(a_filter_of_all_is_opaque),
    };
    return cmocka_run_group_tests_name("oracle_world_filter", tests, NULL, NULL) ? 1 : 0;
}
