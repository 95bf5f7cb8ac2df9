#define _POSIX_C_SOURCE 200809L /* strdup */
#include "bench/report/report_inner.h"

#include "ref/base/command.h"
#include "ref/base/json_text.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

static void free_part(struct report_part *part)
{
    free(part->name);
    free(part->command);
    free(part->why);
    free(part->text);
    free(part->drawing);
    free(part->page);
    free(part->known);
    json_decref(part->json);
}

void report_picture_free(struct report_picture *picture)
{
    free(picture->group);
    free(picture->title);
    free(picture->caption);
    free(picture->png);
}

void report_free(struct report *report)
{
    for (size_t i = 0; i < report->part_count; i++)
        free_part(&report->part[i]);
    for (size_t i = 0; i < report->picture_count; i++)
        report_picture_free(&report->picture[i]);
    free(report->part);
    free(report->picture);
    *report = (struct report){0};
}

static char *copy(const char *text)
{
    return strdup(text ? text : "");
}

enum status report_add(struct report *report, const struct report_part *part, struct reason *reason)
{
    void *array = report->part;
    struct report_part mine = *part;
    mine.name = copy(part->name);
    mine.command = copy(part->command);
    mine.why = copy(part->why);
    mine.known = copy(part->known);
    mine.page = copy(part->page);
    mine.text = part->text ? strdup(part->text) : NULL;
    mine.drawing = part->drawing ? strdup(part->drawing) : NULL;
    bool all = mine.name && mine.command && mine.why && mine.known && mine.page &&
               (mine.text || !part->text) && (mine.drawing || !part->drawing);
    if (!all ||
        array_reserve(&array, &report->part_capacity, report->part_count + 1, sizeof mine)) {
        free_part(&mine);
        return fail(reason, STATUS_MEMORY, "no memory for the report");
    }
    report->part = array;
    report->part[report->part_count++] = mine;
    report->wanted[part->kind] = true;
    return STATUS_OK;
}

/* --- what is read --------------------------------------------------------------------------- */

/* The command that writes the JSON of a kind, and the arrays it must contain. */
static const struct {
    const char *writer, *array[2];
} kinds[REPORT_KINDS] = {
    [REPORT_CHECK] = {"raydiff check", {"scenes", "rows"}},
    [REPORT_BENCH] = {"raydiff bench or render --benchmark", {"rows"}},
    [REPORT_PICTURES] = {"raydiff diff", {"pairs"}},
    [REPORT_FINDING] = {"raydiff replay", {"files"}},
    [REPORT_MACHINE] = {"raydiff doctor", {"engines", "drivers"}},
};

bool report_is(enum report_kind kind, const json_t *json)
{
    if (kind == REPORT_BENCH && report_is_frames(json))
        return true;
    bool all = true;
    for (size_t i = 0; i < ARRAY_COUNT(kinds[kind].array) && kinds[kind].array[i]; i++)
        all = all && json_is_array(json_object_get(json, kinds[kind].array[i]));
    return all;
}

enum status report_read(const char *path, enum report_kind kind, json_t **out,
                        struct reason *reason)
{
    char *bytes;
    size_t size;
    json_error_t why;
    *out = NULL;
    enum status status = file_read(path, &bytes, &size, reason);
    if (status)
        return status;
    if (!json_text_fits(bytes, size)) {
        free(bytes);
        return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), JSON_TEXT_RULE);
    }
    json_t *json = json_loadb(bytes, size, 0, &why);
    free(bytes);
    if (!json)
        return fail(reason, STATUS_INPUT, "%s:%d:%d: %s", file_label(path), why.line, why.column,
                    why.text);
    if (!report_is(kind, json)) {
        json_decref(json);
        return fail(reason, STATUS_INPUT, "%s: is no JSON of %s", file_label(path),
                    kinds[kind].writer);
    }
    *out = json;
    return STATUS_OK;
}

/* --- what counts ---------------------------------------------------------------------------- */

/* True for a known finding that still fails. */
bool report_part_known(const struct report_part *part)
{
    return part->kind == REPORT_FINDING && part->code == EXIT_MISMATCH &&
           part->state == REPORT_RAN && part->known && part->known[0];
}

int report_part_code(const struct report_part *part)
{
    if (report_part_known(part))
        return EXIT_AGREE;
    if (part->kind == REPORT_MACHINE && part->code == EXIT_SKIPPED && part->json)
        return EXIT_AGREE;
    if (part->state == REPORT_FAILED && (part->code == EXIT_AGREE || part->code == EXIT_MISMATCH))
        return EXIT_INTERNAL; /* it finished, but its output cannot be read */
    if (part->state == REPORT_SKIPPED && part->code == EXIT_AGREE)
        return EXIT_SKIPPED;
    return part->code;
}

int report_code(const struct report *report)
{
    int code = EXIT_AGREE;
    for (size_t i = 0; i < report->part_count; i++)
        code = exit_worse(code, report_part_code(&report->part[i]));
    return code;
}

static void add_check(const json_t *json, struct report_sum *sum)
{
    size_t i;
    const json_t *row;
    json_array_foreach(json_object_get(json, "rows"), i, row)
    {
        enum row_look look = row_look(row);
        if (look == LOOK_NONE || look == LOOK_FAILED)
            continue;
        size_t wrong = value_count(json_object_get(row, "counts"), "wrong");
        sum->rows++;
        if (!value_bool(row, "judged")) {
            sum->published += wrong;
            continue;
        }
        sum->answers += value_count(row, "rays");
        sum->allowed += row_allowed(row);
        sum->wrong += wrong;
        sum->bits += value_count(row, "bit_differences");
    }
}

static void add_finding(const struct report_part *part, struct report_sum *sum)
{
    size_t i;
    const json_t *file;
    json_array_foreach(json_object_get(part->json, "files"), i, file)
    {
        bool known = report_part_known(part);
        sum->findings++;
        sum->known += known;
        sum->failing += value_bool(file, "fails") && !known;
    }
}

struct report_sum report_sum(const struct report *report)
{
    struct report_sum sum = {.parts = report->part_count, .figures = report_figures(report)};
    for (size_t i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->part[i];
        sum.skipped += part->state == REPORT_SKIPPED;
        sum.failed += part->state == REPORT_FAILED;
        if (part->kind == REPORT_CHECK)
            add_check(part->json, &sum);
        if (part->kind == REPORT_FINDING)
            add_finding(part, &sum);
    }
    return sum;
}
