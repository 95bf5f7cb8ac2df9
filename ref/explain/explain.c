#include "ref/explain/explain.h"

#include "ref/explain/imitate.h"
#include "ref/explain/way.h"

#include <stdlib.h>
#include <string.h>

static bool same_bits(const struct hit *a, const struct hit *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* Answers the ray in C with the repairs of the mask. */
static void run(const struct explain_case *the, uint32_t repairs, struct explain_attempt *out)
{
    struct replay_change change = {.repairs = repairs};
    out->end = replay_run(&the->replay, &change, &the->ray, &out->hit, NULL);
    out->opinion = (struct opinion){.text = "not finished", .expected = ABI_NO_PRIM};
    if (out->end == REPLAY_DONE)
        the->judge(the->judge_user, &the->ray, &out->hit, &out->opinion);
}

/* Tries every repair alone. Returns the cause of the first that helps, or CAUSE_UNEXPLAINED. */
static enum cause try_one(const struct explain_case *the, struct explanation *out)
{
    enum cause cause = CAUSE_UNEXPLAINED;
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++) {
        struct explain_attempt *attempt = &out->attempt[out->attempt_count++];
        attempt->repair = repair;
        run(the, 1u << repair, attempt);
        attempt->changed =
            attempt->end != out->replayed_end || !same_bits(&attempt->hit, &out->replayed);
        if (attempt->opinion.allowed && cause == CAUSE_UNEXPLAINED)
            cause = repair_cause(repair);
    }
    return cause;
}

/* Two faults on one ray: the first pair that helps. */
static void try_two(const struct explain_case *the, struct explanation *out)
{
    for (enum repair a = 0; a < REPAIR_COUNT; a++)
        for (enum repair b = a + 1; b < REPAIR_COUNT; b++) {
            struct explain_attempt attempt;
            run(the, 1u << a | 1u << b, &attempt);
            if (attempt.opinion.allowed) {
                out->cause = repair_cause(a);
                out->with = repair_cause(b);
                return;
            }
        }
}

/* C answers as the engine did: what is wrong is in the bytes or in C. */
static void repair_inside(const struct explain_case *the, struct explanation *out)
{
    out->inside = true;
    out->cause = try_one(the, out);
    if (out->cause == CAUSE_UNEXPLAINED)
        try_two(the, out);
}

/* The engine did not finish. If C does not either, repairs say why; else the engine's own flags do,
 * and if they say only that it went in circles, or nothing, an imitation. */
static enum status explain_unfinished(const struct explain_case *the,
                                      const struct explain_answer *answer, struct explanation *out)
{
    out->cause = CAUSE_STACK;
    if (out->replayed_end != REPLAY_DONE)
        repair_inside(the, out);
    else if (answer->flags & ABI_FLAG_STACK)
        return STATUS_OK;
    else if (answer->flags & ABI_FLAG_VISITS || !(answer->flags & ABI_FLAG_LOOP))
        return explain_imitate(the, answer, out);
    else
        out->cause = CAUSE_LOOP_CAP; /* the visits alone would end the loop as well */
    return STATUS_OK;
}

static bool repeats(const struct explain_case *the, const struct hit *hit)
{
    struct hit again;
    return !the->ask || !the->ask(the->ask_user, &the->ray, 1, &again) || same_bits(&again, hit);
}

/* The engine finished with something that is not allowed, or not C's. */
static enum status explain_answered(const struct explain_case *the,
                                    const struct explain_answer *answer, struct explanation *out)
{
    const struct hit *hit = &answer->hit;
    bool same = out->replayed_end == REPLAY_DONE && same_bits(hit, &out->replayed);
    if (!repeats(the, hit)) {
        out->cause = CAUSE_NOT_REPEATABLE;
    } else if (out->opinion.allowed && (same || !the->bits)) {
        out->cause = CAUSE_NONE;
    } else if (!the->known) {
        out->cause = CAUSE_OUTSIDE;
    } else if (same) {
        repair_inside(the, out);
    } else {
        return explain_imitate(the, answer, out);
    }
    return STATUS_OK;
}

enum status explain_make(const struct explain_case *the, const struct explain_answer *answer,
                         struct explanation *out, struct reason *reason)
{
    struct explain_attempt plain;
    enum status status = STATUS_OK;
    *out = (struct explanation){.prim = ABI_NO_PRIM, .opinion.expected = ABI_NO_PRIM};
    run(the, 0, &plain);
    out->replayed_end = plain.end;
    out->replayed = plain.hit;
    out->replayed_opinion = plain.opinion;
    if (answer->finished) {
        the->judge(the->judge_user, &the->ray, &answer->hit, &out->opinion);
        status = explain_answered(the, answer, out);
    } else {
        /* A miss, to learn what should have been answered. */
        struct hit miss = {.prim = ABI_NO_PRIM};
        the->judge(the->judge_user, &the->ray, &miss, &out->opinion);
        out->opinion.allowed = false;
        out->opinion.text = "not finished";
        status = explain_unfinished(the, answer, out);
    }
    out->prim = out->opinion.expected;
    if (!status)
        status = explain_way(the, out);
    if (status) {
        explain_free(out);
        return fail(reason, status, "no memory to explain a ray");
    }
    return STATUS_OK;
}

void explain_free(struct explanation *explanation)
{
    free(explanation->step);
    *explanation = (struct explanation){0};
}
