/* A change in words. */
#include "gpu/bisect/bisect_inner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bisect_put_line(struct bisect *out, char sign, const uint32_t *word)
{
    if (out->line_count == BISECT_LINES_MOST)
        return;
    struct bisect_line *line = &out->line[out->line_count++];
    line->sign = sign;
    spirv_say(word, line->text);
}

static const uint32_t *edit_words(const struct spirv_diff *diff, size_t e)
{
    const struct spirv_edit *edit = &diff->edit[e];
    return spirv_words(edit->added ? diff->after : diff->before, edit->at);
}

static bool is_loss(const struct spirv_diff *diff, size_t e)
{
    const uint32_t *word = edit_words(diff, e);
    return !diff->edit[e].added && (word[0] & 0xFFFFu) == OP_DECORATE && word[0] >> 16 == 3 &&
           word[2] == NO_CONTRACTION;
}

/* The added edit that makes the same id as removed edit e, or diff->count. */
static size_t partner(const struct spirv_diff *diff, const bool *done, size_t e)
{
    const uint32_t id = spirv_result(edit_words(diff, e));
    size_t k = 0;
    while (k < diff->count &&
           !(done[k] && diff->edit[k].added && id > 0 && spirv_result(edit_words(diff, k)) == id))
        k++;
    return k;
}

static int by_value(const void *a, const void *b)
{
    const uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

/* Whether two instructions have the same operands in another order. */
static bool is_permuted(const uint32_t *a, const uint32_t *b)
{
    uint32_t left[8], right[8];
    const uint32_t from = spirv_operands(a), count = (a[0] >> 16) - from;
    if (a[0] != b[0] || (a[0] >> 16) < from || count > 8)
        return false;
    memcpy(left, a + from, count * sizeof *a);
    memcpy(right, b + from, count * sizeof *a);
    qsort(left, count, sizeof left[0], by_value);
    qsort(right, count, sizeof right[0], by_value);
    return memcmp(left, right, count * sizeof left[0]) == 0;
}

/* How much a removed or added edit says: of the change all are shown, and one is put in words. */
enum { SAYS_ADDED, SAYS_REMOVED, SAYS_LOSS, SAYS_OPERANDS, SAYS_ORDER, SAYS_BECAME };

static int weight(const struct spirv_diff *diff, const bool *done, size_t e)
{
    const uint32_t *word = edit_words(diff, e);
    if (diff->edit[e].added)
        return SAYS_ADDED;
    const size_t other = partner(diff, done, e);
    if (other == diff->count)
        return is_loss(diff, e) ? SAYS_LOSS : SAYS_REMOVED;
    const uint32_t *now = edit_words(diff, other);
    if ((word[0] & 0xFFFFu) != (now[0] & 0xFFFFu))
        return SAYS_BECAME;
    return is_permuted(word, now) ? SAYS_ORDER : SAYS_OPERANDS;
}

static void say_id(const struct spirv_diff *diff, uint32_t id, char text[SPIRV_SAY_MOST])
{
    const size_t maker = spirv_maker(diff->before, id);
    char name[SPIRV_SAY_MOST] = "?";
    if (maker < diff->before->count)
        spirv_say_name(spirv_words(diff->before, maker), name);
    snprintf(text, SPIRV_SAY_MOST, "%%%u (%.100s)", id, name);
}

static void say_edit(const struct spirv_diff *diff, const bool *done, size_t e, struct bisect *out)
{
    const uint32_t *word = edit_words(diff, e);
    const struct spirv_edit *edit = &diff->edit[e];
    const size_t other = edit->added ? diff->count : partner(diff, done, e);
    char was[SPIRV_SAY_MOST], now[SPIRV_SAY_MOST] = "", id[SPIRV_SAY_MOST];
    spirv_say_name(word, was);
    if (other < diff->count)
        spirv_say_name(edit_words(diff, other), now);
    snprintf(id, sizeof id, "%%%u (%.100s)", spirv_result(word), was);
    size_t place = edit->at;
    switch (weight(diff, done, e)) {
    case SAYS_BECAME:
        snprintf(out->what, sizeof out->what, "%.100s of %%%u became %.100s", was,
                 spirv_result(word), now);
        break;
    case SAYS_ORDER:
        snprintf(out->what, sizeof out->what, "operands of %s in another order", id);
        break;
    case SAYS_OPERANDS:
        snprintf(out->what, sizeof out->what, "other operands of %s", id);
        break;
    case SAYS_LOSS:
        say_id(diff, word[1], id);
        snprintf(out->what, sizeof out->what, "NoContraction of %s is gone", id);
        place = spirv_maker(diff->before, word[1]);
        break;
    default:
        spirv_say(word, id);
        snprintf(out->what, sizeof out->what, "%s %s", id, edit->added ? "is new" : "is gone");
        break;
    }
    const struct spirv_code *code = edit->added ? diff->after : diff->before;
    if (place < code->count)
        spirv_function(code, place, out->function);
}

void bisect_say(const struct spirv_diff *diff, const bool *done, struct bisect *out)
{
    size_t most = diff->count;
    for (size_t e = 0; e < diff->count; e++) {
        if (!done[e])
            continue;
        bisect_put_line(out, diff->edit[e].added ? '+' : '-', edit_words(diff, e));
        const size_t maker =
            is_loss(diff, e) ? spirv_maker(diff->before, edit_words(diff, e)[1]) : SIZE_MAX;
        if (maker < diff->before->count)
            bisect_put_line(out, ' ', spirv_words(diff->before, maker));
        if (most == diff->count || weight(diff, done, e) > weight(diff, done, most))
            most = e;
    }
    if (most < diff->count)
        say_edit(diff, done, most, out);
}
