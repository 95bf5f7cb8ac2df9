#include "fuzz/findings/finding_file_scan.h"

#include "ref/base/float_word.h"

#include <string.h>

static enum status unexpected(struct scan *scan, const char *what, struct reason *reason)
{
    char shown[SCAN_SHOWN];
    scan_blanks(scan);
    return scan_fail(scan, reason, "%s is needed here, not %s", what, scan_show(scan, shown));
}

enum status finding_word(struct scan *scan, const char *what, char word[FINDING_WORD_MOST],
                         struct reason *reason)
{
    struct scan before = *scan;
    const char *start;
    size_t length = scan_word(scan, &start);
    word[0] = '\0';
    if (length == 0 || length >= FINDING_WORD_MOST || memchr(start, 0, length))
        return unexpected(&before, what, reason);
    memcpy(word, start, length);
    word[length] = '\0';
    return STATUS_OK;
}

enum status finding_keyword(struct scan *scan, const char *expected, struct reason *reason)
{
    struct scan before = *scan;
    const char *start;
    size_t length = scan_word(scan, &start);
    char what[40] = "'";
    if (length == strlen(expected) && memcmp(start, expected, length) == 0)
        return STATUS_OK;
    strncat(what, expected, sizeof what - 3);
    strcat(what, "'");
    return unexpected(&before, what, reason);
}

enum status finding_whole(struct scan *scan, const char *what, uint64_t most, uint64_t *out,
                          struct reason *reason)
{
    struct scan before = *scan;
    char shown[SCAN_SHOWN];
    const char *start;
    size_t length = scan_word(scan, &start);
    uint64_t value = 0;
    bool good = length > 0;
    for (size_t i = 0; i < length && good; i++) {
        uint64_t digit = (uint64_t)(start[i] - '0');
        good = start[i] >= '0' && start[i] <= '9' && value <= (most - digit) / 10 && digit <= most;
        value = 10 * value + digit;
    }
    *out = good ? value : 0;
    if (good)
        return STATUS_OK;
    scan_blanks(&before);
    return scan_fail(&before, reason, "%s: %s is not a whole number from 0 to %llu", what,
                     scan_show(&before, shown), (unsigned long long)most);
}

enum status finding_float(struct scan *scan, const char *what, bool any, float *out,
                          struct reason *reason)
{
    char shown[SCAN_SHOWN];
    const char *rule;
    scan_blanks(scan);
    if (scan_line_done(scan))
        return unexpected(scan, what, reason);
    struct scan after = *scan;
    const char *end = float_word_read(scan->at, out, &rule);
    if (end) {
        after.at = end;
        if (scan_word_done(&after) && (any || float_is_finite(*out))) {
            scan->at = end;
            return STATUS_OK;
        }
        rule = scan_word_done(&after) ? "not finite" : "not a number";
    }
    *out = 0;
    return scan_fail(scan, reason, "%s: %s is %s", what, scan_show(scan, shown), rule);
}

enum status finding_text(struct scan *scan, char *out, size_t size, struct reason *reason)
{
    char comment = scan->comment;
    scan->comment = 0;
    scan_blanks(scan);
    size_t length = 0, kept = 0;
    enum status status = STATUS_OK;
    for (; !scan_line_done(scan) && !status; scan->at++) {
        char c = *scan->at == '\t' ? ' ' : *scan->at;
        if (c < 0x20 || c > 0x7E)
            status = scan_fail(scan, reason, "the text has a byte that is no printable ASCII");
        else if (length + 1 >= size)
            status = scan_fail(scan, reason, "the text has more than %zu characters", size - 1);
        else
            out[length++] = c;
        if (c != ' ')
            kept = length;
    }
    out[kept] = '\0';
    scan->comment = comment;
    return status;
}

enum status finding_line_end(struct scan *scan, struct reason *reason)
{
    scan_blanks(scan);
    if (!scan_line_done(scan))
        return unexpected(scan, "the end of the line", reason);
    scan_next_line(scan);
    return STATUS_OK;
}

void finding_skip(struct scan *scan)
{
    for (scan_blanks(scan); scan->at < scan->end && scan_line_done(scan); scan_blanks(scan))
        scan_next_line(scan);
}
