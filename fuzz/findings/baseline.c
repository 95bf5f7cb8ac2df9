#define _POSIX_C_SOURCE 200809L /* gmtime_r */
#include "fuzz/findings/baseline.h"

#include "ref/engine.h"
#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "ref/files/file.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

extern const char baseline_shipped[]; /* BUILD/gen/baseline.c, made from fuzz/baseline.txt */

/* The fields of a pattern, from its last. */
enum baseline_field { FIELD_CAUSE, FIELD_KIND, FIELD_LAYOUT, FIELD_ENGINE, FIELDS };

/* The i-th text that a field can have; NULL behind the last. */
static const char *text_of(enum baseline_field field, size_t i)
{
    switch (field) {
    case FIELD_CAUSE:
        return i < CAUSE_COUNT - CAUSE_NONE ? cause_name((enum cause)(CAUSE_NONE + i)) : NULL;
    case FIELD_KIND:
        i += FUZZ_KIND_WRONG + 1;
        return i < FUZZ_KIND_COUNT ? fuzz_kind_name((enum fuzz_kind)i) : NULL;
    case FIELD_LAYOUT:
        return i == 0 ? "-" : layouts_all[i - 1] ? layouts_all[i - 1]->name : NULL;
    default:
        return engines[i] ? engines[i]->name : NULL;
    }
}

/* The engine in the table whose formula that variant of an engine has; NULL if it is none. */
static const char *plain_of(const char *name)
{
    const char *plain = NULL;
    for (size_t i = 0; engines[i] && !plain; i++)
        if (engines[i]->plain_of)
            plain = engines[i]->plain_of(name);
    return plain;
}

/* A pattern of variants begins with their engine's name: "rayquery:*nan*". */
static bool names_variants(const char *pattern)
{
    for (size_t i = 0; engines[i] && strpbrk(pattern, "*?"); i++) {
        const size_t own = strlen(engines[i]->name);
        if (engines[i]->plain_of && strncmp(pattern, engines[i]->name, own) == 0 &&
            pattern[own] == ':')
            return true;
    }
    return plain_of(pattern);
}

static bool can_match(enum baseline_field field, const char *pattern)
{
    for (size_t i = 0; text_of(field, i); i++)
        if (fnmatch(pattern, text_of(field, i), 0) == 0)
            return true;
    return field == FIELD_ENGINE &&
           (pipe_is_peer(pattern) || file_of_engine(pattern) || names_variants(pattern));
}

/* Every field must be able to match something: a misspelt one would silently excuse nothing. */
static enum status check(const struct waivers *list, const struct waiver *waiver,
                         struct reason *reason)
{
    static const char *const what[FIELDS] = {"cause", "kind", "layout", "engine"};
    char pattern[FUZZ_SIGNATURE_MOST];
    if (strlen(waiver->pattern) >= sizeof pattern)
        return fail(reason, STATUS_INPUT, "%s:%zu: a pattern has at most %d characters", list->path,
                    waiver->line, FUZZ_SIGNATURE_MOST - 1);
    strcpy(pattern, waiver->pattern);
    for (enum baseline_field i = 0; i < FIELDS; i++) {
        char *dot = strrchr(pattern, '.');
        char *field = i == FIELD_ENGINE ? pattern : dot ? dot + 1 : NULL;
        if (!field)
            return fail(reason, STATUS_INPUT,
                        "%s:%zu: '%.80s' is no pattern of engine.layout.kind.cause", list->path,
                        waiver->line, waiver->pattern);
        if (!can_match(i, field))
            return fail(reason, STATUS_INPUT, "%s:%zu: no %s is called '%.60s'", list->path,
                        waiver->line, what[i], field);
        if (i != FIELD_ENGINE)
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

/* Whether the waiver is about a finding, or about the same of the engine of a variant's formula. */
static bool is_about(const struct waiver *waiver, const struct fuzz_signature *signature,
                     const char *versions)
{
    char name[FUZZ_SIGNATURE_MOST];
    struct fuzz_signature plain = *signature;
    const char *engine = plain_of(signature->engine);
    fuzz_signature_print(signature, name);
    if (waiver_is_about(waiver, name, versions))
        return true;
    if (!engine)
        return false;
    fuzz_signature_set_engine(&plain, engine);
    fuzz_signature_print(&plain, name);
    return waiver_is_about(waiver, name, versions);
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
            if (!is_about(waiver, signature, versions) ||
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
    fuzz_signature_set_engine(&signature, who->engine->name);
    for (signature.kind = FUZZ_KIND_WRONG + 1; signature.kind < FUZZ_KIND_COUNT; signature.kind++)
        for (signature.cause = 0; signature.cause < CAUSE_COUNT; signature.cause++)
            if (is_about(waiver, &signature, versions))
                return true;
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
