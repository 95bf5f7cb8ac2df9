/* What counts in a world where the filter reads u and v (ref/judge/judge_admit.c): an answer may
 * pass if the filter passes in some cell that u and v may be computed in, a hit counts surely if it
 * passes in each of them, and may count if it passes in any. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"
#include "ref/oracle/oracle_world.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/judge_values/one_placed.h"

typedef long double wide;

#define GRID ((int)ABI_FILTER_GRID)

/* The nearest to x in cell `cell`, the first and last of which have no end outside. */
static double nearest(double x, int cell)
{
    if (cell > 0 && x < (double)cell / GRID)
        return (double)cell / GRID;
    if (cell < GRID - 1 && x > (double)(cell + 1) / GRID)
        return (double)(cell + 1) / GRID;
    return x;
}

/* u (0) or v (1) of triangle 0 may be computed in that cell; *near: a matter of the last digits. */
static bool reaches(const struct one_placed *one, const struct ray *ray, int which, int cell,
                    bool *near)
{
    if (one->judge.own) {
        struct twin twin = judge_twin(&one->judge, ray, 0, NULL);
        double x = which ? twin.v_near : twin.u_near, err = which ? twin.v_err : twin.u_err;
        wide off = fabsl((wide)nearest(x, cell) - (wide)x), most = (wide)err * (1 + 0x1p-20L);
        *near = *near || fabsl(off - most) <= 1e-12L * most;
        return isinf(err) || off <= most;
    }
    struct judge_rounding r = judge_rounding_at(&one->judge, ray, 0);
    return r.det == 0 ||
           judge_weight_allowed(&r, which + 1, nearest(r.edge[which + 1] / r.det, cell));
}

struct passing_cells {
    bool some, all, any, near; /* pass: of those that may be reached, and of the grid */
};

static struct passing_cells cells_of(const struct one_placed *one, const struct ray *ray)
{
    const struct place at = world_place(&one->world, 0);
    struct passing_cells out = {.all = true};
    for (int cell = 0; cell < GRID * GRID; cell++) {
        int u = cell / GRID, v = cell % GRID;
        bool passes = filter_passes(&one->world.filter, &at, ((float)u + 0.5f) / (float)GRID,
                                    ((float)v + 0.5f) / (float)GRID);
        out.any = out.any || passes;
        if (!reaches(one, ray, 0, u, &out.near) || !reaches(one, ray, 1, v, &out.near))
            continue;
        out.some = out.some || passes;
        out.all = out.all && passes;
    }
    return out;
}

static const float corners[3][3] = {{0, 0, 4}, {4, 0, 4.5f}, {0, 4, 3.5f}};
static const float identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

static struct oracle *place_filtered(struct one_placed *out, const struct model *model,
                                     struct rng *rng)
{
    struct oracle *oracle;
    float v[3][3], m[3][4];
    memcpy(v, corners, sizeof v);
    memcpy(m, identity, sizeof m);
    m[0][3] = rng_below(rng, 2) ? 0.25f : 0; /* or the identity, where nothing is transformed */
    place(out, v, m);
    out->world.mesh->geometry->opaque = false;
    out->world.filter.kind = FILTER_CELLS;
    out->world.filter.seed = (uint32_t)rng_u64(rng);
    out->world.filter.share = 96;
    out->judge.model = *model;
    out->judge.own = twin_is_own(model->formula);
    out->judge.in_contract = true;
    out->judge.mode = ray_mode_all();
    assert_int_equal(oracle_make_world(&out->world, &oracle, NULL), STATUS_OK);
    out->judge.oracle = oracle;
    return oracle;
}

/* To a point near a border of cells, on the triangle or beside. */
static struct ray aim(struct rng *rng, float shift)
{
    struct ray ray = {{1, 1, 0}, 0, {0, 0, 1}, INFINITY};
    float weight[2];
    for (int k = 0; k < 2; k++) {
        float off = rng_range(rng, -1, 1);
        weight[k] = (float)((int)rng_below(rng, 7) - 1) / (float)GRID;
        weight[k] += ldexpf(off, -1 - (int)rng_below(rng, 26));
    }
    for (int k = 0; k < 3; k++) {
        float to = corners[0][k] + weight[0] * (corners[1][k] - corners[0][k]) +
                   weight[1] * (corners[2][k] - corners[0][k]);
        ray.dir[k] = to - ray.org[k];
    }
    ray.dir[0] += shift;
    return ray;
}

static void what_passes_is_a_matter_of_the_cells_that_u_and_v_may_lie_in(void **state)
{
    (void)state;
    static const struct model models[] = {{.formula = TWIN_MT, .rounding = {2, 2, 5, 0x1p-126}},
                                          {.formula = TWIN_WOOP, .rounding = {1, 1, 1, 0x1p-149}},
                                          {.formula = TWIN_UNKNOWN}};
    struct rng rng = rng_make(1, 55);
    size_t pass = 0, sure = 0, open = 0;
    for (int i = 0; i < 12000; i++) {
        struct one_placed one;
        struct oracle *oracle = place_filtered(&one, &models[i % 3], &rng);
        struct ray ray = aim(&rng, one.world.instance->m[0][3]);
        struct passing_cells cells = cells_of(&one, &ray);
        struct twin twin = {.possible = true};
        struct hit hit = {1, 0.25f, 0.25f, 0};
        if (one.judge.own)
            twin = judge_twin(&one.judge, &ray, 0, NULL);
        enum wrong front = judge_ruled_out(&one.judge, &ray, &hit, ABI_TAG_FRONT);
        enum wrong back = judge_ruled_out(&one.judge, &ray, &hit, 0);
        enum wrong found = front == WRONG_FACING ? back : front;
        if (!cells.near) {
            bool surely = judge_surely_counts(&one.judge, &ray, 0, &twin);
            assert_int_equal(found, cells.some ? WRONG_NOT : WRONG_OPACITY);
            assert_int_equal(surely, cells.all);
            pass += cells.some;
            sure += surely;
            open += cells.some && !cells.all;
        }
        if (one.judge.own)
            assert_int_equal(judge_may_count(&one.judge, &ray, 0), cells.any);
        else
            assert_true(cells.near || judge_may_count(&one.judge, &ray, 0) == cells.some);
        oracle_free(oracle);
        world_free(&one.world);
    }
    print_message("%zu may pass, %zu surely, %zu either\n", pass, sure, open);
    assert_true(pass > 2000 && sure > 1500 && open > 300);
}

/* A weight whose bound ends at the border of a cell, or one share of 2^-20 before or behind. */
static void bounds_of_weights_reach_a_share_farther(void **state)
{
    (void)state;
    static const struct model model = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}};
    const struct ray ray = {{1, 1, 0}, 0, {0, 0, 1}, INFINITY};
    struct rng rng = rng_make(3, 55);
    size_t differ = 0;
    for (int i = 0; i < 6000; i++) {
        struct one_placed one;
        struct oracle *oracle = place_filtered(&one, &model, &rng);
        const struct place at = world_place(&one.world, 0);
        bool all = true, before = true;
        double near[2], err[2], share[2];
        for (int k = 0; k < 2; k++) { /* cells at off <= err (1 + 2^-20) are reached */
            int border = (int)rng_below(&rng, 5), side = rng_below(&rng, 2) ? 1 : -1;
            err[k] = ldexp(1, -3 - (int)rng_below(&rng, 4));
            share[k] = rng_below(&rng, 3) * 0x1p-20;
            near[k] = (double)border / GRID + side * err[k] * (1 + share[k]);
        }
        for (int cell = 0; cell < GRID * GRID; cell++) {
            int c[2] = {cell / GRID, cell % GRID};
            bool in = true, narrow = true;
            for (int k = 0; k < 2; k++) {
                double off = fabs(nearest(near[k], c[k]) - near[k]);
                in = in && off <= err[k] * (1 + 0x1p-20);
                narrow = narrow && off <= err[k];
            }
            bool passes = filter_passes(&one.world.filter, &at, ((float)c[0] + 0.5f) / (float)GRID,
                                        ((float)c[1] + 0.5f) / (float)GRID);
            all = all && (passes || !in);
            before = before && (passes || !narrow);
        }
        struct twin twin = {.possible = true, .u_near = near[0], .v_near = near[1]};
        twin.u_err = err[0];
        twin.v_err = err[1];
        assert_int_equal(judge_surely_counts(&one.judge, &ray, 0, &twin), all);
        differ += all != before;
        oracle_free(oracle);
        world_free(&one.world);
    }
    assert_true(differ > 20);
}

/* Of what is opaque, and of filters that do not read u and v, no number is looked at. */
static void what_reads_no_weights_needs_none(void **state)
{
    (void)state;
    static const struct model models[] = {{.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}},
                                          {.formula = TWIN_UNKNOWN}};
    const struct ray ray = {{1, 1, 0}, 0, {0, 0, 1}, INFINITY};
    const struct twin any = {.possible = true, .u_err = INFINITY, .v_err = INFINITY};
    struct rng rng = rng_make(4, 55);
    size_t count[2] = {0};
    for (int i = 0; i < 2000; i++) {
        struct one_placed one;
        struct oracle *oracle = place_filtered(&one, &models[i % 2], &rng);
        const struct place at = world_place(&one.world, 0);
        struct hit hit = {4, rng_range(&rng, 0, 1), 0, 0};
        hit.v = rng_range(&rng, 0, 1);
        one.world.filter.kind = (enum filter_kind)rng_below(&rng, 4);
        one.world.mesh->geometry->opaque = rng_below(&rng, 3) == 0;
        one.judge.model.bits = rng_below(&rng, 2);
        bool opaque = one.world.mesh->geometry->opaque;
        bool reads = !opaque && one.world.filter.kind == FILTER_CELLS;
        bool passes = opaque || filter_passes(&one.world.filter, &at, hit.u, hit.v);
        enum wrong front = judge_ruled_out(&one.judge, &ray, &hit, ABI_TAG_FRONT);
        enum wrong back = judge_ruled_out(&one.judge, &ray, &hit, 0);
        if (!reads || one.judge.model.bits) /* such a judge is told the very numbers */
            assert_int_equal(front == WRONG_FACING ? back : front,
                             passes ? WRONG_NOT : WRONG_OPACITY);
        if (!reads) {
            assert_int_equal(judge_surely_counts(&one.judge, &ray, 0, &any), passes);
            assert_int_equal(judge_may_count(&one.judge, &ray, 0), passes);
            count[passes]++;
        }
        oracle_free(oracle);
        world_free(&one.world);
    }
    assert_true(count[0] > 100 && count[1] > 100);
}

/* A cell behind the last has its answer, and is reached if that is; where u and v are not read all
 * cells have one answer. */
static void cells_beyond_the_grid_are_those_at_its_ends(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 4000; seed++) {
        struct filter_rule filter = {(enum filter_kind)(seed % 4), seed, 96};
        const struct place at = {.tri = seed % 7};
        float in = ((float)(seed / 4 % GRID) + 0.5f) / GRID, last = (GRID - 0.5f) / GRID;
        float behind = (GRID + 0.5f) / GRID;
        bool one = filter_passes(&filter, &at, last, in),
             other = filter_passes(&filter, &at, in, last);
        assert_int_equal(filter_passes(&filter, &at, behind, in), one);
        assert_int_equal(filter_passes(&filter, &at, in, behind), other);
        if (filter.kind != FILTER_CELLS)
            assert_int_equal(one, filter_passes(&filter, &at, in, in));
    }
}

/* What has no numbers, no ray or no contract is judged by those, and not by the filter. */
static void what_has_no_numbers_is_not_the_filters(void **state)
{
    (void)state;
    static const struct model models[] = {{.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}},
                                          {.formula = TWIN_UNKNOWN}};
    struct rng rng = rng_make(2, 55);
    for (int i = 0; i < 2; i++) {
        struct one_placed one;
        struct oracle *oracle = place_filtered(&one, &models[i], &rng);
        one.world.filter.share = 0; /* nothing passes */
        struct ray ray = {{1, 1, 0}, 0, {0, 0, 1}, INFINITY};
        for (int tag = 0; tag < 2; tag++) {
            uint32_t front = tag ? ABI_TAG_FRONT : 0;
            struct hit hit = {4, 0.25f, 0.25f, 0}, no_u = hit, no_v = hit;
            no_u.u = NAN;
            no_v.v = INFINITY;
            enum wrong usual = judge_ruled_out(&one.judge, &ray, &hit, front);
            assert_true(usual == WRONG_OPACITY || usual == WRONG_FACING);
            enum wrong free = usual == WRONG_FACING ? WRONG_FACING : WRONG_NOT;
            assert_int_equal(judge_ruled_out(&one.judge, &ray, &no_u, front), free);
            assert_int_equal(judge_ruled_out(&one.judge, &ray, &no_v, front), free);
            one.judge.in_contract = false;
            assert_int_equal(judge_ruled_out(&one.judge, &ray, &hit, front), free);
            one.judge.in_contract = true;
            one.judge.model.bits = true; /* it asks about these very numbers */
            assert_int_equal(judge_ruled_out(&one.judge, &ray, &hit, front), usual);
            one.judge.model.bits = false;
            for (int k = 0; k < 3; k++) { /* of no side either */
                struct ray lost = ray;
                lost.dir[k] = NAN;
                assert_int_equal(judge_ruled_out(&one.judge, &lost, &hit, front), WRONG_NOT);
                lost = ray;
                lost.org[k] = INFINITY;
                assert_int_equal(judge_ruled_out(&one.judge, &lost, &hit, front), WRONG_NOT);
            }
        }
        oracle_free(oracle);
        world_free(&one.world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_passes_is_a_matter_of_the_cells_that_u_and_v_may_lie_in),
        cmocka_unit_test(bounds_of_weights_reach_a_share_farther),
        cmocka_unit_test(what_reads_no_weights_needs_none),
        cmocka_unit_test(cells_beyond_the_grid_are_those_at_its_ends),
        cmocka_unit_test(what_has_no_numbers_is_not_the_filters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
