/* What is judged of a lost hit (ref/judge/judge_lost.c), by value: twins and numbers are given to
 * it, those at borders among them. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

typedef long double wide;

#define LEAST_T 0x1p-100

static struct judge_known knowing(const struct twin *twin)
{
    return (struct judge_known){{0}, {*twin}, 1};
}

static bool cannot_miss(const struct judge *judge, const struct ray *ray, const struct twin *twin,
                        double t_lo, double t_hi, double reach)
{
    const struct judge_known known = knowing(twin);
    bool lost = true;
    assert_int_equal(judge_cannot_miss(judge, ray, 0, t_lo, t_hi, reach, NULL, &known, &lost),
                     STATUS_OK);
    return lost;
}

/* --- Embree's default box test ---------------------------------------------------------------- */

/* One triangle, whose box is [lo, hi]. */
static void span(struct scene *scene, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        scene->vertex[k] = lo[k];
        scene->vertex[3 + k] = hi[k];
        scene->vertex[6 + k] = k ? lo[k] : hi[k];
    }
}

/* Entry and end of two axes, of the range too, are apart by no more than both errors: 9 u of the
 * sizes over the direction, which is at least 1e-18. */
static bool may_come_apart(const struct scene *scene, const float largest[3], const struct ray *ray,
                           double reach)
{
    wide enter[3], leave[3], error[3], end = fminl((wide)reach, (wide)ray->tmax);
    struct box box = scene_tri_bounds(scene, 0);
    bool may = false;
    for (int k = 0; k < 3; k++) {
        wide d = (wide)ray->dir[k], o = (wide)ray->org[k];
        d = fabsl(d) < (wide)1e-18 ? (wide)1e-18 : d;
        wide a = ((wide)box.lo[k] - o) / d, b = ((wide)box.hi[k] - o) / d;
        enter[k] = fminl(a, b);
        leave[k] = fmaxl(a, b);
        error[k] = 9 * 0x1p-24L * ((wide)largest[k] + fabsl(o)) / fabsl(d);
        may = may || leave[k] <= (wide)ray->tmin + error[k] || end <= enter[k] + error[k];
    }
    for (int in = 0; in < 3; in++)
        for (int out = 0; out < 3; out++)
            may = may || (in != out && leave[out] <= enter[in] + error[in] + error[out]);
    return may;
}

/* In units of 9 u, so that borders are met: the largest coordinate is 1, and so is each error. */
static void the_box_test_loses_what_is_within_its_errors(void **state)
{
    (void)state;
    static const float ways[] = {1, -1, 2, -0.5f, 4, 0, 1e-19f, -1e-19f, -2e-18f};
    const float unit = 9 * 0x1p-24f;
    const struct twin certain = {.possible = true, .certain = true};
    struct rng rng = rng_make(1, 53);
    struct scene scene;
    size_t lost = 0, kept = 0;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++)
        scene.index[c] = c;
    for (int i = 0; i < 200000; i++) {
        struct judge judge = {.scene = &scene, .model.slab = true};
        struct ray ray = {.tmin = unit * (float)rng_below(&rng, 4)};
        float lo[3], hi[3];
        double reach = (double)unit * (1 + rng_below(&rng, 40));
        for (int k = 0; k < 3; k++) {
            int from = (int)rng_below(&rng, 6), size = (int)rng_below(&rng, 30);
            ray.dir[k] = ways[rng_below(&rng, i % 4 ? 4 : ARRAY_COUNT(ways))];
            ray.org[k] = rng_below(&rng, 4) ? 0 : unit * (float)rng_below(&rng, 3);
            lo[k] = unit * (float)(ray.dir[k] < 0 ? -from - size : from);
            hi[k] = lo[k] + unit * (float)size;
            judge.largest[k] = rng_below(&rng, 4) ? 1 : 2;
        }
        ray.tmax = rng_below(&rng, 2) ? INFINITY : unit * (float)(1 + rng_below(&rng, 40));
        span(&scene, lo, hi);
        bool is_lost = cannot_miss(&judge, &ray, &certain, 0x1p-90, 0x1p-90, reach);
        assert_int_equal(is_lost, !may_come_apart(&scene, judge.largest, &ray, reach));
        judge.model.slab = false; /* any other box test loses nothing */
        assert_true(cannot_miss(&judge, &ray, &certain, 0x1p-90, 0x1p-90, reach));
        lost += is_lost;
        kept += !is_lost;
    }
    print_message("%zu cannot be missed, %zu may\n", lost, kept);
    scene_free(&scene);
    assert_true(lost > 5000 && kept > 20000);
    assert_true((double)(float)EMBREE_LEAST_DIR != EMBREE_LEAST_DIR); /* no direction is at it */
}

/* --- given twins ------------------------------------------------------------------------------ */

static double pick(struct rng *rng, const double *from, uint32_t count)
{
    return from[rng_below(rng, count)];
}

static struct twin some_twin(struct rng *rng)
{
    static const double errors[] = {0, 0x1p-20, 0.25, 1, INFINITY};
    struct twin twin = {.possible = true, .certain = rng_below(rng, 2)};
    for (int c = 0; c < 3; c++)
        twin.edge[c] = (int)rng_below(rng, 8) ? 1 : 0;
    twin.det = rng_below(rng, 8) ? -1 : 0;
    twin.t_err = pick(rng, errors, ARRAY_COUNT(errors));
    return twin;
}

static void a_certain_hit_is_lost_behind_both_errors(void **state)
{
    (void)state;
    static const double ts[] = {LEAST_T, 0x1p-99, 1, 2};
    static const double steps[] = {-0.5, 0, 0x1p-21, 0x1p-19, 0x1p-18, 0.25, 0.5, 0.75, 2, 3};
    struct rng rng = rng_make(2, 53);
    struct judge judge = {.displacement = 0};
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    size_t counts[3] = {0};
    for (int i = 0; i < 40000; i++) {
        struct twin twin = some_twin(&rng);
        struct judge_known known = knowing(&twin);
        double t_lo = pick(&rng, ts, 4), t_hi = t_lo + (rng_below(&rng, 2) ? 0x1p-22 : 0);
        double reach = rng_below(&rng, 8) ? t_hi + pick(&rng, steps, ARRAY_COUNT(steps)) : INFINITY;
        bool behind = reach > t_hi && reach > t_hi + 2 * twin.t_err;
        bool lost = cannot_miss(&judge, &ray, &twin, t_lo, t_hi, reach);
        assert_int_equal(lost, twin.certain && t_lo > LEAST_T && behind);
        bool all = twin.edge[0] && twin.edge[1] && twin.edge[2] && twin.det;
        enum verdict why = judge_why_lost(&judge, &ray, 0, t_lo, t_hi, reach, &known);
        enum verdict expected = twin.t_err < INFINITY && !(reach > t_hi + 2 * twin.t_err)
                                    ? VERDICT_NEAR_TIE
                                : !all                           ? VERDICT_BOUNDARY
                                : twin.certain && t_lo > LEAST_T ? VERDICT_SLAB
                                                                 : VERDICT_BORDER;
        assert_int_equal(why, expected);
        counts[0] += lost;
        counts[1] += why == VERDICT_SLAB;
        counts[2] += why == VERDICT_BORDER;
    }
    assert_true(counts[0] > 1000 && counts[1] > 1000 && counts[2] > 1000);
}

static void the_first_of_what_was_found_is_found(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 53);
    assert_null(judge_find(NULL, 0));
    for (int i = 0; i < 4000; i++) {
        struct judge_slot slot[12];
        struct judge_found found = {slot, rng_below(&rng, 13)};
        uint32_t at = rng_below(&rng, 2);
        for (uint32_t k = 0; k < found.count; k++) {
            slot[k] = (struct judge_slot){at, k};
            at += rng_below(&rng, 3);
        }
        for (uint32_t prim = 0; prim < 30; prim++) {
            const struct judge_slot *first = NULL;
            for (size_t k = found.count; k-- > 0;)
                if (slot[k].prim == prim)
                    first = &slot[k];
            assert_ptr_equal(judge_find(&found, prim), first);
        }
    }
}

/* --- all that lies before what was answered --------------------------------------------------- */

#define LAYERS 24

/* Triangles across the ray at few distances, so that many tie; of each the inside, an edge or a
 * vertex is hit. */
static void draw_layers(struct rng *rng, struct scene *scene)
{
    static const float corner[4][3][2] = {{{-2, -2}, {2, -2}, {0, 2}},
                                          {{-2, 0}, {2, 0}, {0, 2}},
                                          {{0, 0}, {2, -2}, {0, 2}},
                                          {{3, 3}, {4, 3}, {3, 4}}};
    scene->tri_count = 1 + rng_below(rng, LAYERS);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        uint32_t shape = rng_below(rng, 4);
        float z = 1 + (float)rng_below(rng, 8) * 0.25f;
        for (uint32_t c = 0; c < 3; c++) {
            float *v = scene->vertex + 9 * i + 3 * c;
            v[0] = corner[shape][c][0];
            v[1] = corner[shape][c][1];
            v[2] = z;
            scene->index[3 * i + c] = 3 * i + c;
        }
    }
}

/* The nearest hit itself, or else the first of all that lie before the end. */
static uint32_t must_be_lost(const struct judge *judge, const struct oracle *oracle,
                             const struct ray *ray, uint32_t nearest, double reach)
{
    uint32_t best = ABI_NO_PRIM;
    double t = INFINITY;
    for (uint32_t prim = 0; prim < judge->scene->tri_count; prim++) {
        struct oracle_pair pair;
        bool lost = false;
        oracle_pair(oracle, ray, prim, &pair);
        if (!oracle_is_hit(&pair))
            continue;
        assert_int_equal(
            judge_cannot_miss(judge, ray, prim, pair.t_lo, pair.t_hi, reach, NULL, NULL, &lost),
            STATUS_OK);
        if (lost && prim == nearest)
            return prim;
        if (!lost || !(pair.t_lo < t))
            continue;
        t = pair.t_lo;
        best = prim;
    }
    return best;
}

static void what_cannot_be_missed_is_lost_wherever_it_lies(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 53);
    struct scene scene;
    size_t nearest = 0, another = 0, none = 0;
    assert_int_equal(scene_make(3 * LAYERS, LAYERS, &scene), STATUS_OK);
    for (int i = 0; i < 3000; i++) {
        static const struct model model = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}};
        struct ray ray = {{0, 0, 0}, 0, {0, 0, 3}, 1e30f};
        struct oracle *oracle;
        struct judge *judge;
        struct oracle_answer truth;
        draw_layers(&rng, &scene);
        assert_int_equal(oracle_make(&scene, &oracle, NULL), STATUS_OK);
        assert_int_equal(judge_make(oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        assert_int_equal(
            oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, &ray, 1, 1, &truth, NULL, NULL),
            STATUS_OK);
        for (int at = 0; at < 18; at++) {
            double reach = at == 17 ? INFINITY : (0.875 + at * 0.125) / 3;
            struct judgement out = {.lost = ABI_NO_PRIM, .expected = truth.prim};
            bool lost = true, any = truth.prim != ABI_NO_PRIM && reach > truth.t_hi;
            uint32_t must =
                any ? must_be_lost(judge, oracle, &ray, truth.prim, reach) : ABI_NO_PRIM;
            assert_int_equal(judge_lost(judge, &ray, &truth, reach, NULL, &lost, &out), STATUS_OK);
            assert_int_equal(lost, must != ABI_NO_PRIM);
            if (lost && must != truth.prim) {
                struct oracle_pair pair;
                oracle_pair(oracle, &ray, must, &pair);
                assert_int_equal(out.lost, must);
                assert_true(out.lost_lo == pair.t_lo && out.lost_hi == pair.t_hi);
                assert_true(pair.t_lo < pair.t_hi);
            } else {
                assert_int_equal(out.lost, ABI_NO_PRIM);
            }
            nearest += lost && must == truth.prim;
            another += lost && must != truth.prim;
            none += !lost;
        }
        judge_free(judge);
        oracle_free(oracle);
    }
    scene.tri_count = LAYERS;
    scene_free(&scene);
    print_message("lost: the nearest %zu, another %zu, none %zu\n", nearest, another, none);
    assert_true(nearest > 1000 && another > 1000 && none > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_box_test_loses_what_is_within_its_errors),
        cmocka_unit_test(a_certain_hit_is_lost_behind_both_errors),
        cmocka_unit_test(the_first_of_what_was_found_is_found),
        cmocka_unit_test(what_cannot_be_missed_is_lost_wherever_it_lies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
