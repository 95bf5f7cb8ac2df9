/* Laws of every judgement, whatever the answer. Include after cmocka.h. */
#ifndef JUDGEMENT_LAWS_H
#define JUDGEMENT_LAWS_H

#include "ref/judge/judge.h"

#include <math.h>

/* The exact hit that a judgement names, and the interval that it gives for t. */
static inline void check_named_hit(const struct oracle *oracle, const struct ray *ray,
                                   uint32_t prim, double t_lo, double t_hi)
{
    struct oracle_pair pair;
    oracle_pair(oracle, ray, prim, &pair);
    assert_true(oracle_is_hit(&pair));
    assert_true(t_lo <= t_hi && t_lo <= pair.t_hi && pair.t_lo <= t_hi);
    assert_true(t_hi - t_lo <= 1e-3 * (1 + fabs(t_lo)));
}

static inline void check_unknown(const struct judgement *j, const struct hit *answer)
{
    assert_true(j->displacement >= 0 && j->share >= 0 && j->margin >= 0);
    if (j->verdict != VERDICT_WRONG)
        assert_true(j->share <= 1);
    if (j->wrong == WRONG_MISSED)
        assert_true(j->share > 1);
    if (j->edge_lost)
        assert_true(answer->prim != j->expected);
}

static inline void check_laws(const struct oracle *oracle, const struct model *model,
                              const struct ray *ray, const struct oracle_answer *truth,
                              const struct hit *answer, const struct judgement *j)
{
    assert_true((j->verdict == VERDICT_WRONG) == (j->wrong != WRONG_NOT));
    if (j->verdict == VERDICT_OUT_OF_CONTRACT)
        return;
    assert_int_equal(j->expected, truth->prim);
    if (j->expected != ABI_NO_PRIM) {
        check_named_hit(oracle, ray, j->expected, j->t_lo, j->t_hi);
        assert_true(j->t_lo == truth->t_lo && j->t_hi == truth->t_hi);
    }
    assert_true(j->over >= 0);
    if (j->verdict != VERDICT_WRONG)
        assert_true(j->over <= 1);
    if (j->behind) {
        assert_int_equal(j->wrong, WRONG_MISSED);
        assert_int_not_equal(j->lost, j->expected);
        check_named_hit(oracle, ray, j->lost, j->lost_lo, j->lost_hi);
        assert_true(j->lost_hi >= j->t_lo);
        /* Of the answer it is in front. */
        assert_true(answer->prim == ABI_NO_PRIM || j->lost_lo <= (double)answer->t);
    }
    if (j->wrong == WRONG_MISSED)
        assert_int_not_equal(answer->prim, j->behind ? j->lost : j->expected);
    if (model->formula == TWIN_UNKNOWN)
        check_unknown(j, answer);
    else
        assert_true(j->displacement == 0 && j->share == 0 && j->margin == 0 && !j->edge_lost);
}

#endif
