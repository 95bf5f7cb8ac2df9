#define _POSIX_C_SOURCE 200809L
#include "fuzz/campaign/worker.h"

#include "fuzz/findings/versions.h"
#include "ref/base/text.h"
#include "fuzz/campaign/worker_base.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The longest that a message to a worker may take; only a dead one does not take it. */
#define SEND_MS 60000u

/* --- the worker ------------------------------------------------------------------------------ */

struct worker {
    struct child *parent;
    const struct work_start *start;
    const struct work_rules *rules;
    struct fuzz_player *player;
    struct fuzz_trial trial[FUZZ_BATCH];
    struct fuzz_result result[FUZZ_BATCH];
    /* The report being made. */
    struct work_report report;
    struct work_trial told[FUZZ_BATCH];
    struct work_finding finding[FUZZ_BATCH * FUZZ_FINDINGS_MOST];
};

static void enter(struct worker *w, enum work_phase phase)
{
    atomic_store(&w->start->watch->phase, phase);
    atomic_fetch_add(&w->start->watch->beat, 1);
}

/* One line on a finding that has no judgement. */
static const char *say_kind(enum fuzz_kind kind)
{
    switch (kind) {
    case FUZZ_KIND_BITS:
        return "not the bits of engine cpu on the same bytes";
    case FUZZ_KIND_UNFINISHED:
        return "the engine reports an unfinished ray";
    case FUZZ_KIND_REFUSED:
        return "the engine refused valid input";
    case FUZZ_KIND_TREE:
        return "the packed bytes are not the tree that they were made from";
    case FUZZ_KIND_CRASH:
        return "the engine failed and had to be opened again";
    case FUZZ_KIND_HANG:
        return "the engine did not answer in time";
    case FUZZ_KIND_PROTOCOL:
        return "the engine's answer was invalid";
    default:
        return "";
    }
}

_Static_assert(WORK_OPINION_MOST >= FUZZ_SAID_MOST, "the line about a tree fits in an opinion");

static void form_opinion(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                         char text[WORK_OPINION_MOST])
{
    const char *said = say_kind(finding->signature.kind);
    if (finding->said[0])
        memcpy(text, finding->said, sizeof finding->said);
    else if (said[0] || finding->ray >= trial->ray_count)
        snprintf(text, WORK_OPINION_MOST, "%s", said);
    else
        fuzz_finding_line(trial, finding, text, WORK_OPINION_MOST);
    if (finding->step > 0) {
        char step[STEP_TEXT_MOST];
        step_write(&trial->step[finding->step - 1], step);
        text_append(text, WORK_OPINION_MOST, "; after step %u, %s", finding->step, step);
    }
}

static enum status explain(struct worker *w, const struct work_order *order)
{
    struct work_report *report = &w->report;
    enum status status = STATUS_OK;
    uint64_t begun = time_ns();
    for (uint32_t i = 0; i < order->count && !status; i++)
        for (size_t k = 0; k < w->result[i].finding_count && !status; k++) {
            struct work_finding *out = &w->finding[report->findings++];
            *out = (struct work_finding){.trial = i, .finding = w->result[i].finding[k]};
            enter(w, WORK_EXPLAINING);
            if (!order->unexplained && order->stream != WORK_KEPT)
                status = fuzz_explain(w->player, &w->trial[i], &out->finding, &report->reason);
            form_opinion(&w->trial[i], &out->finding, out->opinion);
        }
    report->explain_ns = time_ns() - begun;
    return status;
}

static void tell(struct worker *w, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct fuzz_result *from = &w->result[i];
        struct work_trial *to = &w->told[i];
        *to = (struct work_trial){.wrong = (uint32_t)from->wrong,
                                  .judged = (uint32_t)from->judged,
                                  .refusers = from->refusers,
                                  .decliners = from->decliners,
                                  .players = from->players,
                                  .provers = from->provers,
                                  .refitted = from->refitted,
                                  .rebuilt = from->rebuilt,
                                  .builder = w->trial[i].builder,
                                  .store = w->trial[i].store,
                                  .tri = w->trial[i].tri,
                                  .box = w->trial[i].box,
                                  .optimized = work_optimized(&w->trial[i].build),
                                  .rays = w->trial[i].ray_count * (from->states ? from->states : 1),
                                  .triangles = w->trial[i].scene.tri_count};
        memcpy(to->coverage, from->coverage, sizeof to->coverage);
        for (size_t v = 0; v < VERDICT_COUNT; v++)
            to->count[v] = (uint32_t)from->count[v];
        for (size_t k = 0; k < FUZZ_CONTESTANTS_MOST * MATCH_EDGES; k++) {
            const struct edges_lost *edges = &from->edges[k / MATCH_EDGES][k % MATCH_EDGES];
            to->edges[k / MATCH_EDGES][k % MATCH_EDGES].hits = (uint32_t)edges->hits;
            to->edges[k / MATCH_EDGES][k % MATCH_EDGES].lost = (uint32_t)edges->lost;
        }
    }
    w->report.trials = count;
}

/* Casts a drawn field: by what was drawn, or by the finding that is to be played again. */
static void cast(struct worker *w, const struct work_order *order, const struct finding_file *base)
{
    const struct fuzz_field *field = &w->rules->field;
    size_t i = order->draw.contestant;
    const struct layout *layout = order->draw.layout;
    fuzz_player_leave_out(w->player, order->left_out);
    if (!field->drawn)
        return;
    if (!order->draw.on) {
        i = work_contestant(field, &base->signature);
        layout = base->signature.layout;
    }
    if (i < field->count && !(order->left_out >> i & 1u))
        fuzz_player_cast(w->player, i, layout);
    else
        fuzz_player_leave_out(w->player, UINT32_MAX);
}

static enum status play(struct worker *w, const struct work_order *order,
                        const struct finding_file *base)
{
    struct work_report *report = &w->report;
    enum status status = STATUS_OK;
    uint32_t made = 0;
    uint64_t begun = time_ns();
    enter(w, WORK_MAKING);
    for (; made < order->count && !status; made += status == STATUS_OK)
        status = work_trial_ordered(w->rules, order, made, &base->trial, &w->trial[made],
                                    &report->reason);
    report->time.generate += time_ns() - begun;
    enter(w, WORK_PLAYING);
    cast(w, order, base);
    if (!status)
        status = fuzz_play(w->player, w->trial, made, w->result, &report->time,
                           &w->start->watch->mark, &report->reason);
    if (!status)
        status = explain(w, order);
    if (!status)
        tell(w, made);
    for (uint32_t i = 0; i < made; i++)
        fuzz_trial_free(&w->trial[i]);
    return status;
}

/* --- shrinking ------------------------------------------------------------------------------- */

static void beat(void *user, const struct shrink_stats *stats, const struct fuzz_trial *best)
{
    (void)stats;
    (void)best;
    enter(user, WORK_SHRINKING);
}

static enum status shrink(struct worker *w, const struct work_order *order,
                          const struct finding_file *file, char **text, size_t *size)
{
    struct work_report *report = &w->report;
    const struct fuzz_field *field = &w->rules->field;
    struct fuzz_field alone = {.count = 1, .options = field->options};
    struct fuzz_player *player = NULL;
    struct finding_file small = {0};
    const struct shrink_options options = {order->asks, order->ns, beat, w};
    size_t i = work_contestant(field, &file->signature);
    enum status status;
    if (i == field->count)
        return fail(&report->reason, STATUS_INPUT, "the finding's engine does not take part");
    enter(w, WORK_SHRINKING);
    uint64_t begun = time_ns();
    enum fuzz_kind kind = file->signature.kind;
    if (kind == FUZZ_KIND_CRASH || kind == FUZZ_KIND_HANG) {
        const struct shrink_apart apart = {{field->who[i].engine, file->signature.layout},
                                           field->options,
                                           order->ms,
                                           order->memory};
        status =
            fuzz_shrink_apart(&apart, file, &options, &small, &report->shrunk, &report->reason);
    } else {
        alone.who[0] = (struct fuzz_contestant){field->who[i].engine, file->signature.layout};
        status = fuzz_player_open(&alone, &player, &report->reason);
        if (!status)
            status = fuzz_shrink_finding(player, file, &options, &small, &report->shrunk,
                                         &report->reason);
    }
    if (!status)
        status = finding_file_print(&small, text, size, &report->reason);
    finding_file_free(&small);
    fuzz_player_close(player);
    report->explain_ns = time_ns() - begun;
    return status;
}

/* --- messages -------------------------------------------------------------------------------- */

static bool send_report(struct worker *w, const char *text, size_t size)
{
    struct work_report *report = &w->report;
    if (report->status)
        report->trials = report->findings = 0;
    size_t trials = report->trials * sizeof *w->told;
    size_t findings = report->findings * sizeof *w->finding;
    char *bytes = malloc(sizeof *report + trials + findings + size + 1), *at = bytes;
    if (!bytes)
        return false;
    report->text_bytes = size;
    memcpy(at, report, sizeof *report);
    memcpy(at += sizeof *report, w->told, trials);
    memcpy(at += trials, w->finding, findings);
    at += findings;
    if (size > 0)
        memcpy(at, text, size);
    at[size] = '\0';
    enter(w, WORK_IDLE);
    bool sent = child_send(w->parent, bytes, (size_t)(at - bytes) + size + 1, CHILD_FOREVER);
    free(bytes);
    return sent;
}

bool work_parts(const void *bytes, size_t size, struct work_parts *out)
{
    const struct work_report *report = bytes;
    *out = (struct work_parts){0};
    if (size < sizeof *report + 1 || report->trials > FUZZ_BATCH ||
        report->findings > FUZZ_BATCH * FUZZ_FINDINGS_MOST || report->text_bytes > size)
        return false;
    size_t trials = report->trials * sizeof *out->trial;
    size_t findings = report->findings * sizeof *out->finding;
    const char *at = (const char *)bytes + sizeof *report;
    if (size != sizeof *report + trials + findings + report->text_bytes + 1)
        return false;
    out->report = report;
    out->trial = (const void *)at;
    out->finding = (const void *)(at + trials);
    out->text = at + trials + findings;
    return true;
}

static enum status read_order(const char *bytes, size_t size, struct work_order *order,
                              struct finding_file *base, struct reason *reason)
{
    *base = (struct finding_file){0};
    memcpy(order, bytes, sizeof *order);
    if (size == sizeof *order)
        return STATUS_OK;
    return worker_base_get(bytes + sizeof *order, size - sizeof *order, base, reason);
}

static bool obey(struct worker *w, const char *bytes, size_t size)
{
    struct work_order order;
    struct finding_file base;
    char *text = NULL;
    size_t text_size = 0;
    uint64_t begun = time_ns();
    w->report = (struct work_report){.status = STATUS_OK};
    w->report.status = read_order(bytes, size, &order, &base, &w->report.reason);
    if (!w->report.status)
        w->report.status =
            order.shrink ? shrink(w, &order, &base, &text, &text_size) : play(w, &order, &base);
    finding_file_free(&base);
    w->report.ns = time_ns() - begun;
    bool sent = send_report(w, text, text_size);
    free(text);
    return sent;
}

static void tell_versions(const struct fuzz_field *field, char *text, size_t text_bytes)
{
    const struct engine *engine[FUZZ_CONTESTANTS_MOST];
    size_t count = 0;
    for (size_t i = 0; i < field->count; i++) {
        size_t k = 0;
        while (k < count && engine[k] != field->who[i].engine)
            k++;
        if (k == count)
            engine[count++] = field->who[i].engine;
    }
    fuzz_versions(engine, count, &field->options, text, text_bytes);
}

/* Opens the device that builders need, by a scene of nothing. Errors: as builder->compare. */
static enum status open_builders(const struct work_rules *rules, struct reason *reason)
{
    const struct scene nothing = {0};
    enum status status = STATUS_OK;
    for (size_t i = 0; i < rules->builder_count && !status; i++)
        if (rules->builder[i]->compare)
            status = rules->builder[i]->compare(&nothing, reason);
    return status;
}

static void run(struct child *parent, void *user)
{
    const struct work_start *start = user;
    struct worker *w = alloc_zeroed(1, sizeof *w);
    char versions[sizeof((struct finding_file *)0)->versions] = "";
    const void *bytes;
    size_t size;
    /* The parent decides when to end; a terminal or a scheduler sends these to all processes. */
    static const int ends[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
    for (size_t i = 0; i < ARRAY_COUNT(ends); i++)
        signal(ends[i], SIG_IGN);
    /* A core for each worker: the driver's own threads would only wait for each other. */
    setenv("LP_NUM_THREADS", "0", 0);
    if (!w)
        return;
    w->parent = parent;
    w->start = start;
    w->rules = start->rules;
    enter(w, WORK_OPENING);
    w->report.status = fuzz_player_open(&w->rules->field, &w->player, &w->report.reason);
    if (!w->report.status)
        w->report.status = open_builders(w->rules, &w->report.reason);
    if (!w->report.status && start->versions)
        tell_versions(&w->rules->field, versions, sizeof versions);
    bool goes_on = send_report(w, versions, strlen(versions)) && w->player;
    while (goes_on &&
           child_receive(parent, WORK_MESSAGE_MOST, CHILD_FOREVER, &bytes, &size) == CHILD_GOT)
        goes_on = obey(w, bytes, size);
    fuzz_player_close(w->player);
    free(w);
}

/* --- the parent's side ----------------------------------------------------------------------- */

enum status worker_start(const struct work_start *start, struct child *out, struct reason *reason)
{
    struct work_start copy = *start; /* the child has it in its own memory */
    atomic_store(&start->watch->phase, WORK_OPENING);
    atomic_store(&start->watch->mark.contestant, FUZZ_CONTESTANTS_MOST);
    return child_start(run, &copy, out, reason);
}

bool worker_order(struct child *worker, const struct work_order *order,
                  const struct finding_file *base)
{
    size_t size = sizeof *order + (base ? worker_base_bytes(base) : 0);
    char *bytes = malloc(size);
    bool sent = false;
    if (bytes) {
        memcpy(bytes, order, sizeof *order);
        if (base)
            worker_base_put(base, bytes + sizeof *order);
        sent = child_send(worker, bytes, size, SEND_MS);
    }
    free(bytes);
    return sent;
}
