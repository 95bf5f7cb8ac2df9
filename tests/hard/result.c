#include "tests/hard/run.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Text that is appended to until the buffer is full. */
struct result_line {
    char *text;
    size_t used, room;
};

static void PRINTF_LIKE(2, 3) add(struct result_line *line, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (line->used < line->room) {
        int n = vsnprintf(line->text + line->used, line->room - line->used, format, args);
        line->used += n > 0 ? (size_t)n : 0;
    }
    va_end(args);
}

static void add_counts(struct result_line *line, const struct hard_result *result)
{
    add(line, "%zu parts, %zu rays, %zu hits", result->played, result->rays, result->hits);
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        if (result->count[v] && v != VERDICT_WRONG)
            add(line, ", %s %zu", verdict_name(v), result->count[v]);
    for (enum wrong w = WRONG_NOT + 1; w < WRONG_COUNT; w++)
        if (result->wrong[w])
            add(line, ", WRONG %s %zu", wrong_name(w), result->wrong[w]);
    for (enum hard_property p = PROPERTY_VERDICT + 1; p < PROPERTY_COUNT; p++)
        if (result->broken[p])
            add(line, ", broken %s %zu", hard_property_name(p), result->broken[p]);
    if (result->refused)
        add(line, "; %zu parts refused", result->refused);
}

void hard_result_print(const struct hard_result *result, char *text, size_t text_bytes)
{
    struct result_line line = {text, 0, text_bytes};
    text[0] = '\0';
    if (result->outcome == HARD_REFUSED || result->outcome == HARD_SKIPPED) {
        add(&line, "%s", result->reason.text);
        return;
    }
    add_counts(&line, result);
    if (result->outcome == HARD_FAILED && result->reason.text[0])
        add(&line, "; %s", result->reason.text);
    if (!result->part_label[0])
        return;
    add(&line, "; first in part %s, %s", result->part_label, hard_property_name(result->property));
    if (result->ray_index == SIZE_MAX)
        return;
    char ray[400];
    judge_line(&result->ray, &result->judgement, &result->got, ray, sizeof ray);
    add(&line, ": ray %zu %s", result->ray_index, ray);
}
