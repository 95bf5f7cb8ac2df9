#include "ref/files/scan.h"

#include "ref/base/decimal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct scan scan_make(const char *name, const char *bytes, size_t size)
{
    return (struct scan){.name = name, .start = bytes, .at = bytes, .end = bytes + size, .line = 1};
}

enum status scan_fail(const struct scan *scan, struct reason *reason, const char *format, ...)
{
    char rule[200];
    va_list args;
    va_start(args, format);
    vsnprintf(rule, sizeof rule, format, args);
    va_end(args);
    if (scan->binary)
        return fail(reason, STATUS_INPUT, "%s: byte %zu: %s", scan->name,
                    (size_t)(scan->at - scan->start), rule);
    return fail(reason, STATUS_INPUT, "%s:%llu: %s", scan->name, (unsigned long long)scan->line,
                rule);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_line_end(char c)
{
    return c == '\n' || c == '\r';
}

/* Skips the line end at the cursor. */
static void step_line(struct scan *scan)
{
    bool pair = scan->at[0] == '\r' && scan->at[1] == '\n';
    scan->at += pair ? 2 : 1;
    scan->line++;
}

/* Returns true at a backslash that joins two lines. */
static bool at_join(const struct scan *scan)
{
    return scan->joins && scan->at[0] == '\\' && scan->at + 1 < scan->end &&
           is_line_end(scan->at[1]);
}

void scan_blanks(struct scan *scan)
{
    for (;;) {
        if (is_blank(*scan->at)) {
            scan->at++;
        } else if (at_join(scan)) {
            scan->at++;
            step_line(scan);
        } else {
            return;
        }
    }
}

bool scan_line_done(const struct scan *scan)
{
    return scan->at == scan->end || is_line_end(*scan->at) ||
           (scan->comment && *scan->at == scan->comment);
}

bool scan_word_done(const struct scan *scan)
{
    return scan->at == scan->end || is_blank(*scan->at) || is_line_end(*scan->at) || at_join(scan);
}

size_t scan_word(struct scan *scan, const char **word)
{
    scan_blanks(scan);
    *word = scan->at;
    if (scan_line_done(scan))
        return 0;
    while (!scan_word_done(scan))
        scan->at++;
    return (size_t)(scan->at - *word);
}

void scan_next_line(struct scan *scan)
{
    const char *word;
    while (scan_word(scan, &word) > 0)
        continue;
    while (scan->at < scan->end && !is_line_end(*scan->at)) /* a comment */
        scan->at++;
    if (scan->at < scan->end)
        step_line(scan);
}

const char *scan_show(const struct scan *scan, char shown[SCAN_SHOWN])
{
    if (scan->at == scan->end)
        return "end of file";
    if (scan_line_done(scan))
        return "end of line";
    struct scan ahead = *scan;
    size_t length = 0;
    shown[length++] = '\'';
    for (; !scan_word_done(&ahead) && length < SCAN_SHOWN - 5; ahead.at++)
        shown[length++] = *ahead.at >= 0x21 && *ahead.at <= 0x7E ? *ahead.at : '?';
    memcpy(shown + length, scan_word_done(&ahead) ? "'" : "...'", scan_word_done(&ahead) ? 2 : 5);
    return shown;
}

enum status scan_float(struct scan *scan, const char *what, float *out, struct reason *reason)
{
    scan_blanks(scan);
    char shown[SCAN_SHOWN];
    const char *start = scan->at;
    const char *end = decimal_read_float(start, out);
    if (end)
        scan->at = end;
    if (end && scan_word_done(scan) && float_is_finite(*out))
        return STATUS_OK;
    bool too_large = end && scan_word_done(scan);
    scan->at = start;
    *out = 0;
    return scan_fail(scan, reason, "%s: %s is %s", what, scan_show(scan, shown),
                     too_large ? "beyond the range of a 32-bit float" : "not a finite number");
}

bool scan_u64(struct scan *scan, uint64_t *out)
{
    const char *word;
    const size_t length = scan_word(scan, &word);
    uint64_t value = 0;
    *out = 0;
    for (size_t i = 0; i < length; i++) {
        const uint64_t digit = (uint64_t)(word[i] - '0');
        if (word[i] < '0' || word[i] > '9' || value > (UINT64_MAX - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    *out = value;
    return length > 0;
}

bool scan_digits(struct scan *scan, int64_t *out)
{
    const char *at = scan->at + (*scan->at == '-' || *scan->at == '+');
    const char *first = at;
    int64_t value = 0;
    for (; *at >= '0' && *at <= '9'; at++) {
        if (at - first == 18)
            return false;
        value = value * 10 + (*at - '0');
    }
    if (at == first)
        return false;
    *out = *scan->at == '-' ? -value : value;
    scan->at = at;
    return true;
}

enum status scan_whole(struct scan *scan, const char *what, int64_t *out, struct reason *reason)
{
    scan_blanks(scan);
    char shown[SCAN_SHOWN];
    const char *start = scan->at;
    if (scan_digits(scan, out) && scan_word_done(scan))
        return STATUS_OK;
    scan->at = start;
    *out = 0;
    return scan_fail(scan, reason, "%s: %s is not a whole number", what, scan_show(scan, shown));
}
