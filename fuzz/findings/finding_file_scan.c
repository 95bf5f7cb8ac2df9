#include "fuzz/findings/finding_file_scan.h"

#include "ref/base/float_word.h"

#include <stdio.h>
#include <string.h>

/* The least bytes of a line: numbers of one digit, blanks between them, the line's end. */
#define LEAST_LINE(numbers) (2 * (size_t)(numbers))

static void unexpected(struct finding_scan *in, struct scan at, const char *what)
{
    char shown[SCAN_SHOWN];
    scan_blanks(&at);
    in->status =
        scan_fail(&at, in->reason, "%s is needed here, not %s", what, scan_show(&at, shown));
}

void finding_word(struct finding_scan *in, const char *what, char word[FINDING_WORD_MOST])
{
    struct scan before = in->scan;
    const char *start;
    word[0] = '\0';
    if (in->status)
        return;
    size_t length = scan_word(&in->scan, &start);
    if (length == 0 || length >= FINDING_WORD_MOST || memchr(start, 0, length)) {
        unexpected(in, before, what);
        return;
    }
    memcpy(word, start, length);
    word[length] = '\0';
}

void finding_keyword(struct finding_scan *in, const char *expected)
{
    struct scan before = in->scan;
    const char *start;
    char what[40];
    if (in->status)
        return;
    size_t length = scan_word(&in->scan, &start);
    snprintf(what, sizeof what, "'%s'", expected);
    if (length != strlen(expected) || memcmp(start, expected, length) != 0)
        unexpected(in, before, what);
}

uint64_t finding_whole(struct finding_scan *in, const char *what, uint64_t most)
{
    struct scan before = in->scan;
    char shown[SCAN_SHOWN];
    const char *start;
    uint64_t value = 0;
    if (in->status)
        return 0;
    size_t length = scan_word(&in->scan, &start);
    bool good = length > 0;
    for (size_t i = 0; i < length && good; i++) {
        uint64_t digit = (uint64_t)(start[i] - '0');
        good = start[i] >= '0' && start[i] <= '9' && value <= (most - digit) / 10 && digit <= most;
        value = 10 * value + digit;
    }
    if (good)
        return value;
    scan_blanks(&before);
    in->status = scan_fail(&before, in->reason, "%s: %s is not a whole number from 0 to %llu", what,
                           scan_show(&before, shown), (unsigned long long)most);
    return 0;
}

float finding_float(struct finding_scan *in, const char *what, bool any)
{
    char shown[SCAN_SHOWN];
    const char *rule;
    float x;
    if (in->status)
        return 0;
    scan_blanks(&in->scan);
    if (scan_line_done(&in->scan)) {
        unexpected(in, in->scan, what);
        return 0;
    }
    struct scan after = in->scan;
    after.at = float_word_read(in->scan.at, &x, &rule);
    if (after.at && scan_word_done(&after) && (any || float_is_finite(x))) {
        in->scan.at = after.at;
        return x;
    }
    if (after.at)
        rule = scan_word_done(&after) ? "not finite" : "not a number";
    in->status =
        scan_fail(&in->scan, in->reason, "%s: %s is %s", what, scan_show(&in->scan, shown), rule);
    return 0;
}

void finding_text(struct finding_scan *in, char *out, size_t size)
{
    struct scan *scan = &in->scan;
    char comment = scan->comment;
    size_t length = 0, kept = 0;
    scan->comment = 0;
    scan_blanks(scan);
    for (; !in->status && !scan_line_done(scan); scan->at++) {
        char c = *scan->at == '\t' ? ' ' : *scan->at;
        if (c < 0x20 || c > 0x7E)
            in->status =
                scan_fail(scan, in->reason, "the text has a byte that is no printable ASCII");
        else if (length + 1 >= size)
            in->status =
                scan_fail(scan, in->reason, "the text has more than %zu characters", size - 1);
        else
            out[length++] = c;
        if (c != ' ')
            kept = length;
    }
    out[kept] = '\0';
    scan->comment = comment;
}

void finding_line_end(struct finding_scan *in)
{
    if (in->status)
        return;
    scan_blanks(&in->scan);
    if (scan_line_done(&in->scan))
        scan_next_line(&in->scan);
    else
        unexpected(in, in->scan, "the end of the line");
}

void finding_skip(struct finding_scan *in)
{
    struct scan *scan = &in->scan;
    for (scan_blanks(scan); scan->at < scan->end && scan_line_done(scan); scan_blanks(scan))
        scan_next_line(scan);
}

void *finding_count(struct finding_scan *in, const char *keyword, uint32_t most, int numbers,
                    size_t size, uint32_t *count)
{
    const struct scan *scan = &in->scan;
    *count = 0;
    finding_skip(in);
    finding_keyword(in, keyword);
    uint64_t value = finding_whole(in, keyword, UINT64_MAX);
    void *array = NULL;
    if (in->status)
        return NULL;
    if (value > (size_t)(scan->end - scan->at) / LEAST_LINE(numbers))
        in->status =
            scan_fail(scan, in->reason, "%s: %llu of them do not fit into the rest of the file",
                      keyword, (unsigned long long)value);
    else if (value > most)
        in->status = fail(in->reason, STATUS_LIMIT, "%s:%llu: a trial has at most %u %s",
                          scan->name, (unsigned long long)scan->line, most, keyword);
    else if (!(array = alloc_zeroed((size_t)value, size)))
        in->status = fail(in->reason, STATUS_MEMORY, "%s: no memory for %llu %s", scan->name,
                          (unsigned long long)value, keyword);
    else
        *count = (uint32_t)value;
    finding_line_end(in);
    return array;
}
