/* How much slack the allowance for a black box's transform has: it is halved until honest answers,
 * of rays that are taken along by W o - W T, are refused. Prints the table. */
static double transform = 64.0;
#define TRANSFORM transform
#include "ref/judge/judge_allowed.c"

#include "tests/judge/honest_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define STEPS_DOWN 12
#define RAYS       10

static uint64_t worlds(void)
{
    return getenv("RAYDIFF_SLOW") ? 3000 : 150;
}

struct refused {
    uint64_t answers, wrong[STEPS_DOWN + 1]; /* with 64 over 2^step; the last with 0 */
};

/* Woop's edge functions may have any sign of what is smaller than the rounding of its distance. */
static bool is_near(const struct judged_world *w, const struct ray *ray)
{
    bool near = true;
    for (uint32_t i = 0; i < w->world.instance_count; i++) {
        struct twin_ray placed;
        if (w->world.instance[i].mesh == WORLD_NO_MESH)
            continue;
        twin_ray_of(&w->place[i], ROUNDING_IEEE, false, ray, &placed);
        for (int k = 0; k < 3; k++)
            near = near && fabs(placed.org_near[k]) < 0x1p18;
    }
    return near;
}

static void judge_with_less(const struct judged_world *w, const struct judge *judge,
                            const struct ray *ray, struct ray_mode mode, struct legal *legal,
                            enum twin_formula formula, struct refused *refused)
{
    struct oracle_answer truth = judged_world_truth(w, ray, mode);
    struct hit hit;
    uint32_t tag;
    honest_world_trace(w, formula, legal, ray, mode, QUERY_CLOSEST, &hit, &tag);
    refused->answers++;
    for (int step = 0; step <= STEPS_DOWN; step++) {
        struct judgement j;
        transform = step < STEPS_DOWN ? ldexp(64.0, -step) : 0.0;
        assert_int_equal(judge_world_answer(judge, ray, mode, &truth, &hit, tag, &j), STATUS_OK);
        refused->wrong[step] += j.verdict == VERDICT_WRONG;
    }
}

static void the_transform_of_a_black_box_has_this_much_slack(void **state)
{
    (void)state;
    static const enum twin_formula formulas[] = {TWIN_MT, TWIN_WOOP, TWIN_PLUECKER};
    const struct model model = {.formula = TWIN_UNKNOWN};
    struct refused refused = {0};
    int held = 0;
    for (uint64_t i = 0; i < worlds(); i++) {
        struct judged_world w;
        struct judge *judge;
        struct rng rng = rng_make(i, 37);
        judged_world_make(20000 + i, &w);
        w.affine = i % 2;
        assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        for (int n = 0; n < RAYS; n++) {
            struct ray ray = judged_world_aim(&w, &rng);
            struct ray_mode mode = judged_world_mode(&rng);
            struct legal legal = {.rounding = ROUNDING_IEEE, .style = LEGAL_ALL_NEAREST, .seed = i};
            for (size_t f = 0; f < ARRAY_COUNT(formulas) && is_near(&w, &ray); f++)
                judge_with_less(&w, judge, &ray, mode, &legal, formulas[f], &refused);
        }
        judge_free(judge);
        judged_world_free(&w);
    }
    while (held < STEPS_DOWN && refused.wrong[held + 1] == 0)
        held++;
    print_message("TRANSFORM: chosen 64, held %g, broke %g, of %llu answers; without it %llu are "
                  "refused\n",
                  ldexp(64.0, -held), held + 1 < STEPS_DOWN ? ldexp(64.0, -held - 1) : 0.0,
                  (unsigned long long)refused.answers,
                  (unsigned long long)refused.wrong[STEPS_DOWN]);
    assert_int_equal(refused.wrong[0], 0);
    assert_true(refused.wrong[STEPS_DOWN] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_transform_of_a_black_box_has_this_much_slack),
    };
    return cmocka_run_group_tests_name("bounds_world", tests, NULL, NULL) ? 1 : 0;
}
