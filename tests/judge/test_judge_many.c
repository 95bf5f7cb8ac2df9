/* Judging many answers at a time, with twins computed together, is judging each alone: answers of
 * the triangle tests, and those bent in every way. */
#include "tests/support/fuzz_trials.h"
#include "tests/judge/judge_fixture.h"
#include "tests/judge/judgement_laws.h"

#include "fuzz/gen/gen.h"
#include "ref/judge/judge_inner.h"
#include "ref/trace/trace.h"

#include <math.h>

#define TRIALS 120u
#define RAYS   67u /* neither a multiple of the vectors' lanes nor of what is judged together */

/* The answer of the subject's triangle test, or of something near it. */
static struct hit bend(struct rng *rng, const struct scene *scene, struct hit hit)
{
    float *number[] = {&hit.t, &hit.u, &hit.v};
    float *one = number[rng_below(rng, 3)];
    switch (rng_below(rng, 16)) {
    case 0:
        return (struct hit){.prim = ABI_NO_PRIM};
    case 1:
        hit.prim = rng_below(rng, scene->tri_count + 1);
        break;
    case 2:
        *one = nextafterf(*one, rng_below(rng, 2) ? INFINITY : -INFINITY);
        break;
    case 3:
        *one *= 1 + 0x1p-18f;
        break;
    case 4:
        *one = rng_below(rng, 2) ? NAN : 2 * *one + 1;
        break;
    default:
        break;
    }
    return hit;
}

static bool same_double(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* --- what is computed together: twin_eval_many is wrapped by the linker ---------------------- */

static struct twin_pair seen[1u << 16];
static size_t seen_count;

void __real_twin_eval_many(enum twin_formula formula, struct rounding rounding,
                           const struct scene *scene, const struct twin_pair *pair, size_t count,
                           struct twin *out);
void __wrap_twin_eval_many(enum twin_formula formula, struct rounding rounding,
                           const struct scene *scene, const struct twin_pair *pair, size_t count,
                           struct twin *out);
void __wrap_twin_eval_many(enum twin_formula formula, struct rounding rounding,
                           const struct scene *scene, const struct twin_pair *pair, size_t count,
                           struct twin *out)
{
    for (size_t i = 0; i < count && seen_count < ARRAY_COUNT(seen); i++)
        seen[seen_count++] = pair[i];
    __real_twin_eval_many(formula, rounding, scene, pair, count, out);
}

/* A twin that a question needs, if there is such a triangle, stands behind those before it: what is
 * computed besides, while answers are judged one after the other, comes later. */
static void must_see(const struct judge *judge, const struct judge_question *question,
                     uint32_t prim, size_t *next)
{
    if (prim >= judge->scene->tri_count)
        return;
    while (*next < seen_count && (seen[*next].ray != question->ray || seen[*next].prim != prim))
        ++*next;
    assert_true(*next < seen_count);
    ++*next;
}

/* In parts of questions, the exact nearest triangle and the answered one, once, of each ray that
 * is judged; for any-hit the answered one, of a miss the nearest, if the engine names it. */
static void check_seen(const struct judge *judge, const struct judge_question *question)
{
    size_t next = 0;
    for (size_t i = 0; i < RAYS; i++) {
        uint32_t nearest = question[i].truth->prim, answer = question[i].answer->prim;
        if (!judge->in_contract || !ray_in_contract(question[i].ray) ||
            judge->model.formula == TWIN_UNKNOWN)
            continue;
        if (judge->query == QUERY_CLOSEST)
            must_see(judge, &question[i], nearest, &next);
        if (judge->query == QUERY_CLOSEST && answer != nearest)
            must_see(judge, &question[i], answer, &next);
        if (judge->query != QUERY_CLOSEST && !judge->model.any_unnamed)
            must_see(judge, &question[i], answer == ABI_NO_PRIM ? nearest : answer, &next);
    }
    assert_true(seen_count < ARRAY_COUNT(seen));
}

static size_t behind_count;

/* Returns how many are not plainly right. */
static size_t compare(const struct oracle *oracle, const struct fixture_subject *subject,
                      const struct judge *judge, const struct judge_question *question)
{
    static struct judgement many[RAYS];
    size_t other = 0;
    seen_count = 0;
    assert_int_equal(judge_answers(judge, question, RAYS, many), STATUS_OK);
    check_seen(judge, question);
    for (size_t i = 0; i < RAYS; i++) {
        struct judgement one;
        assert_int_equal(
            judge_answer(judge, question[i].ray, question[i].truth, question[i].answer, &one),
            STATUS_OK);
        assert_int_equal(one.verdict, many[i].verdict);
        assert_int_equal(one.wrong, many[i].wrong);
        assert_int_equal(one.expected, many[i].expected);
        assert_true(same_double(one.t_lo, many[i].t_lo) && same_double(one.t_hi, many[i].t_hi));
        assert_true(same_double(one.over, many[i].over));
        assert_true(same_double(one.displacement, many[i].displacement));
        assert_true(same_double(one.share, many[i].share));
        assert_true(same_double(one.margin, many[i].margin));
        assert_int_equal(one.fan, many[i].fan);
        assert_int_equal(one.edge_lost, many[i].edge_lost);
        assert_int_equal(one.behind, many[i].behind);
        if (one.behind) {
            assert_int_equal(one.lost, many[i].lost);
            assert_true(same_double(one.lost_lo, many[i].lost_lo));
            assert_true(same_double(one.lost_hi, many[i].lost_hi));
            behind_count++;
        }
        check_laws(oracle, &subject->model, question[i].ray, question[i].truth, question[i].answer,
                   &one);
        other += one.verdict != VERDICT_RIGHT;
    }
    return other;
}

static void many_are_judged_as_each_alone(void **state)
{
    (void)state;
    const struct gen_options options = {
        .triangles_least = 1, .triangles_most = 40, .rays = RAYS, .faithful = true};
    size_t other[SUBJECTS] = {0};
    for (uint64_t n = 0; n < TRIALS; n++) {
        struct fuzz_trial trial;
        struct reason reason = {""};
        struct oracle *oracle = NULL;
        struct oracle_answer truth[RAYS];
        struct judge_question question[RAYS];
        struct hit hit[RAYS];
        struct rng rng = rng_make(5, n);
        if (gen_trial(21, n, &options, &trial, &reason) ||
            oracle_make(&trial.scene, &oracle, &reason) ||
            oracle_closest(oracle, ORACLE_AUTO, ORACLE_CLOSED, trial.ray, RAYS, 1, truth, NULL,
                           &reason))
            fail_msg("%s", reason.text);
        for (size_t s = 0; s < SUBJECTS; s++) {
            const struct tri_test *tri = tri_test_find(subjects[s].tri);
            struct judge *judge = NULL;
            assert_int_equal(judge_make(oracle, &subjects[s].model, trial.query, &judge, &reason),
                             STATUS_OK);
            for (size_t i = 0; i < RAYS; i++) {
                trace_brute(&trial.scene, tri, trial.query, &trial.ray[i], &hit[i]);
                hit[i] = bend(&rng, &trial.scene, hit[i]);
                question[i] = (struct judge_question){&trial.ray[i], &truth[i], &hit[i]};
            }
            other[s] += compare(oracle, &subjects[s], judge, question);
            judge_free(judge);
        }
        oracle_free(oracle);
        fuzz_trial_free(&trial);
    }
    for (size_t s = 0; s < SUBJECTS; s++)
        assert_true(other[s] > 500);
    assert_true(behind_count > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(many_are_judged_as_each_alone)};
    return cmocka_run_group_tests_name("judge_many", tests, NULL, NULL) ? 1 : 0;
}
