/* Work on findings: shrinking them, and playing again what did not show twice. */
#include "fuzz/campaign/campaign_inner.h"

#include <string.h>

/* Bounds of shrinking while trials are played; raydiff min can shrink further. */
#define SOON_ASKS 8000u
#define SOON_NS   10000000000u

static const struct findings_entry *entry_of(const struct campaign *c, size_t i)
{
    return findings_entry(c->findings, i);
}

enum status campaign_marks_update(struct campaign *c)
{
    void *array = c->mark;
    if (array_reserve(&array, &c->mark_capacity, findings_count(c->findings), sizeof *c->mark))
        return fail(c->reason, STATUS_MEMORY, "no memory for %zu findings",
                    findings_count(c->findings));
    c->mark = array;
    for (; c->marks < findings_count(c->findings); c->marks++) {
        struct campaign_mark *mark = &c->mark[c->marks];
        *mark = (struct campaign_mark){0};
        mark->known =
            c->options->is_known && c->options->is_known(c->options->user, entry_of(c, c->marks));
    }
    return STATUS_OK;
}

size_t campaign_counted(const struct campaign *c)
{
    size_t count = 0;
    for (size_t i = 0; i < c->marks; i++)
        count += !c->mark[i].known && entry_of(c, i)->signature.cause != CAUSE_NOT_REPEATABLE;
    return count;
}

static const struct engine *engine_of(const struct campaign *c, size_t i)
{
    const struct fuzz_field *field = &c->rules.field;
    size_t contestant = work_contestant(field, &entry_of(c, i)->signature);
    return contestant < field->count ? field->who[contestant].engine : NULL;
}

static bool in_hand(const struct campaign *c, size_t i, enum slot_task task)
{
    for (size_t s = 0; s < c->slots; s++)
        if (c->slot[s].task == task && c->slot[s].entry == i)
            return true;
    return false;
}

static bool can_shrink(const struct campaign *c, size_t i)
{
    return engine_of(c, i) && entry_of(c, i)->signature.cause != CAUSE_NOT_REPEATABLE;
}

static bool is_to_shrink(const struct campaign *c, size_t i)
{
    if (c->options->shrink == CAMPAIGN_SHRINK_NEVER || c->mark[i].shrunk || !can_shrink(c, i))
        return false;
    return c->options->shrink == CAMPAIGN_SHRINK_AT_END ? campaign_is_played(c) : !c->mark[i].known;
}

bool campaign_shrinks_left(const struct campaign *c)
{
    for (size_t i = 0; i < c->marks; i++)
        if (!c->mark[i].shrunk && can_shrink(c, i))
            return true;
    return false;
}

static bool is_to_play_again(const struct campaign *c, size_t i)
{
    return c->ending && entry_of(c, i)->signature.cause == CAUSE_NOT_REPEATABLE &&
           c->mark[i].played_again < CAMPAIGN_AGAIN && engine_of(c, i);
}

bool campaign_jobs_left(const struct campaign *c)
{
    for (size_t i = 0; i < c->marks; i++)
        if (is_to_shrink(c, i) || is_to_play_again(c, i))
            return true;
    return false;
}

/* Sends the smallest trial of a finding; *sent: there is one. Errors: as findings_get. */
static enum status send_job(struct campaign *c, struct slot *slot, size_t i, enum slot_task task,
                            bool *sent)
{
    struct finding_file file;
    struct work_order order = {.stream = WORK_GIVEN, .count = 1, .unexplained = true};
    const struct findings_entry *entry = entry_of(c, i);
    *sent = false;
    if (!entry->has_smallest)
        return STATUS_OK;
    enum status status =
        findings_get(c->findings, &entry->signature, "smallest.trial", &file, c->reason);
    if (status)
        return status;
    if (task == SLOT_SHRINK) {
        bool soon = c->options->shrink == CAMPAIGN_SHRINK_SOON;
        order.shrink = true;
        order.asks = soon ? SOON_ASKS : 0;
        order.ns = soon ? SOON_NS : 0;
        order.ms = c->options->trial_ms;
        order.memory = c->options->memory_bytes;
    }
    slot->task = task;
    slot->entry = i;
    slot->since_ns = time_ns();
    slot->beat = UINT64_MAX;
    (void)worker_order(&slot->child, &order, &file); /* campaign_crew_hear sees a dead one */
    finding_file_free(&file);
    *sent = true;
    return STATUS_OK;
}

/* While trials are played at most half of the workers shrink; a single one, half of its time. */
static bool may_shrink(const struct campaign *c)
{
    if (c->ending)
        return true;
    if (c->slots > 1)
        return 2 * campaign_crew_count(c, SLOT_SHRINK) < c->slots;
    return 2 * c->shrink_ns < time_ns() - c->start_ns;
}

enum status campaign_job_order(struct campaign *c, struct slot *slot, bool *given)
{
    *given = false;
    enum status status = campaign_marks_update(c);
    if (status || c->no_more_jobs)
        return status;
    for (size_t i = 0; i < c->marks && !*given && !status; i++) {
        if (is_to_play_again(c, i) && !in_hand(c, i, SLOT_AGAIN)) {
            status = send_job(c, slot, i, SLOT_AGAIN, given);
            c->mark[i].played_again = *given ? c->mark[i].played_again : CAMPAIGN_AGAIN;
        } else if (is_to_shrink(c, i) && !in_hand(c, i, SLOT_SHRINK) && may_shrink(c)) {
            status = send_job(c, slot, i, SLOT_SHRINK, given);
            c->mark[i].shrunk = !*given;
        }
    }
    return status;
}

/* True if the report has a finding of the same engine, layout and kind. */
static bool shows(const struct work_parts *parts, const struct fuzz_signature *signature)
{
    for (uint32_t i = 0; i < parts->report->findings; i++) {
        struct fuzz_signature one = parts->finding[i].finding.signature;
        one.cause = signature->cause;
        if (fuzz_signature_same(&one, signature))
            return true;
    }
    return false;
}

/* Offers a shrunk finding. A finding that ran out of asks could be shrunk further, so the log first
 * records the hash of the file: after a kill the finding is known to be shrunk if the file has
 * it. */
static enum status offer(struct campaign *c, size_t i, const struct finding_file *file)
{
    struct findings_news news;
    c->offered = i;
    c->offered_hash = fuzz_trial_size(&file->trial).hash;
    enum status status = campaign_state_write(c);
    if (!status)
        status = findings_offer(c->findings, file, &news, c->reason);
    c->offered = SIZE_MAX;
    return status;
}

static enum status take_shrunk(struct campaign *c, size_t i, const struct work_parts *parts)
{
    struct finding_file file;
    c->shrink_ns += parts ? parts->report->ns : 0;
    enum status status = STATUS_OK;
    if (parts && !parts->report->status && parts->report->text_bytes > 0) {
        status = finding_file_parse("a shrunk finding", parts->text, parts->report->text_bytes,
                                    &file, c->reason);
        if (status)
            return status;
        status = offer(c, i, &file);
        finding_file_free(&file);
    } /* else it stays as it is */
    c->mark[i].shrunk = true;
    c->dirty = true;
    return status;
}

enum status campaign_job_take(struct campaign *c, struct slot *slot, const struct work_parts *parts)
{
    size_t i = slot->entry;
    enum slot_task task = slot->task;
    const struct fuzz_signature *signature = &entry_of(c, i)->signature;
    struct campaign_mark *mark = &c->mark[i];
    slot->task = SLOT_IDLE;
    if (task == SLOT_SHRINK)
        return take_shrunk(c, i, parts);
    bool died = signature->kind == FUZZ_KIND_CRASH || signature->kind == FUZZ_KIND_HANG;
    mark->played_again++;
    if (parts ? shows(parts, signature) : died)
        mark->shown++;
    return STATUS_OK;
}
