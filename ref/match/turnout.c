#include "ref/match/turnout.h"

#include "ref/base/command.h"
#include "ref/base/text.h"

#include <stdio.h>
#include <string.h>

static struct turnout_one *find(struct turnout *turnout, const char *kind, const char *name)
{
    for (size_t i = 0; i < turnout->count; i++)
        if (strcmp(turnout->one[i].kind, kind) == 0 && strcmp(turnout->one[i].name, name) == 0)
            return &turnout->one[i];
    return NULL;
}

void turnout_name(struct turnout *turnout, const char *kind, const char *name)
{
    if (find(turnout, kind, name) || turnout->count == TURNOUT_MOST)
        return;
    struct turnout_one *one = &turnout->one[turnout->count++];
    *one = (struct turnout_one){.declines = strcmp(kind, "engine") == 0};
    snprintf(one->kind, sizeof one->kind, "%s", kind);
    snprintf(one->name, sizeof one->name, "%s", name);
}

void turnout_add(struct turnout *turnout, const char *kind, const char *name, enum turnout_end end,
                 size_t count, const char *reason)
{
    struct turnout_one *one = find(turnout, kind, name);
    if (!one)
        return;
    one->end[end] += count;
    if (count > 0 && end != TURNOUT_ANSWERED && one->reason.text[0] == '\0')
        snprintf(one->reason.text, sizeof one->reason.text, "%s", reason);
}

bool turnout_of_engine(const struct row *row, enum turnout_end *end)
{
    switch (row->status) {
    case ROW_OK:
    case ROW_VACUOUS: /* the row itself fails */
        *end = TURNOUT_ANSWERED;
        return true;
    case ROW_REFUSED:
        *end = TURNOUT_REFUSED;
        return row->declined;
    case ROW_SKIPPED:
        *end = row->absent ? TURNOUT_ABSENT : TURNOUT_SKIPPED;
        return true;
    case ROW_FAILED:
        break;
    }
    *end = TURNOUT_FAILED;
    return true;
}

enum turnout_end turnout_of_member(const struct row *row)
{
    enum turnout_end end;
    if (!turnout_of_engine(row, &end))
        return TURNOUT_REFUSED;
    return end == TURNOUT_REFUSED ? TURNOUT_SKIPPED : end;
}

void turnout_row(struct turnout *turnout, const struct row *row)
{
    enum turnout_end end;
    if (row->engine && turnout_of_engine(row, &end))
        turnout_add(turnout, "engine", row->engine->name, end, 1, row->reason.text);
    if (row->layout)
        turnout_add(turnout, "layout", row->layout->name, turnout_of_member(row), 1,
                    row->reason.text);
}

void turnout_rows(struct turnout *turnout, const struct row *row, size_t count)
{
    for (size_t i = 0; i < count; i++)
        turnout_row(turnout, &row[i]);
}

size_t turnout_asked(const struct turnout_one *one)
{
    size_t asked = 0;
    for (int i = 0; i < TURNOUT_ENDS; i++)
        asked += one->end[i];
    return asked;
}

/* True if it answered some, but refused nearly all. */
static bool answered_little(const struct turnout_one *one)
{
    const size_t answered = one->end[TURNOUT_ANSWERED], refused = one->end[TURNOUT_REFUSED];
    return one->declines && answered > 0 && TURNOUT_ONE_IN * answered < answered + refused;
}

int turnout_code(const struct turnout_one *one)
{
    size_t asked = turnout_asked(one);
    if (one->end[TURNOUT_ANSWERED] > 0)
        return answered_little(one) ? EXIT_MISMATCH : EXIT_AGREE;
    return asked > 0 && one->end[TURNOUT_ABSENT] == asked ? EXIT_SKIPPED : EXIT_MISMATCH;
}

int turnout_exit(const struct turnout *turnout)
{
    int code = EXIT_AGREE;
    for (size_t i = 0; i < turnout->count; i++)
        code = exit_worse(code, turnout_code(&turnout->one[i]));
    return code;
}

bool turnout_tells(const struct turnout_one *one)
{
    size_t answered = one->end[TURNOUT_ANSWERED];
    return answered == 0 || answered < turnout_asked(one);
}

void turnout_line(const struct turnout_one *one, char *text, size_t text_bytes)
{
    static const char *const words[TURNOUT_ENDS] = {"answered", "refused", "skipped",
                                                    "cannot run here", "failed"};
    size_t asked = turnout_asked(one);
    snprintf(text, text_bytes, "answered %zu of %zu", one->end[TURNOUT_ANSWERED], asked);
    for (int i = TURNOUT_REFUSED; i < TURNOUT_ENDS; i++)
        if (one->end[i] > 0)
            text_append(text, text_bytes, ", %s %zu", words[i], one->end[i]);
    if (one->reason.text[0])
        text_append(text, text_bytes, ": %.200s", one->reason.text);
    if (turnout_code(one) == EXIT_MISMATCH)
        text_append(text, text_bytes, "; vacuous: %s",
                    asked == 0                        ? "it was not run"
                    : one->end[TURNOUT_ANSWERED] == 0 ? "nothing of it is tested"
                                                      : "hardly anything of it is tested");
}
