#include "ref/explain/imitate.h"

#include "ref/explain/witness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative distance within which t is the same of an engine that need not have C's bits. */
#define T_ALIKE 0x1p-18f

static bool alike(const struct explain_case *the, const struct explain_answer *a,
                  const struct explain_answer *b)
{
    if (!a->finished || !b->finished)
        return a->finished == b->finished;
    if (the->bits)
        return memcmp(&a->hit, &b->hit, sizeof a->hit) == 0;
    if (a->hit.prim != b->hit.prim)
        return false;
    return a->hit.prim == ABI_NO_PRIM || fabsf(a->hit.t - b->hit.t) <= T_ALIKE * fabsf(a->hit.t);
}

/* An engine that need not have C's bits may differ from the imitation in one witness in so many. */
#define STRAY_ONE_IN 20u

/* More witnesses are heard while two causes are as good. */
#define ROUNDS_MOST 40u

/* What C answers with the defect. */
static struct explain_answer imitated(const struct explain_case *the,
                                      const struct explain_imitation *one, const struct ray *ray)
{
    struct replay_change change = {.defect = one->defect, .parameter = one->parameter};
    struct explain_answer answer = {.flags = 0};
    answer.finished = replay_run(&the->replay, &change, ray, &answer.hit, NULL) == REPLAY_DONE;
    return answer;
}

/* Counts the witnesses that an imitation answers as the engine does. */
static void hear(const struct explain_case *the, const struct witnesses *w,
                 struct explain_imitation *one)
{
    for (uint32_t i = 0; i < w->count; i++) {
        struct explain_answer answer = imitated(the, one, &w->ray[i]);
        one->witnesses += alike(the, &answer, &w->answer[i]);
    }
}

static void try_defect(const struct explain_case *the, const struct explain_answer *answer,
                       const struct witnesses *w, enum defect defect, uint32_t parameter,
                       struct explanation *out)
{
    if (out->imitation_count == EXPLAIN_IMITATIONS)
        return;
    struct explain_imitation *one = &out->imitation[out->imitation_count++];
    *one = (struct explain_imitation){.defect = defect, .parameter = parameter};
    struct explain_answer own = imitated(the, one, &the->ray);
    one->same = alike(the, &own, answer);
    if (one->same)
        hear(the, w, one);
}

/* Parameters of a defect are tried in the order of this table. */
static void try_all(const struct explain_case *the, const struct explain_answer *answer,
                    const struct witnesses *w, struct explanation *out)
{
    static const uint32_t caps[] = {65535, 65536, 32767, 16383, 4095, 1023, 255};
    const struct explain_tree *tree = the->replay.tree;
    for (enum defect defect = DEFECT_NONE + 1; defect < DEFECT_COUNT; defect++) {
        if (defect == DEFECT_SLOT) {
            for (uint32_t slot = 8; tree && slot-- > 0;)
                try_defect(the, answer, w, defect, slot, out);
        } else if (defect == DEFECT_FAR_DROPPED) {
            uint32_t need = tree ? tree->packed->stack_need : 0;
            for (uint32_t most = need < ABI_STACK_MAX ? need : ABI_STACK_MAX; most-- > 0;)
                try_defect(the, answer, w, defect, most, out);
        } else if (defect == DEFECT_LOOP) {
            for (size_t i = 0; i < ARRAY_COUNT(caps); i++)
                try_defect(the, answer, w, defect, caps[i], out);
        } else if (tree || defect == DEFECT_ZERO || defect == DEFECT_EDGE_FUSED ||
                   defect == DEFECT_LAST_WINS) {
            try_defect(the, answer, w, defect, 0, out);
        }
    }
}

/* The imitation with the most witnesses, the earliest if several have. *rivals: whether another
 * cause has as many. */
static size_t best(const struct explanation *out, bool *rivals)
{
    size_t at = out->imitation_count;
    for (size_t i = 0; i < out->imitation_count; i++)
        if (out->imitation[i].same && (at == out->imitation_count ||
                                       out->imitation[i].witnesses > out->imitation[at].witnesses))
            at = i;
    *rivals = false;
    for (size_t i = at + 1; i < out->imitation_count; i++)
        *rivals = *rivals || (out->imitation[i].same &&
                              out->imitation[i].witnesses == out->imitation[at].witnesses &&
                              defect_cause(out->imitation[i].defect) !=
                                  defect_cause(out->imitation[at].defect));
    return at;
}

enum status explain_imitate(const struct explain_case *the, const struct explain_answer *answer,
                            struct explanation *out)
{
    bool rivals;
    struct witnesses *w = alloc_zeroed(1, sizeof *w);
    if (!w)
        return STATUS_MEMORY;
    witnesses_ask(the, 0, w);
    out->witness_count = w->count;
    try_all(the, answer, w, out);
    out->imitated = best(out, &rivals);
    for (uint32_t round = 1; rivals && w->count > 0 && round < ROUNDS_MOST; round++) {
        witnesses_ask(the, round, w);
        out->witness_count += w->count;
        for (size_t i = 0; i < out->imitation_count; i++)
            if (out->imitation[i].same)
                hear(the, w, &out->imitation[i]);
        out->imitated = best(out, &rivals);
    }
    uint32_t stray = the->bits ? 0 : out->witness_count / STRAY_ONE_IN;
    if (out->imitated < out->imitation_count &&
        out->imitation[out->imitated].witnesses + stray >= out->witness_count)
        out->cause = defect_cause(out->imitation[out->imitated].defect);
    else
        out->cause = the->exact ? CAUSE_SHADER : CAUSE_DRIVER_ARITHMETIC;
    free(w);
    return STATUS_OK;
}
