#include "ref/explain/explain.h"

#include "ref/explain/imitate.h"
#include "ref/explain/path.h"

#include <stdlib.h>
#include <string.h>

static bool same_bits(const struct hit *a, const struct hit *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* Traces the ray in C with the repairs of the mask. */
static void run(const struct explain_case *the, uint32_t repairs, struct explain_attempt *out)
{
    struct replay_change change = {.repairs = repairs};
    out->end = replay_run(&the->replay, &change, &the->ray, &out->hit, NULL);
    out->opinion = (struct opinion){.text = "not finished", .expected = ABI_NO_PRIM};
    if (out->end == REPLAY_DONE)
        the->judge(the->judge_user, &the->ray, &out->hit, &out->opinion);
}

/* Repairs that make a traversal forgiving: each can find a triangle in spite of wrong bytes, so
 * that they prove something only if nothing else helps. */
#define FORGIVING                                                                                  \
    (1u << REPAIR_BOX_TEST | 1u << REPAIR_ORIENTED_TEST | 1u << REPAIR_WATERTIGHT |                \
     1u << REPAIR_CULLING | 1u << REPAIR_TRIANGLE)
#define EVERYTHING ((1u << REPAIR_COUNT) - 1)

/* Tries every repair alone. */
static void try_each(const struct explain_case *the, struct explanation *out)
{
    for (enum repair repair = 0; repair < REPAIR_COUNT; repair++) {
        struct explain_attempt *attempt = &out->attempt[out->attempt_count++];
        attempt->repair = repair;
        run(the, 1u << repair, attempt);
        attempt->changed =
            attempt->end != out->replayed_end || !same_bits(&attempt->hit, &out->replayed);
    }
}

/* The first repair of `among` that helps alone, or REPAIR_COUNT. */
static enum repair first_that_helps(const struct explanation *out, uint32_t among)
{
    for (size_t i = 0; i < out->attempt_count; i++)
        if ((among >> out->attempt[i].repair & 1u) && out->attempt[i].opinion.allowed)
            return out->attempt[i].repair;
    return REPAIR_COUNT;
}

/* For several faults on one ray: of the repairs `all`, the rest when each that is not needed is
 * removed, the least specific first; 0 if all together do not help. */
static uint32_t least_that_helps(const struct explain_case *the, uint32_t all)
{
    struct explain_attempt attempt;
    run(the, all, &attempt);
    if (!attempt.opinion.allowed)
        return 0;
    for (enum repair repair = REPAIR_COUNT; repair-- > 0;) {
        if (!(all >> repair & 1u))
            continue;
        run(the, all & ~(1u << repair), &attempt);
        if (attempt.opinion.allowed)
            all &= ~(1u << repair);
    }
    return all;
}

/* C answers as the engine did: the fault is in the bytes or in C. */
static void repair_inside(const struct explain_case *the, struct explanation *out)
{
    out->inside = true;
    try_each(the, out);
    enum repair first = first_that_helps(out, EVERYTHING & ~FORGIVING);
    if (first == REPAIR_COUNT)
        out->needed = least_that_helps(the, EVERYTHING & ~FORGIVING);
    if (first == REPAIR_COUNT && !out->needed)
        first = first_that_helps(out, FORGIVING);
    if (first == REPAIR_COUNT && !out->needed) /* the watertight box test allows for more */
        out->needed = least_that_helps(the, EVERYTHING & ~(1u << REPAIR_BOX_TEST));
    if (first == REPAIR_COUNT && !out->needed)
        out->needed = least_that_helps(the, EVERYTHING);
    if (first == REPAIR_COUNT)
        for (first = 0; first < REPAIR_COUNT && !(out->needed >> first & 1u);)
            first++;
    out->cause = first < REPAIR_COUNT ? repair_cause(first) : CAUSE_UNEXPLAINED;
}

/* The engine did not finish. If C does not either, repairs tell why; else an imitation. A full
 * stack can be the consequence of another fault: a shorter stack has to be shown by other rays, if
 * the engine can trace them. */
static enum status explain_unfinished(const struct explain_case *the,
                                      const struct explain_answer *answer, struct explanation *out)
{
    out->cause = CAUSE_STACK;
    if (out->replayed_end != REPLAY_DONE)
        repair_inside(the, out);
    else if ((answer->flags & ABI_FLAG_STACK) && !the->ask)
        return STATUS_OK; /* its own flag is the only evidence */
    else if (answer->flags & (ABI_FLAG_STACK | ABI_FLAG_VISITS) || !(answer->flags & ABI_FLAG_LOOP))
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

/* The engine finished with an answer that is not allowed, or is not C's. */
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
        const struct hit miss = hit_none();
        the->judge(the->judge_user, &the->ray, &miss, &out->opinion);
        out->opinion.allowed = false;
        out->opinion.text = "not finished";
        status = explain_unfinished(the, answer, out);
    }
    out->prim = out->opinion.expected;
    if (!status)
        status = explain_path(the, out);
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
