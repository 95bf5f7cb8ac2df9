/* The shrinker: rounds of passes over the smallest trial so far, until a whole round finds nothing
 * smaller. A pass depends on the smallest trial alone, so that shrinking the result again repeats
 * the last round and changes nothing. */
#include "fuzz/shrink/shrink.h"

#include "fuzz/shrink/shrink_inner.h"
#include "fuzz/play/number_set.h"

#include <stdlib.h>
#include <string.h>

/* Triangles of all candidates of a call, at most, unless one has more. */
#define BATCH_TRIANGLES 65536u
/* Triangles, rays or instances that cost one more ask. */
#define THINGS_PER_ASK 64u
/* The share of all asks that one level of a pass may need: dearer levels are left out. */
#define LEVEL_SHARE 4u

/* Where in a pass. */
struct shrink_place {
    uint32_t chunk, first, variant;
};

struct shrinker {
    struct fuzz_trial best;
    struct fuzz_trial_size size; /* of it */
    shrink_ask_fn *ask;
    void *user;
    const struct shrink_options *options;
    struct shrink_stats *stats;
    uint64_t most, start;
    struct number_set seen; /* hashes, with bit 0 set, of trials that did not show it */
    struct fuzz_trial candidate[SHRINK_BATCH];
    struct shrink_place place[SHRINK_BATCH]; /* of each */
    uint64_t hash[SHRINK_BATCH];
    size_t count, patience; /* candidates, and how many there may be */
    bool over, left_out;    /* left_out: in this round, something that was too dear */
};

const char *shrink_end_name(enum shrink_end end)
{
    static const char *const name[] = {"fixpoint", "asks", "time", "not shown"};
    return name[end];
}

static uint64_t cost(const struct fuzz_trial *trial)
{
    return 1 + trial->scene.tri_count / THINGS_PER_ASK + trial->ray_count / THINGS_PER_ASK +
           trial->world.instance_count / THINGS_PER_ASK;
}

/* --- places of a pass ------------------------------------------------------------------------ */

/* A level that costs too much is left out, which depends on the trial and the budget alone. */
static bool affordable(struct shrinker *s, const struct shrink_pass *pass, uint32_t things,
                       uint32_t chunk)
{
    uint64_t chunks = ((uint64_t)things + chunk - 1) / chunk;
    if (pass->way == SHRINK_ENDS ||
        chunks * pass->variants * cost(&s->best) <= s->most / LEVEL_SHARE)
        return true;
    s->left_out = true;
    return false;
}

/* The place after, or false. */
static bool step(struct shrinker *s, const struct shrink_pass *pass, uint32_t things,
                 struct shrink_place *at)
{
    if (at->variant + 1 < pass->variants && at->first < things) {
        at->variant++;
        return true;
    }
    at->variant = 0;
    bool ends = pass->way == SHRINK_ENDS && at->first + at->chunk < things;
    at->first = ends ? things - at->chunk : at->first + at->chunk;
    while (at->first >= things) {
        if (at->chunk == 1)
            return false;
        at->first = 0;
        at->chunk = (at->chunk + 1) / 2;
        if (!affordable(s, pass, things, at->chunk))
            return false; /* smaller ones are dearer */
    }
    return true;
}

static void clear_candidates(struct shrinker *s)
{
    for (size_t i = 0; i < s->count; i++)
        fuzz_trial_free(&s->candidate[i]);
    s->count = 0;
}

/* True if it is a trial, smaller than the best, not known to show nothing and not among the
 * candidates. Sizes are compared without the hash, which makes a trial no easier to read. */
static bool worth_asking(struct shrinker *s, const struct fuzz_trial *trial)
{
    struct fuzz_trial_size size = fuzz_trial_size(trial), best = s->size;
    uint64_t hash = size.hash;
    best.hash = hash;
    if (fuzz_trial_size_compare(&size, &best) >= 0 || fuzz_trial_check(trial, NULL) ||
        number_set_has(&s->seen, hash | 1))
        return false;
    for (size_t i = 0; i < s->count; i++)
        if (s->hash[i] == hash)
            return false;
    s->hash[s->count] = hash;
    return true;
}

/* Makes candidates from place *at on, which moves behind the last one; *more: there are places
 * left. */
static enum status gather(struct shrinker *s, const struct shrink_pass *pass, uint32_t things,
                          struct shrink_place *at, bool *more, struct reason *reason)
{
    uint32_t most = BATCH_TRIANGLES / (s->best.scene.tri_count + 1) + 1;
    size_t wanted = s->patience < most ? s->patience : most;
    *more = true;
    while (s->count < wanted && *more) {
        struct fuzz_trial *trial = &s->candidate[s->count];
        uint32_t left = things - at->first;
        enum status status = fuzz_trial_copy(&s->best, trial, reason);
        if (status)
            return status;
        if (pass->change(trial, at->first, at->chunk < left ? at->chunk : left, at->variant) &&
            worth_asking(s, trial))
            s->place[s->count++] = *at;
        else
            fuzz_trial_free(trial);
        *more = step(s, pass, things, at);
    }
    return STATUS_OK;
}

/* --- asking ---------------------------------------------------------------------------------- */

static void stop(struct shrinker *s, enum shrink_end why)
{
    s->over = true;
    s->stats->end = why;
}

/* Plays the candidates for which there are asks; *first is the first that shows the finding, or
 * s->count. Those behind it cost nothing, so that the size of a batch makes no difference. */
static enum status ask(struct shrinker *s, size_t *first, struct reason *reason)
{
    size_t paid = 0, shown;
    uint64_t asks = s->stats->asks;
    *first = s->count;
    if (s->options->ns && time_ns() - s->start > s->options->ns) {
        stop(s, SHRINK_OUT_OF_TIME);
        return STATUS_OK;
    }
    while (paid < s->count && asks + cost(&s->candidate[paid]) <= s->most)
        asks += cost(&s->candidate[paid++]);
    enum status status = paid ? s->ask(s->user, s->candidate, paid, &shown, reason) : STATUS_OK;
    for (size_t i = 0; i < paid && !status; i++) {
        s->stats->asks += cost(&s->candidate[i]);
        s->stats->tried++;
        if (i == shown) {
            *first = i;
            return STATUS_OK;
        }
        if (!number_set_add(&s->seen, s->hash[i] | 1))
            status = fail(reason, STATUS_MEMORY, "no memory to shrink a trial");
    }
    if (paid < s->count)
        stop(s, SHRINK_OUT_OF_ASKS);
    return status;
}

static void accept(struct shrinker *s, size_t i)
{
    fuzz_trial_free(&s->best);
    s->best = s->candidate[i];
    s->candidate[i] = (struct fuzz_trial){0};
    s->size = fuzz_trial_size(&s->best);
    s->stats->accepted++;
    s->stats->after = s->size;
}

static enum status run_pass(struct shrinker *s, const struct shrink_pass *pass,
                            struct reason *reason)
{
    uint32_t things = pass->things(&s->best);
    struct shrink_place at = {.chunk = pass->way == SHRINK_SINGLY ? 1 : things};
    bool more = things > 0 && affordable(s, pass, things, at.chunk);
    enum status status = STATUS_OK;
    while (more && !s->over && !status) {
        size_t first = 0;
        status = gather(s, pass, things, &at, &more, reason);
        if (!status && s->count)
            status = ask(s, &first, reason);
        if (!status && first < s->count) {
            at = s->place[first];
            at.variant = 0;
            accept(s, first);
            things = pass->things(&s->best);
            at.chunk = at.chunk < things ? at.chunk : things;
            more = things > 0 && (at.first < things || step(s, pass, things, &at));
            s->patience = 1;
        } else if (s->patience < SHRINK_BATCH) {
            s->patience *= 2; /* most are rejected: play more at a time */
        }
        clear_candidates(s);
        if (s->options->progress)
            s->options->progress(s->options->user, s->stats, &s->best);
    }
    return status;
}

static enum status run_rounds(struct shrinker *s, struct reason *reason)
{
    enum status status = STATUS_OK;
    uint64_t before;
    do {
        before = s->stats->accepted;
        s->stats->rounds++;
        s->left_out = false;
        for (size_t i = 0; shrink_passes[i] && !s->over && !status; i++)
            status = run_pass(s, shrink_passes[i], reason);
    } while (!status && !s->over && s->stats->accepted > before);
    if (!s->over && s->left_out)
        s->stats->end = SHRINK_OUT_OF_ASKS;
    return status;
}

enum status fuzz_shrink_trial(const struct fuzz_trial *from, shrink_ask_fn *ask_user, void *user,
                              const struct shrink_options *options, struct fuzz_trial *out,
                              struct shrink_stats *stats, struct reason *reason)
{
    struct shrinker s = {.ask = ask_user,
                         .user = user,
                         .options = options,
                         .stats = stats,
                         .most = options->asks ? options->asks : SHRINK_ASKS,
                         .start = time_ns(),
                         .patience = 1};
    size_t first = 1;
    *out = (struct fuzz_trial){0};
    *stats = (struct shrink_stats){.end = SHRINK_FIXPOINT};
    enum status status = fuzz_trial_copy(from, &s.best, reason);
    if (status)
        return status;
    s.size = stats->before = stats->after = fuzz_trial_size(from);
    stats->asks = cost(from);
    stats->tried = 1;
    status = ask_user(user, from, 1, &first, reason);
    if (!status && first > 0)
        stop(&s, SHRINK_NOT_SHOWN);
    else if (!status)
        status = run_rounds(&s, reason);
    clear_candidates(&s);
    free(s.seen.slot);
    if (status)
        fuzz_trial_free(&s.best);
    else
        *out = s.best;
    return status;
}
