/* Answers that no bound of t decides (ref/judge/judge_noise.c), by value: the ends of a range, and
 * what a replay of the judge's model may come to. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"
#include "ref/oracle/oracle_world.h"
#include "ref/twin/twin_replay.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <string.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/judge_values/one_placed.h"

typedef long double wide;

static const struct rounding ieee = {1, 1, 1, 0x1p-149}, flushed = {2, 2, 5.5, 0x1p-126};
static float across[3][3] = {{-1, -1, 3}, {2, -1, 3}, {-1, 2, 3}};

static void the_class_of_a_pair_is_that_of_the_table(void **state)
{
    (void)state;
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    struct judge judge = {.displacement = 0};
    for (int class = 0; class < ORACLE_CLASS_COUNT; class ++)
        for (int range = ORACLE_BELOW; range <= ORACLE_ABOVE; range++)
            for (int open = 0; open < 2; open++) {
                struct oracle_pair pair = {.class = (enum oracle_class) class,
                                           .range = (enum oracle_range)range};
                bool hit = class == ORACLE_INSIDE || class == ORACLE_EDGE || class == ORACLE_VERTEX;
                bool flat = class == ORACLE_IN_PLANE || class == ORACLE_ZERO_AREA;
                bool end = range == ORACLE_AT_TMIN || range == ORACLE_AT_TMAX;
                bool in = range == ORACLE_WITHIN || (end && !open);
                enum verdict expected = hit && in ? VERDICT_RIGHT
                                        : hit     ? VERDICT_BORDER
                                        : flat    ? VERDICT_IN_PLANE
                                                  : VERDICT_BOUNDARY;
                judge.model.open = open;
                assert_int_equal(judge_by_pair(&judge, &ray, 0, &pair), expected);
            }
}

/* --- the ends of a range ---------------------------------------------------------------------- */

static void the_share_beyond_an_end_is_that_of_two_products_and_a_division(void **state)
{
    (void)state;
    static const double steps[] = {1, 1.5, 2, 5.5};
    for (int f = 0; f <= TWIN_UNKNOWN; f++)
        for (size_t m = 0; m < 4; m++)
            for (size_t d = 0; d < 4; d++) {
                struct model model = {.formula = (enum twin_formula)f};
                model.rounding.mul = steps[m];
                model.rounding.div = steps[d];
                double share = (2 * steps[m] + steps[d]) * 0x1p-24 * (1 + 0x1p-20);
                assert_true(judge_share_beyond(&model) == (f == TWIN_EMBREE ? share : 0));
            }
}

static void what_is_lost_at_an_end_is_as_much_as_is_flushed(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 54);
    size_t kept = 0, refused = 0;
    for (int i = 0; i < 40000; i++) {
        float v[3][3], size = ldexpf(1, -(int)rng_below(&rng, 9));
        struct model model = {.formula = i % 8 ? TWIN_EMBREE : TWIN_MT, .bits = i % 2};
        struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
        model.rounding = i % 3 ? flushed : ieee;
        for (int k = 0; k < 9; k++)
            v[k / 3][k % 3] = across[k / 3][k % 3] * size;
        struct scene scene;
        assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
        memcpy(scene.vertex, v, sizeof v);
        for (uint32_t c = 0; c < 3; c++)
            scene.index[c] = c;
        struct judge judge = {.scene = &scene, .model = model};
        struct liberty liberty = {model.rounding, !model.bits};
        const struct rounding *r = &model.rounding;
        wide share = (wide)judge_share_beyond(&model);
        wide lost =
            3 * (wide)r->tiny / (wide)replay_least_det(&liberty, &ray, v) + 2 * (wide)r->tiny;
        bool end = rng_below(&rng, 2);
        float at = i % 5 ? ldexpf(1, -100 - (int)rng_below(&rng, 40)) : 0;
        at = i % 7 ? at : 1;
        if (end)
            ray.tmax = at;
        else
            ray.tmin = at;
        wide most = (wide)at * (end ? 1 + share : 1 - share) + (end ? lost : -lost);
        float t = nextafterf((float)most, rng_below(&rng, 2) ? INFINITY : -INFINITY);
        bool in = end ? t >= 0 && t <= at : t >= at;
        bool may = model.formula == TWIN_EMBREE && fabsl((wide)t - most) > 1e-13L * fabsl(most) &&
                   (end ? (wide)t <= most && (wide)t >= -lost : (wide)t >= most);
        if (fabsl((wide)t - most) > 1e-13L * fabsl(most) || in) {
            assert_int_equal(judge_may_keep(&judge, &ray, 0, t), in || may);
            kept += may && !in;
            refused += !may && !in;
        }
        scene_free(&scene);
    }
    print_message("kept %zu, refused %zu\n", kept, refused);
    assert_true(kept > 3000 && refused > 3000);
}

/* --- replays ---------------------------------------------------------------------------------- */

/* A triangle that the ray lies nearly in, so that roundings decide; multiples of 2^-17. */
static struct ray draw(struct rng *rng, float v[3][3])
{
    struct ray ray = {.tmin = 0, .tmax = 0x1p60f};
    for (int k = 0; k < 2; k++) {
        for (int c = 0; c < 3; c++)
            v[c][k] = (float)rng_below(rng, 1 << 17) * 0x1p-17f;
        ray.org[k] = (float)rng_below(rng, 1 << 17) * -0x1p-17f;
        ray.dir[k] = (v[0][k] + v[1][k] + 2 * v[2][k]) / 4 - ray.org[k];
    }
    int tilt = -(int)rng_below(rng, 19);
    for (int c = 0; c < 3; c++)
        v[c][2] = v[c][0] + v[c][1] + ldexpf((float)rng_below(rng, 3), tilt);
    ray.org[2] = ray.org[0] + ray.org[1];
    ray.dir[2] = (v[0][2] + v[1][2] + 2 * v[2][2]) / 4 - ray.org[2];
    return ray;
}

static bool replays(const struct judge *judge, bool fuses, const struct ray *ray, float v[3][3],
                    const struct replay_answer *answer)
{
    const struct liberty liberty = {judge->model.rounding, fuses};
    struct twin_ray placed;
    if (!judge->world)
        return replay_can_answer(judge->model.formula, &liberty, ray, v, answer);
    twin_ray_of(judge->place, judge->model.rounding, fuses, ray, &placed);
    return replay_can_answer_placed(judge->model.formula, &liberty, &placed, v, answer);
}

/* Those that promise C's bits fuse nothing; a weight may be flushed before it is compared. */
static void an_answer_is_possible_if_the_model_comes_to_it(void **state)
{
    (void)state;
    static float m[3][4] = {{1, 0, 0, 0.25f}, {0, 2, 0, 0}, {0, 0, 1, 0}};
    struct rng rng = rng_make(6, 54);
    size_t one_yes = 0, one_no = 0, fused_more = 0, any_yes = 0, any_no = 0;
    for (int i = 0; i < 6000; i++) {
        struct one_placed one;
        float v[3][3];
        struct ray ray = draw(&rng, v);
        place(&one, v, m);
        struct judge judge = one.judge;
        if (i % 2)
            judge = (struct judge){.scene = one.world.mesh->scene};
        ray.org[0] += i % 2 ? 0 : 0.25f;
        ray.org[1] *= i % 2 ? 1 : 2;
        ray.dir[1] *= i % 2 ? 1 : 2;
        judge.model = (struct model){.formula = TWIN_MT, .bits = i % 3 == 0};
        judge.model.rounding = i % 5 ? ieee : flushed;
        if (i % 7 == 0)
            ray.tmax = rng_range(&rng, 0.5f, 1.5f);
        struct hit hit = {rng_range(&rng, 0, 2), rng_range(&rng, 0, 0.6f), 0, 0};
        hit.v = rng_range(&rng, 0, 0.4f);
        if (rng_below(&rng, 2)) /* the middle that the ray goes to */
            hit = (struct hit){1 + (float)rng_below(&rng, 5) * 0x1p-23f, 0.25f, 0.5f, 0};
        struct replay_answer exact = {{(double)hit.t, (double)hit.u, (double)hit.v},
                                      {(double)hit.t, (double)hit.u, (double)hit.v}};
        double least = i % 5 ? 0 : -1;
        struct replay_answer any = {{(double)ray.tmin, least, least}, {(double)ray.tmax, 1, 1}};
        bool fuses = !judge.model.bits;
        bool can = judge_can_answer(&judge, &ray, 0, &hit), hits = judge_can_hit(&judge, &ray, 0);
        assert_int_equal(can, replays(&judge, fuses, &ray, v, &exact));
        assert_int_equal(hits, replays(&judge, fuses, &ray, v, &any));
        fused_more +=
            replays(&judge, true, &ray, v, &any) && !replays(&judge, false, &ray, v, &any);
        judge.by_bounds = true;
        assert_int_equal(judge_can_answer(&judge, &ray, 0, &hit), hits);
        one_yes += can;
        one_no += !can;
        any_yes += hits;
        any_no += !hits;
        world_free(&one.world);
    }
    print_message("this %zu, not %zu; any %zu, none %zu; %zu by fusing alone\n", one_yes, one_no,
                  any_yes, any_no, fused_more);
    assert_true(one_yes > 20 && one_no > 500 && any_yes > 500 && any_no > 100 && fused_more > 20);
}

/* --- off a placed triangle -------------------------------------------------------------------- */

/* As in a scene, and by what the ray in the space of the mesh may be off. */
static bool is_in_box(const struct judge *judge, const struct ray *ray, float v[3][3], double t,
                      bool *near)
{
    struct twin_ray at;
    bool in = true;
    judge_take_along(judge, ray, 0, &at);
    for (int k = 0; k < 3; k++) {
        wide x = (wide)at.org_near[k] + (wide)t * (wide)at.dir_near[k];
        wide lo = (wide)fminf(v[0][k], fminf(v[1][k], v[2][k]));
        wide hi = (wide)fmaxf(v[0][k], fmaxf(v[1][k], v[2][k]));
        wide pad = 64 * 0x1p-24L * (fmaxl(fabsl(lo), fabsl(hi)) + fabsl((wide)at.org_near[k]));
        pad += (wide)at.org_off[k] + fabsl((wide)t) * (wide)at.dir_off[k];
        wide off = fmaxl(lo - x, x - hi);
        in = in && off <= pad;
        *near = *near || fabsl(off - pad) <= 1e-8L * pad;
    }
    return in;
}

/* A shear makes the ray's numbers worse than the box's own share. */
static void what_is_off_a_placed_triangle_is_noise(void **state)
{
    (void)state;
    static float m[3][4] = {{1, 40, 0, 3}, {0, 1, 30, -2}, {0, 0, 1, 1}};
    struct rng rng = rng_make(7, 54);
    size_t on = 0, off = 0;
    for (int i = 0; i < 6000; i++) {
        struct one_placed one;
        struct oracle *oracle;
        struct oracle_pair pair;
        struct ray ray = {.tmin = 0, .tmax = INFINITY};
        float v[3][3], to[3], step = rng_range(&rng, -1, 1);
        for (int k = 0; k < 3; k++) {
            float at = rng_range(&rng, -1, 1);
            for (int c = 0; c < 3; c++)
                v[c][k] = at + 0x1p-14f * rng_range(&rng, -1, 1);
            to[k] = (v[0][k] + v[1][k] + v[2][k]) / 3;
        }
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -40, 40);
            ray.dir[k] = m[k][0] * to[0] + m[k][1] * to[1] + m[k][2] * to[2] + m[k][3] - ray.org[k];
        }
        place(&one, v, m);
        assert_int_equal(oracle_make_world(&one.world, &oracle, NULL), STATUS_OK);
        one.judge.oracle = oracle;
        one.judge.model = (struct model){.formula = TWIN_MT, .rounding = flushed};
        one.judge.own = one.judge.by_bounds = true;
        one.judge.mode = ray_mode_all();
        oracle_pair(oracle, &ray, 0, &pair);
        step = ldexpf(step, -12 - (int)rng_below(&rng, 10));
        const struct hit hit = {1 + step, 2, 2, 0};
        const struct oracle_answer truth = {.prim = 0, .tie_count = 1};
        const struct twin twin = {.possible = true, .t_err = INFINITY, .u_err = 9, .v_err = 9};
        const struct judge_known known = {{0}, {twin}, 1};
        struct judgement out = {.verdict = VERDICT_RIGHT};
        bool near = false, in = is_in_box(&one.judge, &ray, v, (double)hit.t, &near);
        if (!near && judge_takes(&one.judge, &ray, 0) && judge_can_hit(&one.judge, &ray, 0)) {
            assert_int_equal(judge_named(&one.judge, &ray, &truth, &hit, &known, &out),
                             in ? VERDICT_BOUNDARY : VERDICT_NOISE);
            on += in;
            off += !in;
        }
        oracle_free(oracle);
        world_free(&one.world);
    }
    print_message("%zu on the triangle, %zu off\n", on, off);
    assert_true(on > 1000 && off > 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_class_of_a_pair_is_that_of_the_table),
        cmocka_unit_test(the_share_beyond_an_end_is_that_of_two_products_and_a_division),
        cmocka_unit_test(what_is_lost_at_an_end_is_as_much_as_is_flushed),
        cmocka_unit_test(what_is_off_a_placed_triangle_is_noise),
        cmocka_unit_test(an_answer_is_possible_if_the_model_comes_to_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
