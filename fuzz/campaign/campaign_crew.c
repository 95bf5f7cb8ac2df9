/* The workers of a campaign: their orders and reports, and which died, hang or hold too much
 * memory. */
#include "fuzz/campaign/campaign_inner.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#define START_MS       120000u /* engines are opened, a driver may compile */
#define FIRST_FACTOR   6u      /* for the first trials, whose pipelines must be compiled */
#define PEER_FACTOR    4u      /* a peer may run out of its own time several times in a trial */
#define EXPLAIN_FACTOR 6u      /* an engine is called several times */
#define OURS_MS        120000u /* of raydiff itself: the truth of a large scene */
#define FAILURES_MOST  3u      /* starts in a row */
#define STOPS_MOST     3u      /* workers in a row that are stopped by signals */
#define MEMORY_NS      200000000u
#define WAIT_MS        50u
#define LOOK_MS        1000u /* between two looks at a worker, at most */

static enum status start(struct campaign *c, struct slot *slot)
{
    const struct work_start how = {
        .rules = &c->rules, .watch = slot->watch, .versions = !c->versions[0]};
    slot->task = SLOT_STARTING;
    slot->warm = false;
    slot->since_ns = time_ns();
    slot->beat = slot->mark = UINT64_MAX;
    slot->stopped_ns = 0;
    return worker_start(&how, &slot->child, c->reason);
}

enum status campaign_crew_start(struct campaign *c)
{
    size_t jobs = c->options->jobs;
    enum status status = STATUS_OK;
    c->watch = child_share(jobs * sizeof *c->watch);
    if (!c->watch)
        return fail(c->reason, STATUS_MEMORY, "no memory to share");
    for (size_t i = 0; i < jobs && !status; i++) {
        c->slot[i].watch = &c->watch[i];
        status = start(c, &c->slot[i]);
        c->slots = i + 1;
    }
    return status;
}

void campaign_crew_end(struct campaign *c, uint32_t ms)
{
    for (size_t i = 0; i < c->slots; i++) {
        bool idle = c->slot[i].task == SLOT_IDLE;
        child_end(&c->slot[i].child, idle ? ms : 0, NULL);
        if (c->slot[i].block && c->slot[i].block->stream == WORK_MUT)
            campaign_block_free(c->slot[i].block);
        c->slot[i].block = NULL;
    }
    c->slots = 0;
    child_unshare(c->watch, c->options->jobs * sizeof *c->watch);
    c->watch = NULL;
}

size_t campaign_crew_count(const struct campaign *c, enum slot_task task)
{
    size_t count = 0;
    for (size_t i = 0; i < c->slots; i++)
        count += c->slot[i].task == task;
    return count;
}

/* --- orders ---------------------------------------------------------------------------------- */

static void send_block(struct slot *slot)
{
    const struct work_order order = campaign_block_order(slot->block);
    struct finding_file base = {.has_signature = false};
    if (slot->block->base)
        base.trial = *slot->block->base;
    slot->task = SLOT_BLOCK;
    slot->since_ns = time_ns();
    slot->beat = UINT64_MAX;
    /* A worker that does not take it has died: campaign_crew_hear sees it. */
    (void)worker_order(&slot->child, &order, slot->block->base ? &base : NULL);
}

/* Drivers keep what they compiled as long as their process lives. An idle worker is replaced before
 * that exceeds its memory, which would be reported as a crash. */
static bool is_grown(const struct campaign *c, const struct slot *slot)
{
    uint64_t most = c->options->memory_bytes;
    return most > 0 && slot->warm && child_memory(&slot->child) > most / 2;
}

static enum status renew(struct campaign *c, struct slot *slot)
{
    child_end(&slot->child, 1000, NULL);
    c->view.renewed++;
    return start(c, slot);
}

enum status campaign_crew_order(struct campaign *c)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < c->slots && !status; i++) {
        struct slot *slot = &c->slot[i];
        bool given = false;
        if (slot->task != SLOT_IDLE)
            continue;
        if (is_grown(c, slot)) {
            status = renew(c, slot);
            continue;
        }
        status = campaign_job_order(c, slot, &given);
        if (status || given)
            continue;
        slot->block = campaign_block_next(c, &status);
        if (status)
            return fail(c->reason, status, "no memory for a block of trials");
        if (slot->block)
            send_block(slot);
    }
    return status;
}

/* --- reports --------------------------------------------------------------------------------- */

/* The block is done, or its next trial is played alone. */
static enum status after_block(struct campaign *c, struct slot *slot, enum status status)
{
    struct campaign_block *block = slot->block;
    if (status)
        return fail(c->reason, status, "no memory for what workers report");
    if (!block->done) {
        send_block(slot);
        return STATUS_OK;
    }
    slot->block = NULL;
    slot->task = SLOT_IDLE;
    return block->stream == WORK_MUT ? campaign_block_apply(c, block) : STATUS_OK;
}

/* The worker ended or was ended, and is started anew. */
static enum status bury(struct campaign *c, struct slot *slot, const struct death *death)
{
    enum slot_task task = slot->task;
    enum status status = STATUS_OK;
    snprintf(c->said, sizeof c->said, "a worker %.200s", death->text);
    c->view.restarts++;
    slot->failures = task == SLOT_STARTING ? slot->failures + 1 : 0;
    if (slot->failures >= FAILURES_MOST || (task == SLOT_STARTING && !c->versions[0]))
        return fail(c->reason, STATUS_DEVICE, "opening the engines: a worker %s", death->text);
    if (task == SLOT_BLOCK)
        status = campaign_block_died(c, slot->block, death);
    else if (task == SLOT_SHRINK || task == SLOT_AGAIN)
        status = campaign_job_take(c, slot, NULL);
    if (status)
        return status;
    if (slot->block && slot->block->done)
        status = after_block(c, slot, STATUS_OK);
    return status ? status : start(c, slot);
}

static struct death read_watch(const struct slot *slot)
{
    struct death death = {.trial = atomic_load(&slot->watch->mark.trial),
                          .contestant = atomic_load(&slot->watch->mark.contestant),
                          .phase = atomic_load(&slot->watch->phase)};
    if (death.phase != WORK_PLAYING) /* the mark is an old one */
        death.contestant = FUZZ_CONTESTANTS_MOST;
    return death;
}

/* Ends a worker, if it has not ended, and reports `why`; NULL: how it ended. */
static enum status end_worker(struct campaign *c, struct slot *slot, bool hung, const char *why)
{
    struct death death = read_watch(slot);
    struct child_fate fate;
    child_end(&slot->child, why ? 0 : 1000, &fate);
    death.hung = hung;
    snprintf(death.text, sizeof death.text, "%s", why ? why : fate.text);
    return bury(c, slot, &death);
}

static enum status take_start(struct campaign *c, struct slot *slot, const struct work_parts *parts)
{
    const struct work_report *report = parts->report;
    if (report->status && (!c->versions[0] || ++slot->failures >= FAILURES_MOST))
        return fail(c->reason, report->status, "%s", report->reason.text);
    if (report->status) {
        child_end(&slot->child, 1000, NULL);
        return start(c, slot);
    }
    slot->failures = 0;
    slot->task = SLOT_IDLE;
    if (!c->versions[0])
        snprintf(c->versions, sizeof c->versions, "%s", parts->text);
    if (slot->block) /* of the one that died */
        send_block(slot);
    return STATUS_OK;
}

static enum status take_message(struct campaign *c, struct slot *slot, const void *bytes,
                                size_t size)
{
    struct work_parts parts;
    if (!work_parts(bytes, size, &parts))
        return end_worker(c, slot, false, "sent bytes that are not a report");
    enum status status = parts.report->status;
    if (slot->task == SLOT_STARTING)
        return take_start(c, slot, &parts);
    slot->warm = true;
    slot->stops = 0;
    if (status == STATUS_MEMORY)
        return fail(c->reason, status, "%s", parts.report->reason.text);
    if (slot->task == SLOT_SHRINK || slot->task == SLOT_AGAIN)
        return campaign_job_take(c, slot, &parts);
    if (slot->task != SLOT_BLOCK)
        return end_worker(c, slot, false, "sent a report without an order");
    if (status) {
        char why[WORK_OPINION_MOST];
        snprintf(why, sizeof why, "%s: %s", status_text(status), parts.report->reason.text);
        return end_worker(c, slot, false, why);
    }
    status = campaign_block_take(c, slot->block, &parts);
    return after_block(c, slot, status);
}

/* --- the watch ------------------------------------------------------------------------------- */

/* The longest that a worker may take for its current task. */
static uint64_t limit_ms(const struct campaign *c, const struct slot *slot)
{
    const struct fuzz_field *field = &c->rules.field;
    /* Drivers compile before they trace, and with members drawn every block may have a new shader.
     */
    bool compiled = slot->warm && !field->drawn;
    uint64_t trial = c->options->trial_ms * (uint64_t)(compiled ? 1 : FIRST_FACTOR);
    uint64_t ours = trial > OURS_MS ? trial : OURS_MS;
    if (slot->task == SLOT_STARTING)
        return START_MS;
    uint32_t phase = atomic_load(&slot->watch->phase);
    uint32_t who = atomic_load(&slot->watch->mark.contestant);
    if (phase == WORK_PLAYING && who < field->count && field->who[who].engine->fault &&
        field->options.peer_ms > trial)
        trial = field->options.peer_ms;
    if (phase == WORK_PLAYING && who < field->count && field->who[who].engine->fault)
        trial *= PEER_FACTOR;
    return phase == WORK_PLAYING && who < field->count ? trial
           : phase == WORK_EXPLAINING                  ? EXPLAIN_FACTOR * trial
                                                       : ours;
}

/* Adds the time since the last look. Looks are little more than WAIT_MS apart: if more has passed,
 * this process and the worker were stopped, or the machine slept. */
static void count_time(struct slot *slot, uint64_t now)
{
    const uint64_t most = LOOK_MS * 1000000u;
    uint32_t running;
    uint64_t queued = child_queued_ns(&slot->child, &running);
    uint64_t waited = queued > slot->queued_ns ? queued - slot->queued_ns : 0;
    slot->queued_ns = queued;
    slot->waited_ns += waited / (running > 1 ? running : 1);
    slot->busy_ns += now - slot->looked_ns < most ? now - slot->looked_ns : most;
}

/* True without progress for too long. Time in which its threads waited for a processor is left out,
 * but at least an eighth of all counts. */
static bool is_late(const struct campaign *c, const struct slot *slot)
{
    uint64_t busy = slot->busy_ns, waited = slot->waited_ns;
    uint64_t counted = waited < busy - busy / 8 ? busy - waited : busy / 8;
    return counted > limit_ms(c, slot) * 1000000u;
}

/* Only the time counts in which a worker could run. */
static bool is_stuck(const struct campaign *c, struct slot *slot)
{
    uint64_t beat = atomic_load(&slot->watch->beat), now = time_ns();
    uint64_t mark = atomic_load(&slot->watch->mark.trial) * (FUZZ_CONTESTANTS_MOST + 1) +
                    atomic_load(&slot->watch->mark.contestant);
    if (beat != slot->beat || mark != slot->mark) {
        slot->beat = beat;
        slot->mark = mark;
        slot->looked_ns = now;
        slot->queued_ns = child_queued_ns(&slot->child, &(uint32_t){0});
        slot->busy_ns = slot->waited_ns = 0;
    }
    if (slot->looked_ns < slot->since_ns) /* a new order */
        slot->looked_ns = slot->since_ns;
    const uint64_t most = LOOK_MS * 1000000u, spent = now - slot->looked_ns;
    bool debugged, stopped = child_is_stopped(&slot->child, &debugged);
    if (!stopped)
        count_time(slot, now);
    slot->stopped_ns = !stopped ? 0
                                : slot->stopped_ns + (debugged       ? 0
                                                      : spent < most ? spent
                                                                     : most);
    slot->looked_ns = now;
    return is_late(c, slot);
}

/* A worker that a signal stopped for longer than it may work will hardly continue by itself. It is
 * replaced and its task begun again: a stop is no finding. */
static enum status replace_stopped(struct campaign *c, struct slot *slot)
{
    const struct death at = read_watch(slot);
    const double seconds = (double)slot->stopped_ns * 1e-9;
    if (++slot->stops == STOPS_MOST)
        return fail(
            c->reason, STATUS_DEVICE,
            "%u workers in a row were stopped for %.3g s%s%s: something sends SIGSTOP", STOPS_MOST,
            seconds, at.contestant < c->rules.field.count ? ", at last by or within engine " : "",
            at.contestant < c->rules.field.count ? c->rules.field.who[at.contestant].engine->name
                                                 : "");
    snprintf(c->said, sizeof c->said, "a worker was stopped for %.3g s, and is replaced", seconds);
    c->view.restarts++;
    child_end(&slot->child, 0, NULL);
    return start(c, slot);
}

static enum status watch(struct campaign *c, struct slot *slot, bool memory)
{
    char why[WORK_OPINION_MOST];
    uint64_t most = c->options->memory_bytes;
    if (slot->task == SLOT_IDLE)
        return STATUS_OK;
    if (is_stuck(c, slot)) {
        /* The text does not depend on which limit it was: it is kept, and the same in every run. */
        snprintf(why, sizeof why, "did not answer within %g s",
                 (double)c->options->trial_ms * 1e-3);
        return end_worker(c, slot, true, why);
    }
    if (slot->stopped_ns > limit_ms(c, slot) * 1000000u)
        return replace_stopped(c, slot);
    if (memory && most > 0 && child_memory(&slot->child) > most) {
        snprintf(why, sizeof why, "held more than %llu MiB of memory",
                 (unsigned long long)(most >> 20));
        return end_worker(c, slot, false, why);
    }
    return STATUS_OK;
}

enum status campaign_crew_hear(struct campaign *c)
{
    struct child *child[CAMPAIGN_JOBS_MOST];
    enum status status = STATUS_OK;
    bool memory = time_ns() - c->memory_ns > MEMORY_NS;
    for (size_t i = 0; i < c->slots; i++)
        child[i] = &c->slot[i].child;
    child_wait(child, c->slots, WAIT_MS);
    for (size_t i = 0; i < c->slots && !status; i++) {
        struct slot *slot = &c->slot[i];
        const void *bytes;
        size_t size;
        switch (child_receive(&slot->child, WORK_MESSAGE_MOST, 0, &bytes, &size)) {
        case CHILD_GOT:
            status = take_message(c, slot, bytes, size);
            break;
        case CHILD_LATE:
            status = watch(c, slot, memory);
            break;
        case CHILD_GONE:
            status = end_worker(c, slot, false, NULL);
            break;
        case CHILD_TOO_LONG:
            status = end_worker(c, slot, false, "sent a report without an end");
            break;
        }
    }
    if (memory)
        c->memory_ns = time_ns();
    return status;
}
