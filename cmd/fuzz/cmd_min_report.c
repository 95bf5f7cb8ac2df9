/* The results of raydiff min, as text and as JSON. */
#include "cmd/fuzz/cmd_min.h"

#include "cmd/fuzz/cmd_replay.h"
#include "ref/outside/pipe.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <jansson.h>
#include <stdio.h>

static const char *fate_name(enum min_fate fate)
{
    static const char *const names[] = {"smaller", "smallest", "not shown", "skipped", "failed"};
    return names[fate];
}

/* Why shrinking ended, in words. */
static const char *end_text(enum shrink_end end)
{
    static const char *const text[] = {
        [SHRINK_FIXPOINT] = "no smaller candidate is left",
        [SHRINK_OUT_OF_ASKS] = "a larger --asks may find a smaller one",
        [SHRINK_OUT_OF_TIME] = "ended by --time",
        [SHRINK_NOT_SHOWN] = "it does not show here",
    };
    return text[end];
}

static void print_size(const char *title, const struct fuzz_trial_size *size, size_t bytes)
{
    char instances[40] = "";
    if (size->instances > 0)
        snprintf(instances, sizeof instances, "%u instance%s, ", size->instances,
                 plural(size->instances));
    screen_line(
        11, "  %-8s %s%u triangle%s, %u ray%s, %u vert%s, %llu bits of numbers, %zu bytes\n", title,
        instances, size->triangles, plural(size->triangles), size->rays, plural(size->rays),
        size->vertices, size->vertices == 1 ? "ex" : "ices", (unsigned long long)size->bits, bytes);
}

static void print_replay(const struct min_row *row)
{
    char text[MIN_PATH_MOST + PIPE_NAME_MOST];
    replay_command(row->written[0] ? row->written : row->path, row->engine,
                   row->file.signature.layout, text, sizeof text);
    printf("  replay   %s\n", text);
}

void min_print(const struct min_row *row)
{
    char signature[FUZZ_SIGNATURE_MOST], text[512];
    if (row->fate == MIN_FAILED || row->fate == MIN_SKIPPED) {
        fprintf(stderr, "raydiff min: %s\n", row->reason.text);
        return;
    }
    fuzz_signature_print(&row->file.signature, signature);
    screen_line(4, "%s: %s\n", row->path, signature);
    print_size("before", &row->stats.before, row->bytes_before);
    if (row->fate == MIN_NOT_SHOWN) {
        puts("  it does not show here; nothing was written");
        print_replay(row);
        return;
    }
    print_size("after", &row->stats.after, row->bytes_after);
    screen_line(11, "  asked    %s in %s (%s), %llu smaller; %s\n",
                COUNTED(row->stats.tried, "trial"), COUNTED(row->stats.rounds, "round"),
                COUNTED(row->stats.asks, "ask"), (unsigned long long)row->stats.accepted,
                end_text(row->stats.end));
    replay_finding_line(&row->smaller.trial, &row->stats.finding, text, sizeof text);
    if (text[0])
        screen_line(11, "  shows    ray %u %s\n", row->stats.finding.ray, text);
    if (row->stats.finding.said[0])
        screen_line(11, "  shows    %s\n", row->stats.finding.said);
    if (row->file.signature.kind == FUZZ_KIND_CRASH)
        puts("  shows    the engine's process ends");
    else if (row->file.signature.kind == FUZZ_KIND_HANG)
        puts("  shows    the engine does not answer in time");
    else
        screen_line(11, "  cause    %s: %s\n", cause_name(row->file.signature.cause),
                    cause_text(row->file.signature.cause));
    printf("  wrote    %s\n", row->written[0] ? row->written : "nothing: it is the smallest");
    print_replay(row);
}

void min_print_line(const struct min_row *row)
{
    char signature[FUZZ_SIGNATURE_MOST], before[40], after[40];
    if (!row) {
        printf("%-48s %18s %18s %8s  %s\n", "finding", "triangles, rays", "now", "asks", "");
        return;
    }
    const struct fuzz_trial_size *a = &row->stats.before, *b = &row->stats.after;
    bool played = row->fate <= MIN_SMALLEST;
    fuzz_signature_print(&row->file.signature, signature);
    snprintf(before, sizeof before, "%u, %u", a->triangles, a->rays);
    snprintf(after, sizeof after, "%u, %u", b->triangles, b->rays);
    printf("%-48s %18s %18s %8llu  %s%s%s\n", signature, played ? before : "-",
           played ? after : "-", (unsigned long long)row->stats.asks, fate_name(row->fate),
           row->reason.text[0] && !played ? ": " : "",
           !played                             ? row->reason.text
           : row->stats.end == SHRINK_FIXPOINT ? ""
                                               : "; more --asks or --time may help");
}

static json_t *size_json(const struct fuzz_trial_size *size, size_t bytes)
{
    json_t *root = json_record("triangles=%u rays=%u vertices=%u bits=%zu bytes=%zu",
                               size->triangles, size->rays, size->vertices, size->bits, bytes);
    if (size->instances > 0)
        json_add(root, "instances=%u", size->instances);
    return root;
}

static json_t *row_json(const struct min_row *row)
{
    char signature[FUZZ_SIGNATURE_MOST], text[512];
    bool played = row->fate <= MIN_NOT_SHOWN;
    fuzz_signature_print(&row->file.signature, signature);
    replay_finding_line(&row->smaller.trial, &row->stats.finding, text, sizeof text);
    return json_record("file=%s signature=%s result=%s end=%s before=%p after=%p asks=%zu "
                       "tried=%zu accepted=%zu rounds=%u text=%s written=%s reason=%s exit=%d",
                       row->path, signature, fate_name(row->fate),
                       played ? shrink_end_name(row->stats.end) : "",
                       size_json(&row->stats.before, row->bytes_before),
                       size_json(&row->stats.after, row->bytes_after), row->stats.asks,
                       row->stats.tried, row->stats.accepted, row->stats.rounds, text, row->written,
                       played ? "" : row->reason.text, row->code);
}

enum status min_write_json(const char *path, const struct min_row *row, size_t count, int code,
                           struct reason *reason)
{
    json_t *findings = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(findings, row_json(&row[i]));
    json_t *root = json_record("raydiff=%s exit=%d findings=%p", RAYDIFF_VERSION, code, findings);
    return json_write(path, root, 17, reason);
}
