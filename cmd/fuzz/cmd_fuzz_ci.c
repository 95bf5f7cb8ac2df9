/* The results of a campaign for CI systems: JUnit, TAP, JSON lines. */
#include "cmd/fuzz/cmd_fuzz_report.h"

#include <stdlib.h>

#define NOTES_MOST 32

/* Memory that struct findings_report points to. */
struct report_room {
    struct report_finding *finding;
    struct finding_words *words; /* one per finding */
    struct report_contestant contestant[FUZZ_CONTESTANTS_MOST];
    char name[FUZZ_CONTESTANTS_MOST][NAME_MOST];
    const char *note[NOTES_MOST];
    char unused[NOTES_MOST][UNUSED_MOST];
};

static void fill_finding(const struct fuzz_command *c, const struct campaign_view *view, size_t i,
                         struct report_room *room)
{
    const struct findings_entry *entry = findings_entry(view->findings, i);
    struct finding_words *words = &room->words[i];
    fuzz_describe(c, view, i, words);
    room->finding[i] = (struct report_finding){.signature = words->signature,
                                               .count = entry->count,
                                               .state = words->state,
                                               .reason = words->answer.text,
                                               .cause = cause_text(entry->signature.cause),
                                               .triangles = entry->smallest.triangles,
                                               .rays = entry->smallest.rays,
                                               .vertices = entry->smallest.vertices,
                                               .first = words->first,
                                               .smallest = words->smallest,
                                               .replay = words->replay};
}

static void fill_contestants(const struct campaign_view *view, struct report_room *room)
{
    const struct fuzz_field *field = &view->options->rules.field;
    for (size_t i = 0; i < field->count; i++) {
        const char *vacuous = campaign_vacuous(view, i);
        fuzz_contestant_name(view, i, room->name[i]);
        room->contestant[i] =
            (struct report_contestant){.name = room->name[i],
                                       .played = view->turnout[i].played,
                                       .declined = view->turnout[i].declined,
                                       .refused = view->refused[i],
                                       .vacuous = vacuous ? vacuous : campaign_loses(view, i),
                                       .seconds = fuzz_seconds(view->time.engine[i])};
    }
}

static size_t fill_notes(const struct fuzz_command *c, const struct campaign_view *view,
                         struct report_room *room)
{
    size_t notes = 0, at = 0;
    if (c->left_out[0])
        room->note[notes++] = c->left_out;
    for (; notes < NOTES_MOST && fuzz_unused_line(c, view, &at, room->unused[notes]); notes++)
        room->note[notes] = room->unused[notes];
    return notes;
}

enum status fuzz_write_ci(const struct fuzz_command *c, const struct campaign_view *view,
                          struct reason *reason)
{
    struct report_room *room = alloc_zeroed(1, sizeof *room);
    size_t count = findings_count(view->findings);
    enum status status = STATUS_OK;
    if (room) {
        room->finding = alloc_zeroed(count + 1, sizeof *room->finding);
        room->words = alloc_zeroed(count + 1, sizeof *room->words);
    }
    if (!room || !room->finding || !room->words) {
        status = fail(reason, STATUS_MEMORY, "no memory for a report");
    } else {
        struct findings_report report = {.seed = c->seed,
                                         .trials = view->trials + view->before,
                                         .before = view->before,
                                         .judged = view->judged,
                                         .seconds = fuzz_seconds(view->ns),
                                         .harness_share = campaign_harness_share(view, NULL),
                                         .contestant = room->contestant,
                                         .contestants = view->options->rules.field.count,
                                         .finding = room->finding,
                                         .findings = count,
                                         .note = room->note};
        fill_contestants(view, room);
        for (size_t i = 0; i < count; i++)
            fill_finding(c, view, i, room);
        report.notes = fill_notes(c, view, room);
        if (c->junit)
            status = report_junit(&report, c->junit, reason);
        if (!status && c->tap)
            status = report_tap(&report, c->tap, reason);
        if (!status && c->jsonl)
            status = report_jsonl(&report, c->jsonl, reason);
    }
    if (room) {
        free(room->finding);
        free(room->words);
    }
    free(room);
    return status;
}
