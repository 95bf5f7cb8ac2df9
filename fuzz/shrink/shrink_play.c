/* Plays candidates: whether a trial still shows the finding. */
#include "fuzz/shrink/shrink_inner.h"
#include "fuzz/play/stage.h"

#include <string.h>

/* Findings of the same kind but of another cause that are passed over in one trial, at most. */
#define BEHIND_MOST 64u

static const struct fuzz_finding *of_kind(const struct fuzz_result *result, enum fuzz_kind kind)
{
    for (size_t i = 0; i < result->finding_count; i++)
        if (result->finding[i].signature.kind == kind)
            return &result->finding[i];
    return NULL;
}

/* Whether a trial with this result shows the finding. A result has only the first finding of a
 * kind, which may have another cause: then the rays behind it are played again. */
static enum status shows(struct shrink_asking *asking, const struct fuzz_trial *trial,
                         const struct fuzz_result *result, bool *out, struct reason *reason)
{
    struct fuzz_trial rest = *trial; /* borrows */
    struct fuzz_result again;
    uint32_t skipped = 0;
    *out = false;
    for (uint32_t tries = 0; tries < BEHIND_MOST; tries++) {
        const struct fuzz_finding *found = of_kind(result, asking->wanted->kind);
        if (!found)
            return STATUS_OK;
        struct fuzz_finding finding = *found;
        enum status status = fuzz_explain(asking->player, &rest, &finding, reason);
        if (status)
            return status;
        if (fuzz_signature_same(&finding.signature, asking->wanted)) {
            finding.ray += skipped;
            asking->finding = finding;
            *out = true;
            return STATUS_OK;
        }
        if (finding.ray + 1 >= rest.ray_count)
            return STATUS_OK;
        skipped += finding.ray + 1;
        rest = fuzz_trial_rays_from(trial, skipped, trial->ray_count - skipped);
        status = fuzz_play(asking->player, &rest, 1, &again, NULL, NULL, reason);
        if (status)
            return status;
        result = &again;
    }
    return STATUS_OK;
}

enum status shrink_ask_player(void *user, const struct fuzz_trial *candidate, size_t count,
                              size_t *first, struct reason *reason)
{
    struct shrink_asking *asking = user;
    struct fuzz_result result[SHRINK_BATCH];
    enum status status = fuzz_play(asking->player, candidate, count, result, NULL, NULL, reason);
    for (*first = 0; *first < count && !status; ++*first) {
        bool shown;
        status = shows(asking, &candidate[*first], &result[*first], &shown, reason);
        if (!status && shown)
            return STATUS_OK;
    }
    return status;
}

enum status shrink_check_who(const struct fuzz_contestant *who, const struct finding_file *file,
                             struct reason *reason)
{
    struct fuzz_signature mine = file->signature;
    if (!file->has_signature)
        return fail(reason, STATUS_INPUT, "a trial that shows nothing cannot be shrunk");
    fuzz_signature_set_engine(&mine, who->engine->name);
    mine.layout = who->layout;
    if (!fuzz_signature_same(&mine, &file->signature))
        return fail(reason, STATUS_INPUT, "shrinking needs the signature's engine and layout");
    return STATUS_OK;
}

enum status fuzz_shrink_finding(struct fuzz_player *alone, const struct finding_file *file,
                                const struct shrink_options *options, struct finding_file *out,
                                struct shrink_stats *stats, struct reason *reason)
{
    struct shrink_asking asking = {.player = alone, .wanted = &file->signature};
    const struct fuzz_contestant who = {alone->seat[0].engine, alone->seat[0].layout};
    *out = (struct finding_file){0};
    *stats = (struct shrink_stats){0};
    if (alone->contestants != 1)
        return fail(reason, STATUS_INPUT, "shrinking needs a player of one contestant");
    enum status status = shrink_check_who(&who, file, reason);
    struct fuzz_trial smaller;
    if (!status)
        status = fuzz_shrink_trial(&file->trial, shrink_ask_player, &asking, options, &smaller,
                                   stats, reason);
    if (status)
        return status;
    *out = *file;
    out->trial = smaller;
    stats->finding = asking.finding;
    return STATUS_OK;
}
