#include "ref/look/verdicts.h"

#include <math.h>
#include <stdlib.h>

#define TOGETHER 256 /* answers of a thread at a time */

enum status verdicts_make(const struct oracle *oracle, const struct judge *judge,
                          const struct ray *ray, const struct hit *answer, size_t count,
                          struct judgement *out, struct reason *reason)
{
    struct oracle_answer *truth = alloc_zeroed(count, sizeof *truth);
    struct judge_question *question = alloc_zeroed(count, sizeof *question);
    enum status status = truth && question ? STATUS_OK : STATUS_MEMORY;
    if (status)
        (void)fail(reason, status, "no memory to judge %zu answers", count);
    else
        status =
            oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count, 0, truth, NULL, reason);
    for (size_t i = 0; i < count && !status; i++)
        question[i] = (struct judge_question){&ray[i], &truth[i], &answer[i]};
    int failed = 0;
    if (!status) {
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : failed)
        for (size_t first = 0; first < count; first += TOGETHER) {
            size_t part = count - first < TOGETHER ? count - first : TOGETHER;
            failed += judge_answers(judge, question + first, part, out + first) != STATUS_OK;
        }
    }
    if (failed)
        status = fail(reason, STATUS_MEMORY, "no memory to judge %zu answers", count);
    free(truth);
    free(question);
    return status;
}

double verdict_error(const struct judgement *judgement, const struct hit *answer, bool unknown)
{
    if (answer->prim == ABI_NO_PRIM || judgement->verdict == VERDICT_OUT_OF_CONTRACT ||
        judgement->verdict == VERDICT_NOISE)
        return (double)NAN;
    return unknown ? judgement->share : judgement->over;
}
