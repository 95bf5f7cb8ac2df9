#include "tests/hard/waivers.h"

#include "scenes/file.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

/* Cuts the next word off; "" at the end. */
static char *word(char **rest)
{
    char *start = *rest + strspn(*rest, " \t\r");
    char *end = start + strcspn(start, " \t\r");
    *rest = *end ? end + 1 : end;
    *end = '\0';
    return start;
}

/* Cuts the last word off; "" if there is none. */
static char *last_word(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r", text[length - 1]))
        text[--length] = '\0';
    char *start = text + length;
    while (start > text && !strchr(" \t", start[-1]))
        start--;
    if (start > text)
        start[-1] = '\0';
    return start;
}

static enum status add_line(struct waivers *out, char *line, size_t number, struct reason *reason)
{
    struct waiver waiver = {.line = number, .pattern = word(&line)};
    if (waiver.pattern[0] == '\0' || waiver.pattern[0] == '#')
        return STATUS_OK;
    line += strspn(line, " \t");
    if (line[0] == '@') {
        waiver.version = word(&line) + 1;
        for (char *c = waiver.version; *c; c++)
            *c = *c == '_' ? ' ' : *c;
    }
    waiver.link = last_word(line);
    waiver.reason = line + strspn(line, " \t");
    if (!strstr(waiver.link, "://") && !strstr(waiver.link, ".md"))
        return fail(reason, STATUS_INPUT,
                    "%s:%zu: a waiver ends in a link, an address or a document (.md)", out->path,
                    number);
    if (waiver.reason >= waiver.link || waiver.reason[0] == '\0')
        return fail(reason, STATUS_INPUT,
                    "%s:%zu: a waiver needs a reason between pattern and link", out->path, number);
    void *array = out->waiver;
    if (array_reserve(&array, &out->capacity, out->count + 1, sizeof waiver))
        return fail(reason, STATUS_MEMORY, "no memory for waivers");
    out->waiver = array;
    out->waiver[out->count++] = waiver;
    return STATUS_OK;
}

enum status waivers_read(const char *path, struct waivers *out, struct reason *reason)
{
    size_t size = 0, number = 0;
    *out = (struct waivers){0};
    enum status status = file_read(path, &out->text, &size, reason);
    if (status)
        return status;
    strncat(out->path, file_label(path), sizeof out->path - 1);
    for (char *line = out->text; status == STATUS_OK && line < out->text + size;) {
        char *end = line + strcspn(line, "\n");
        bool last = *end == '\0';
        *end = '\0';
        status = add_line(out, line, ++number, reason);
        line = last ? out->text + size : end + 1;
    }
    if (status)
        waivers_free(out);
    return status;
}

void waivers_free(struct waivers *waivers)
{
    free(waivers->waiver);
    free(waivers->text);
    *waivers = (struct waivers){0};
}

void waivers_count(struct waivers *waivers, const char *name)
{
    for (size_t i = 0; i < waivers->count; i++)
        waivers->waiver[i].exist += fnmatch(waivers->waiver[i].pattern, name, 0) == 0;
}

bool waivers_name_version(const struct waivers *waivers, const char *name)
{
    for (size_t i = 0; i < waivers->count; i++)
        if (waivers->waiver[i].version && fnmatch(waivers->waiver[i].pattern, name, 0) == 0)
            return true;
    return false;
}

const struct waiver *waivers_note(struct waivers *waivers, const char *name,
                                  enum waiver_event event, const char *versions)
{
    const struct waiver *first = NULL;
    for (size_t i = 0; i < waivers->count; i++) {
        struct waiver *waiver = &waivers->waiver[i];
        if (fnmatch(waiver->pattern, name, 0) != 0)
            continue;
        waiver->named++;
        waiver->ran += event != WAIVER_SKIPPED;
        bool elsewhere = waiver->version && !strstr(versions, waiver->version);
        if (event != WAIVER_FAILED || elsewhere)
            continue;
        waiver->failed++;
        if (!first)
            first = waiver;
    }
    return first;
}

enum waiver_fault waiver_judge(const struct waiver *waiver, bool complete, const char *versions)
{
    if (waiver->failed > 0)
        return WAIVER_FINE;
    if (waiver->named == 0)
        return complete ? WAIVER_NOTHING : WAIVER_FINE;
    if (waiver->ran == 0 || (!complete && waiver->named < waiver->exist))
        return WAIVER_FINE;
    if (waiver->version && !strstr(versions, waiver->version))
        return WAIVER_GONE;
    return WAIVER_UNUSED;
}
