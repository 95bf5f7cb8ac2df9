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

/* An engine that need not have C's bits may differ from the imitation on one ray in this many, of
 * all rays and of those that are evidence. */
#define STRAY_ONE_IN 20u

/* Rays of evidence that are enough, if no other cause is left. */
#define TELLING_ENOUGH 32u
#define ROUNDS_MOST    40u
/* Defects that few rays show are searched longer, by rays at vertices and along edges. */
#define ROUNDS_FAR 200u

/* The answer of C with the defect; DEFECT_NONE: without. */
static struct explain_answer imitated(const struct explain_case *the, enum defect defect,
                                      uint32_t parameter, const struct ray *ray)
{
    struct replay_change change = {.defect = defect, .parameter = parameter};
    struct explain_answer answer = {.flags = 0};
    answer.finished = replay_run(&the->replay, &change, ray, &answer.hit, NULL) == REPLAY_DONE;
    return answer;
}

static bool is_alive(const struct explain_imitation *one)
{
    return one->same && !one->refuted;
}

static uint32_t stray_of(const struct explain_case *the, uint32_t rays)
{
    return the->bits ? 0 : rays / STRAY_ONE_IN;
}

/* Compares an imitation with the engine on the witnesses. */
static void hear(const struct explain_case *the, const struct witnesses *w,
                 struct explain_imitation *one)
{
    for (uint32_t i = 0; i < w->count; i++) {
        struct explain_answer own = imitated(the, one->defect, one->parameter, &w->ray[i]);
        bool agrees = alike(the, &own, &w->answer[i]);
        bool tells = !alike(the, &own, &w->healthy[i]);
        one->witnesses += agrees;
        one->telling += tells;
        one->told += tells && agrees;
        one->kept += agrees && own.finished && own.hit.prim != ABI_NO_PRIM;
        one->far_telling += tells && w->is_far[i];
        one->far_told += tells && w->is_far[i] && agrees;
    }
    one->asked += w->count;
    one->refuted = one->asked - one->witnesses > stray_of(the, one->asked) ||
                   one->telling - one->told > stray_of(the, one->telling) ||
                   one->far_telling - one->far_told > stray_of(the, one->far_telling);
}

static void try_defect(const struct explain_case *the, const struct explain_answer *answer,
                       enum defect defect, uint32_t parameter, struct explanation *out)
{
    if (out->imitation_count == EXPLAIN_IMITATIONS)
        return;
    struct explain_imitation *one = &out->imitation[out->imitation_count++];
    *one = (struct explain_imitation){.defect = defect, .parameter = parameter};
    struct explain_answer own = imitated(the, defect, parameter, &the->ray);
    one->same = alike(the, &own, answer);
}

/* Parameters of a defect are tried in the order of this table. */
static void try_all(const struct explain_case *the, const struct explain_answer *answer,
                    struct explanation *out)
{
    static const uint32_t caps[] = {65535, 65536, 32767, 16383, 4095, 1023, 255};
    static const uint32_t pads[] = {0, 2, 4, 6}; /* none, an ulp, and what is copied widely */
    const struct explain_tree *tree = the->replay.tree;
    for (enum defect defect = DEFECT_NONE + 1; defect < DEFECT_COUNT; defect++) {
        if (defect == DEFECT_SLOT) {
            for (uint32_t slot = 8; tree && slot-- > 0;)
                try_defect(the, answer, defect, slot, out);
        } else if (defect == DEFECT_FAR_DROPPED || defect == DEFECT_STACK_FULL) {
            uint32_t need = tree ? tree->packed->stack_need : 0;
            for (uint32_t most = need < ABI_STACK_MAX ? need : ABI_STACK_MAX; most-- > 0;)
                try_defect(the, answer, defect, most, out);
        } else if (defect == DEFECT_LOOP) {
            for (size_t i = 0; i < ARRAY_COUNT(caps); i++)
                try_defect(the, answer, defect, caps[i], out);
        } else if (defect == DEFECT_NOT_PADDED) {
            for (size_t i = 0; tree && i < ARRAY_COUNT(pads); i++)
                try_defect(the, answer, defect, pads[i], out);
        } else if (tree || defect == DEFECT_ZERO || defect == DEFECT_EDGE_FUSED ||
                   defect == DEFECT_LAST_WINS) {
            try_defect(the, answer, defect, 0, out);
        }
    }
}

/* The imitation of those that are alive, or else of all that give the answer, with the most
 * witnesses; the earliest if several have. */
static size_t best(const struct explanation *out)
{
    size_t at = out->imitation_count;
    for (size_t i = 0; i < out->imitation_count; i++) {
        const struct explain_imitation *one = &out->imitation[i];
        if (!one->same)
            continue;
        const struct explain_imitation *old = &out->imitation[at];
        if (at == out->imitation_count || (is_alive(one) && !is_alive(old)) ||
            (is_alive(one) == is_alive(old) && one->witnesses > old->witnesses))
            at = i;
    }
    return at;
}

/* Whether rays of this round could be useful: an imitation with too little evidence is alive, or
 * two with different causes are. */
static bool is_open(const struct explanation *out, uint32_t round)
{
    const struct explain_imitation *first = NULL;
    bool open = false;
    if (round >= ROUNDS_FAR)
        return false;
    for (size_t i = 0; i < out->imitation_count; i++) {
        const struct explain_imitation *one = &out->imitation[i];
        if (!is_alive(one))
            continue;
        open = open || one->far_telling < EXPLAIN_TELLING;
        if (round >= ROUNDS_MOST)
            continue;
        open = open || one->telling < TELLING_ENOUGH ||
               (first && defect_cause(first->defect) != defect_cause(one->defect));
        first = one;
    }
    return open;
}

/* Keeps the rays to which an imitation that is alive answers otherwise than C, and hits of one that
 * has shown too few. */
static void keep_telling(const struct explain_case *the, const struct explanation *out,
                         struct witnesses *w)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        bool tells = false;
        for (size_t k = 0; k < out->imitation_count && !tells; k++) {
            const struct explain_imitation *one = &out->imitation[k];
            if (!is_alive(one))
                continue;
            struct explain_answer own = imitated(the, one->defect, one->parameter, &w->ray[i]);
            tells = !alike(the, &own, &w->healthy[i]) ||
                    (one->kept < EXPLAIN_TELLING && own.finished && own.hit.prim != ABI_NO_PRIM);
        }
        if (!tells)
            continue;
        w->ray[kept] = w->ray[i];
        w->is_far[kept] = w->is_far[i];
        w->healthy[kept++] = w->healthy[i];
    }
    w->count = kept;
}

/* One round: rays of all kinds first, then only those that are evidence. */
static void ask_round(const struct explain_case *the, uint32_t round, struct witnesses *w,
                      struct explanation *out)
{
    enum witness_kind few = round % 2 ? WITNESS_ALONG : WITNESS_VERTICES;
    witnesses_make(the, round, round >= ROUNDS_MOST ? few : WITNESS_ALL, w);
    for (uint32_t i = 0; i < w->count; i++)
        w->healthy[i] = imitated(the, DEFECT_NONE, 0, &w->ray[i]);
    if (round > 0)
        keep_telling(the, out, w);
    witnesses_ask(the, w);
    out->witness_count += w->count;
    for (size_t i = 0; i < out->imitation_count; i++)
        if (is_alive(&out->imitation[i]))
            hear(the, w, &out->imitation[i]);
}

/* The cause if no known defect predicts the answers: only that C answers otherwise. An allowed
 * answer lies within what the engine's own operators may give. */
static enum cause cause_left(const struct explain_case *the, const struct explanation *out)
{
    if (the->exact)
        return CAUSE_SHADER;
    return out->opinion.allowed ? CAUSE_DRIVER_ARITHMETIC : CAUSE_UNEXPLAINED;
}

bool explain_is_shown(const struct explain_imitation *one)
{
    bool holds_nothing = one->defect == DEFECT_FAR_DROPPED && one->parameter == 0;
    return is_alive(one) && one->telling >= EXPLAIN_TELLING && one->kept >= EXPLAIN_TELLING &&
           !holds_nothing;
}

enum status explain_imitate(const struct explain_case *the, const struct explain_answer *answer,
                            struct explanation *out)
{
    struct witnesses *w = alloc_zeroed(1, sizeof *w);
    if (!w)
        return STATUS_MEMORY;
    try_all(the, answer, out);
    bool asks = the->ask && the->replay.scene->tri_count > 0;
    for (uint32_t round = 0; asks && is_open(out, round); round++)
        ask_round(the, round, w, out);
    out->imitated = best(out);
    if (out->imitated < out->imitation_count && explain_is_shown(&out->imitation[out->imitated]))
        out->cause = defect_cause(out->imitation[out->imitated].defect);
    else
        out->cause = cause_left(the, out);
    free(w);
    return STATUS_OK;
}
