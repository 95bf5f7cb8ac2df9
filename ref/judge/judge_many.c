/* Many answers at a time. Most of a judge's time goes into twins, so those that will be needed are
 * computed together, by vectors: of the exact nearest triangle and of the answered one. */
#include "ref/judge/judge_inner.h"

#define MANY 32u

/* A part of the questions. */
struct many {
    const struct judge *judge;
    const struct judge_question *question;
    size_t count;
    bool in_contract[MANY];
    struct judge_known known[MANY];
    struct twin_pair pair[JUDGE_KNOWN_MOST * MANY];
    struct twin twin[JUDGE_KNOWN_MOST * MANY];
    size_t pairs;
};

static void know(struct many *many, size_t i, uint32_t prim)
{
    struct judge_known *known = &many->known[i];
    if (prim >= many->judge->scene->tri_count || (known->count && known->prim[0] == prim))
        return;
    known->prim[known->count++] = prim;
    many->pair[many->pairs++] = (struct twin_pair){many->question[i].ray, prim};
}

/* Lists the twins that question i will need; one too few costs only time. */
static void foresee(struct many *many, size_t i)
{
    const struct judge *judge = many->judge;
    const struct judge_question *question = &many->question[i];
    uint32_t nearest = question->truth->prim, answer = question->answer->prim;
    many->known[i].count = 0;
    many->in_contract[i] = judge->in_contract && ray_in_contract(question->ray);
    if (!many->in_contract[i] || judge->model.formula == TWIN_UNKNOWN)
        return;
    if (judge->query == QUERY_CLOSEST) {
        know(many, i, nearest);
        know(many, i, answer);
    } else if (!judge->model.any_unnamed) {
        know(many, i, answer == ABI_NO_PRIM ? nearest : answer);
    }
}

static enum status judge_part(struct many *many, struct judgement *out)
{
    const struct judge *judge = many->judge;
    enum status status = STATUS_OK;
    size_t at = 0;
    many->pairs = 0;
    for (size_t i = 0; i < many->count; i++)
        foresee(many, i);
    twin_eval_many(judge->model.formula, judge->model.rounding, judge->scene, many->pair,
                   many->pairs, many->twin);
    for (size_t i = 0; i < many->count; i++) {
        const struct judge_question *question = &many->question[i];
        struct judge_known *known = &many->known[i];
        for (size_t k = 0; k < known->count; k++)
            known->twin[k] = many->twin[at++];
        enum status one = judge_knowing(judge, question->ray, many->in_contract[i], question->truth,
                                        question->answer, known, &out[i]);
        if (one)
            status = one;
    }
    return status;
}

enum status judge_answers(const struct judge *judge, const struct judge_question *question,
                          size_t count, struct judgement *out)
{
    enum status status = STATUS_OK;
    struct many many; /* large, and filled where it is used */
    many.judge = judge;
    for (size_t first = 0; first < count; first += MANY) {
        many.question = question + first;
        many.count = count - first < MANY ? count - first : MANY;
        enum status one = judge_part(&many, out + first);
        if (one)
            status = one;
    }
    return status;
}
