#include "fuzz/findings/waivers.h"

#include "ref/files/file.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WAIVERS_NAME "tests/waivers.txt"

extern const char waivers_shipped[]; /* BUILD/gen/waivers.c, made from tests/waivers.txt */

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

/* A day of the calendar, as ISO 8601 writes it. */
static bool is_date(const char *text)
{
    static const int days[] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int year = 0, month = 0, day = 0, end = 0;
    for (size_t i = 0; i < 10; i++)
        if (i == 4 || i == 7 ? text[i] != '-' : text[i] < '0' || text[i] > '9')
            return false;
    if (sscanf(text, "%4d-%2d-%2d%n", &year, &month, &day, &end) != 3 || text[end])
        return false;
    bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    return month >= 1 && month <= 12 && day >= 1 && day <= days[month - 1] &&
           (leap || month != 2 || day < 29);
}

/* Cuts "until DATE" off. */
static bool take_date(char **line, char **until)
{
    if (strcmp(word(line), "until") != 0)
        return false;
    *until = word(line);
    if (strcmp(*until, "-") != 0)
        return is_date(*until);
    *until = NULL;
    return true;
}

/* --- versions --------------------------------------------------------------------------------- */

#define NUMBERS 4 /* of a version; 4.3.3 has three */

struct number_list {
    unsigned long number[NUMBERS];
    size_t count;
};

/* Reads "4.3.3"; returns what follows it. No number: count is 0. */
static const char *read_numbers(const char *text, struct number_list *out)
{
    *out = (struct number_list){.count = 0};
    while (out->count < NUMBERS && *text >= '0' && *text <= '9') {
        char *end;
        out->number[out->count++] = strtoul(text, &end, 10);
        text = end;
        if (*text != '.' || text[1] < '0' || text[1] > '9')
            break;
        text++;
    }
    return text;
}

/* Compares the first `count` numbers; absent ones are 0. */
static int compare(const struct number_list *a, const struct number_list *b, size_t count)
{
    int order = 0;
    for (size_t i = 0; i < count && order == 0; i++)
        order = order_numbers(a->number[i], b->number[i]);
    return order;
}

enum range_kind { RANGE_NONE, RANGE_BAD, RANGE_GOOD };

/* Takes "NAME FIRST..LAST" apart; *name_length counts the blank. */
static enum range_kind range_of(const char *version, size_t *name_length, struct number_list *first,
                                struct number_list *last)
{
    const char *dots = strstr(version, "..");
    if (!dots)
        return RANGE_NONE;
    const char *start = dots;
    while (start > version && start[-1] != ' ')
        start--;
    *name_length = (size_t)(start - version);
    if (*name_length < 2 || read_numbers(start, first) != dots ||
        *read_numbers(dots + 2, last) != '\0')
        return RANGE_BAD;
    if (first->count == 0 || last->count == 0 || compare(first, last, last->count) > 0)
        return RANGE_BAD;
    return RANGE_GOOD;
}

bool version_told(const char *versions, const char *version)
{
    struct number_list first, last, told;
    size_t length;
    if (range_of(version, &length, &first, &last) != RANGE_GOOD)
        return strstr(versions, version) != NULL;
    for (const char *at = versions; *at; at++)
        if ((at == versions || at[-1] == ' ' || at[-1] == '\n') &&
            strncmp(at, version, length) == 0 && read_numbers(at + length, &told) != at + length &&
            compare(&first, &told, NUMBERS) <= 0 && compare(&told, &last, last.count) <= 0)
            return true;
    return false;
}

/* --- lines ------------------------------------------------------------------------------------ */

static bool same(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

/* The line of an earlier waiver of the same pattern, version and date; 0: none. */
static size_t line_of(const struct waivers *waivers, const struct waiver *waiver)
{
    for (size_t i = 0; i < waivers->count; i++) {
        const struct waiver *other = &waivers->waiver[i];
        if (same(other->pattern, waiver->pattern) && same(other->version, waiver->version) &&
            same(other->until, waiver->until))
            return other->line;
    }
    return 0;
}

static bool has_control(const char *line, const char *end)
{
    for (; line < end; line++)
        if (((unsigned char)*line < ' ' && *line != '\t' && *line != '\r') || *line == 0x7F)
            return true;
    return false;
}

static enum status add_line(struct waivers *out, char *line, size_t number, bool dated,
                            struct reason *reason)
{
    struct waiver waiver = {.line = number, .pattern = word(&line)};
    if (waiver.pattern[0] == '\0' || waiver.pattern[0] == '#')
        return STATUS_OK;
    line += strspn(line, " \t");
    if (line[0] == '@') {
        waiver.version = word(&line) + 1;
        for (char *c = waiver.version; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        struct number_list first, last;
        size_t length;
        if (range_of(waiver.version, &length, &first, &last) == RANGE_BAD)
            return fail(reason, STATUS_INPUT,
                        "%s:%zu: '@%.60s' is no range of versions: NAME_FIRST..LAST, such as "
                        "@Embree_3..4.3.3, where FIRST is not after LAST",
                        out->path, number, waiver.version);
    }
    if (dated && !take_date(&line, &waiver.until))
        return fail(reason, STATUS_INPUT,
                    "%s:%zu: after the pattern comes 'until YYYY-MM-DD', or 'until -' for ever",
                    out->path, number);
    waiver.link = last_word(line);
    waiver.reason = line + strspn(line, " \t");
    if (!strstr(waiver.link, "://") && !strstr(waiver.link, ".md"))
        return fail(reason, STATUS_INPUT,
                    "%s:%zu: a waiver must end in a link: an address or a document (.md)",
                    out->path, number);
    if (waiver.reason >= waiver.link || waiver.reason[0] == '\0')
        return fail(reason, STATUS_INPUT,
                    "%s:%zu: a waiver needs a reason between pattern and link", out->path, number);
    size_t earlier = line_of(out, &waiver);
    if (earlier)
        return fail(reason, STATUS_INPUT, "%s:%zu: line %zu has the same entry for '%.80s'",
                    out->path, number, earlier, waiver.pattern);
    void *array = out->waiver;
    if (array_reserve(&array, &out->capacity, out->count + 1, sizeof waiver))
        return fail(reason, STATUS_MEMORY, "no memory for waivers");
    out->waiver = array;
    out->waiver[out->count++] = waiver;
    return STATUS_OK;
}

enum status waivers_parse(const char *name, char *text, size_t size, bool dated,
                          struct waivers *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    size_t number = 0;
    *out = (struct waivers){.text = text};
    strncat(out->path, file_label(name), sizeof out->path - 1);
    for (char *line = text, *past = text + size; !status && line < past;) {
        char *end = memchr(line, '\n', (size_t)(past - line));
        end = end ? end : past;
        *end = '\0'; /* past the last byte there is one */
        number++;
        status = has_control(line, end)
                     ? fail(reason, STATUS_INPUT, "%s:%zu: a control character", out->path, number)
                     : add_line(out, line, number, dated, reason);
        line = end + 1;
    }
    if (status)
        waivers_free(out);
    return status;
}

enum status waivers_shipped_read(struct waivers *out, struct reason *reason)
{
    size_t size = strlen(waivers_shipped);
    char *text = malloc(size + 1);
    *out = (struct waivers){.count = 0};
    if (!text)
        return fail(reason, STATUS_MEMORY, "no memory for %zu bytes of waivers", size);
    memcpy(text, waivers_shipped, size + 1);
    return waivers_parse(WAIVERS_NAME, text, size, false, out, reason);
}

enum status waivers_read(const char *path, struct waivers *out, struct reason *reason)
{
    char *text;
    size_t size = 0;
    *out = (struct waivers){0};
    enum status status = file_read(path, &text, &size, reason);
    return status ? status : waivers_parse(path, text, size, false, out, reason);
}

void waivers_free(struct waivers *waivers)
{
    free(waivers->waiver);
    free(waivers->text);
    *waivers = (struct waivers){0};
}

/* True if waiver_judge() depends on whether there are names that were not noted. */
static bool is_open(const struct waiver *waiver)
{
    return waiver->failed == 0 && waiver->ran > 0 && waiver->exist <= waiver->named;
}

bool waivers_count(struct waivers *waivers, const char *name)
{
    bool more = false;
    for (size_t i = 0; i < waivers->count; i++) {
        struct waiver *waiver = &waivers->waiver[i];
        if (name && is_open(waiver))
            waiver->exist += fnmatch(waiver->pattern, name, 0) == 0;
        more |= is_open(waiver);
    }
    return more;
}

bool waivers_name_version(const struct waivers *waivers, const char *name)
{
    for (size_t i = 0; i < waivers->count; i++)
        if (waivers->waiver[i].version && fnmatch(waivers->waiver[i].pattern, name, 0) == 0)
            return true;
    return false;
}

bool waiver_is_about(const struct waiver *waiver, const char *name, const char *versions)
{
    return fnmatch(waiver->pattern, name, 0) == 0 &&
           (!waiver->version || version_told(versions, waiver->version));
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
        if (event != WAIVER_FAILED || !waiver_is_about(waiver, name, versions))
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
    if (waiver->version && !version_told(versions, waiver->version))
        return WAIVER_GONE;
    return WAIVER_UNUSED;
}
