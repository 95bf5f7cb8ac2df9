/* What a row of raydiff check has besides its columns. */
#include "cmd/check/cmd_check.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A text that grows up to CHECK_NOTE_MOST bytes. */
struct row_text {
    char *text;
    size_t at;
};

__attribute__((format(printf, 2, 3))) static void add(struct row_text *note, const char *format,
                                                      ...)
{
    va_list args;
    va_start(args, format);
    int more = vsnprintf(note->text + note->at, CHECK_NOTE_MOST - note->at, format, args);
    va_end(args);
    note->at += more > 0 ? (size_t)more : 0;
    if (note->at >= CHECK_NOTE_MOST)
        note->at = CHECK_NOTE_MOST - 1;
}

/* The kinds of wrong answers, also of members as published. */
static void add_wrong(struct row_text *note, const struct row *row)
{
    if (row->count[VERDICT_WRONG] == 0)
        return;
    add(note, "%s", row->judged ? "" : " as published:");
    const char *between = " ";
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        if (row->wrong[w]) {
            add(note, "%s%s %zu", between, wrong_name(w), row->wrong[w]);
            between = ", ";
        }
}

/* Counters that exist only for lists of all hits. */
static void add_lists(struct row_text *note, const struct row *row)
{
    if (row->options.query != QUERY_ALL)
        return;
    add(note, "%s %s listed", note->at ? ";" : "", COUNTED(row->lists.triangles, "triangle"));
    if (row->of_world) /* its meshes promise nothing together */
        return;
    add(note, ", %zu double hits,", row->lists.doubles);
    if (row->lists.closed)
        add(note, " parity off in %zu of %zu", row->lists.parity_off, row->lists.parity);
    else
        add(note, " no parity (the mesh is open)");
}

void check_row_note(const struct row *row, char text[CHECK_NOTE_MOST])
{
    struct row_text note = {text, 0};
    const char *end = row->count[VERDICT_WRONG] ? ";" : ""; /* of what stands before */
    char edges[MATCH_EDGES_TEXT];
    text[0] = '\0';
    add_wrong(&note, row);
    if (row->displacement.count)
        add(&note, "%s displacement p50 %.2g p99 %.2g max %.3g uM, %zu lost in closed fans", end,
            row->displacement.p50, row->displacement.p99, row->displacement.most,
            row->displacement.fan_lost);
    if (row->displacement.count && fabs(row->displacement.allowed - JUDGE_DISPLACEMENT_MOST) > 0)
        add(&note, "; allowed are %g uM, not %g", row->displacement.allowed,
            JUDGE_DISPLACEMENT_MOST);
    match_edges_text(row->edges, edges);
    if (row->edges_beyond)
        add(&note, "%s lost beside edges %s", note.at ? ";" : "", edges);
    if (row->fans_lost)
        add(&note, "%s watertight: %zu lost in closed fans", note.at ? ";" : "", row->fans_lost);
    if (row->compiled.translates ? engine_compiled_loose(&row->compiled)
                                 : engine_compiled_lost(&row->compiled))
        add(&note, "%s %u of %u float operations without NoContraction, %u of open rounding",
            note.at ? ";" : "", row->compiled.ops - row->compiled.kept, row->compiled.ops,
            row->compiled.foreign);
    if (row->moved)
        add(&note, "%s %zu answers with other bits than %s's", note.at ? ";" : "", row->moved,
            row->against->name);
    if (row->moved && row->engine->plain)
        add(&note, ": both right %zu, it alone %zu, %s alone %zu, neither %zu", row->beside.both,
            row->beside.own, row->against->name, row->beside.plain, row->beside.neither);
    add_lists(&note, row);
    if (row->status == ROW_VACUOUS)
        add(&note, "%s %s", note.at ? ";" : "", row->reason.text);
}
