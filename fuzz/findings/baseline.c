#define _POSIX_C_SOURCE 200809L /* gmtime_r */
#include "fuzz/findings/baseline.h"

#include "ref/engine.h"
#include "ref/outside/pipe.h"
#include "ref/files/file.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

extern const char baseline_shipped[]; /* BUILD/gen/baseline.c, made from fuzz/baseline.txt */

static bool is_engine(const char *pattern)
{
    for (size_t i = 0; engines[i]; i++)
        if (fnmatch(pattern, engines[i]->name, 0) == 0)
            return true;
    return strncmp(pattern, PIPE_PREFIX, strlen(PIPE_PREFIX)) == 0;
}

static bool is_layout(const char *pattern)
{
    for (size_t i = 0; layouts_all[i]; i++)
        if (fnmatch(pattern, layouts_all[i]->name, 0) == 0)
            return true;
    return fnmatch(pattern, "-", 0) == 0;
}

static bool is_kind(const char *pattern)
{
    for (enum fuzz_kind kind = FUZZ_KIND_WRONG + 1; kind < FUZZ_KIND_COUNT; kind++)
        if (fnmatch(pattern, fuzz_kind_name(kind), 0) == 0)
            return true;
    return false;
}

static bool is_cause(const char *pattern)
{
    for (enum cause cause = CAUSE_NONE; cause < CAUSE_COUNT; cause++)
        if (fnmatch(pattern, cause_name(cause), 0) == 0)
            return true;
    return false;
}

/* Every field must be able to match something: a misspelt one would silently excuse nothing. */
static enum status check(const struct waivers *list, const struct waiver *waiver,
                         struct reason *reason)
{
    static bool (*const is[])(const char *) = {is_cause, is_kind, is_layout, is_engine};
    static const char *const what[] = {"cause", "kind", "layout", "engine"};
    char pattern[FUZZ_SIGNATURE_MOST];
    if (strlen(waiver->pattern) >= sizeof pattern)
        return fail(reason, STATUS_INPUT, "%s:%zu: a pattern has at most %d characters", list->path,
                    waiver->line, FUZZ_SIGNATURE_MOST - 1);
    strcpy(pattern, waiver->pattern);
    for (size_t i = 0; i < ARRAY_COUNT(is); i++) {
        char *dot = strrchr(pattern, '.'), *field = i == 3 ? pattern : dot ? dot + 1 : NULL;
        if (!field)
            return fail(reason, STATUS_INPUT,
                        "%s:%zu: '%.80s' is no pattern of engine.layout.kind.cause", list->path,
                        waiver->line, waiver->pattern);
        if (!is[i](field))
            return fail(reason, STATUS_INPUT, "%s:%zu: no %s is called '%.60s'", list->path,
                        waiver->line, what[i], field);
        if (i < 3)
            *dot = '\0';
    }
    return STATUS_OK;
}

/* Takes the text over. */
static enum status add(struct baseline *baseline, const char *name, char *text, size_t size,
                       struct reason *reason)
{
    struct waivers list;
    enum status status = waivers_parse(name, text, size, true, &list, reason);
    for (size_t i = 0; i < list.count && !status; i++)
        status = check(&list, &list.waiver[i], reason);
    void *array = baseline->list;
    if (!status && array_reserve(&array, &baseline->capacity, baseline->count + 1, sizeof list))
        status = fail(reason, STATUS_MEMORY, "no memory for a baseline");
    baseline->list = array;
    if (status) {
        waivers_free(&list);
        return status;
    }
    baseline->list[baseline->count++] = list;
    return STATUS_OK;
}

enum status baseline_add(struct baseline *baseline, const char *name, const char *text, size_t size,
                         struct reason *reason)
{
    char *copy = malloc(size + 1);
    if (!copy)
        return fail(reason, STATUS_MEMORY, "no memory for a baseline of %zu bytes", size);
    memcpy(copy, text, size);
    copy[size] = '\0';
    return add(baseline, name, copy, size, reason);
}

enum status baseline_add_file(struct baseline *baseline, const char *path, struct reason *reason)
{
    char *text;
    size_t size;
    enum status status = file_read(path, &text, &size, reason);
    return status ? status : add(baseline, path, text, size, reason);
}

enum status baseline_open(struct baseline *out, struct reason *reason)
{
    *out = (struct baseline){0};
    enum status status =
        baseline_add(out, "fuzz/baseline.txt", baseline_shipped, strlen(baseline_shipped), reason);
    if (status)
        baseline_close(out);
    return status;
}

void baseline_close(struct baseline *baseline)
{
    for (size_t i = 0; i < baseline->count; i++)
        waivers_free(&baseline->list[i]);
    free(baseline->list);
    *baseline = (struct baseline){0};
}

void baseline_today(char day[BASELINE_DAY])
{
    time_t now = time(NULL);
    struct tm date;
    gmtime_r(&now, &date);
    strftime(day, BASELINE_DAY, "%Y-%m-%d", &date);
}

/* Dates as ISO 8601 writes them order as text. */
static bool has_expired(const struct waiver *waiver, const char *today)
{
    return waiver->until && strcmp(today, waiver->until) > 0;
}

void baseline_ask(struct baseline *baseline, const struct fuzz_signature *signature,
                  const char *versions, const char *today, struct baseline_answer *answer)
{
    char name[FUZZ_SIGNATURE_MOST];
    fuzz_signature_print(signature, name);
    *answer = (struct baseline_answer){.state = BASELINE_NEW};
    for (size_t l = 0; l < baseline->count; l++) {
        struct waivers *list = &baseline->list[l];
        waivers_note(list, name, WAIVER_FAILED, versions);
        for (size_t i = 0; i < list->count && answer->state != BASELINE_KNOWN; i++) {
            const struct waiver *waiver = &list->waiver[i];
            bool expired = has_expired(waiver, today);
            if (!waiver_is_about(waiver, name, versions) ||
                (expired && answer->state == BASELINE_EXPIRED))
                continue;
            answer->state = expired ? BASELINE_EXPIRED : BASELINE_KNOWN;
            snprintf(answer->text, sizeof answer->text, "%s%s%s%.400s %.240s (%.60s:%zu)",
                     expired ? "known until " : "", expired ? waiver->until : "",
                     expired ? ": " : "", waiver->reason, waiver->link, list->path, waiver->line);
        }
    }
}

/* True if the contestant could show a finding that matches. */
static bool could_show(const struct fuzz_contestant *who, const struct waiver *waiver,
                       const char *versions)
{
    struct fuzz_signature signature = {.layout = who->layout};
    char name[FUZZ_SIGNATURE_MOST];
    fuzz_signature_set_engine(&signature, who->engine->name);
    for (signature.kind = FUZZ_KIND_WRONG + 1; signature.kind < FUZZ_KIND_COUNT; signature.kind++)
        for (signature.cause = 0; signature.cause < CAUSE_COUNT; signature.cause++) {
            fuzz_signature_print(&signature, name);
            if (waiver_is_about(waiver, name, versions))
                return true;
        }
    return false;
}

static bool is_unused(const struct waiver *waiver, const struct fuzz_field *field,
                      const char *versions)
{
    for (size_t c = 0; c < field->count && waiver->failed == 0; c++)
        if (could_show(&field->who[c], waiver, versions))
            return true;
    return false;
}

const struct waiver *baseline_unused(const struct baseline *baseline,
                                     const struct fuzz_field *field, const char *versions,
                                     size_t *at, const char **path)
{
    size_t number = 0;
    for (size_t l = 0; l < baseline->count; l++)
        for (size_t i = 0; i < baseline->list[l].count; i++, number++)
            if (number >= *at && is_unused(&baseline->list[l].waiver[i], field, versions)) {
                *at = number + 1;
                *path = baseline->list[l].path;
                return &baseline->list[l].waiver[i];
            }
    return NULL;
}
