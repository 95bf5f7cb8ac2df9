/* What the last pass of the list does, taken apart. */
#include "gpu/bisect/bisect_inner.h"

#include <stdlib.h>
#include <string.h>

/* The modules on both sides of the last pass. Elements of the search are hunks at first, then the
 * edits of those that were found. */
struct changing {
    struct bisect_search *search;
    struct bisect_module module[2];
    struct spirv_code code[2];
    struct spirv_diff diff;
    bool *done; /* of each edit: for the module that is asked about */
    size_t *of; /* of each edit: its element, or SIZE_MAX: it is not done */
    bool *in;   /* elements */
};

static enum delta_answer ask_edits(void *user, const bool *in)
{
    struct changing *c = user;
    struct bisect_search *search = c->search;
    struct bisect_module module;
    struct reason reason = {""};
    if (search->job->step)
        search->job->step(search->job->user, search->what, ++search->out->edit_tries);
    for (size_t e = 0; e < c->diff.count; e++)
        c->done[e] = c->of[e] != SIZE_MAX && in[c->of[e]];
    enum status status = spirv_diff_apply(&c->diff, c->done, &module.word, &module.count, &reason);
    return status ? bisect_stop(search, status, &reason) : bisect_ask(search, module);
}

/* Reduces `count` elements, all of which show it. Returns whether none can be left out. */
static bool reduce(struct changing *c, size_t count)
{
    struct delta delta = {
        .ask = ask_edits, .user = c, .count = count, .most = c->search->job->most};
    enum status status;
    for (size_t i = 0; i < count; i++)
        c->in[i] = true;
    const bool least = delta_reduce(&delta, c->in, &status);
    if (status)
        bisect_stop(c->search, status, NULL);
    for (size_t e = 0; e < c->diff.count; e++)
        if (c->of[e] != SIZE_MAX && !c->in[c->of[e]])
            c->of[e] = SIZE_MAX;
    return least;
}

static size_t number_edits(struct changing *c)
{
    size_t count = 0;
    for (size_t e = 0; e < c->diff.count; e++)
        if (c->of[e] != SIZE_MAX)
            c->of[e] = count++;
    return count;
}

static void search_edits(struct changing *c)
{
    struct bisect *out = c->search->out;
    out->edits = c->diff.count;
    c->search->what = "parts of the change";
    for (size_t e = 0; e < c->diff.count; e++)
        c->of[e] = c->diff.edit[e].hunk;
    for (size_t i = 0; i < c->diff.hunks; i++)
        c->in[i] = true;
    const enum delta_answer all = ask_edits(c, c->in);
    out->end = all == DELTA_SHOWS ? BISECT_FOUND : BISECT_WHOLE;
    if (all != DELTA_SHOWS)
        return;
    out->least = reduce(c, c->diff.hunks);
    if (!c->search->status)
        out->least = reduce(c, number_edits(c)) && out->least;
    out->edit_count = number_edits(c);
    for (size_t e = 0; e < c->diff.count; e++)
        c->done[e] = c->of[e] != SIZE_MAX;
    if (!c->search->status)
        bisect_say(&c->diff, c->done, out);
}

static enum status make_sides(struct changing *c, struct reason *reason)
{
    const struct bisect *out = c->search->out;
    bool *in = alloc_copy(out->in, out->pass_count, sizeof *in);
    if (!in)
        return fail(reason, STATUS_MEMORY, "no memory for a list of passes");
    size_t last = out->pass_count;
    while (last > 0 && !in[last - 1])
        last--;
    enum status status = bisect_make(c->search, in, &c->module[1], reason);
    if (last > 0)
        in[last - 1] = false;
    if (!status)
        status = bisect_make(c->search, in, &c->module[0], reason);
    free(in);
    for (int i = 0; i < 2 && !status; i++)
        status = spirv_code_make(c->module[i].word, c->module[i].count, &c->code[i], reason);
    if (!status)
        status = spirv_diff_make(&c->code[0], &c->code[1], &c->diff, reason);
    c->done = alloc_zeroed(c->diff.count, sizeof *c->done);
    c->in = alloc_zeroed(c->diff.count, sizeof *c->in);
    c->of = alloc_zeroed(c->diff.count, sizeof *c->of);
    if (!status && !(c->done && c->in && c->of))
        status = fail(reason, STATUS_MEMORY, "no memory for a diff");
    return status;
}

void bisect_change(struct bisect_search *search)
{
    struct changing c = {.search = search};
    struct reason reason = {""};
    enum status status = make_sides(&c, &reason);
    if (status)
        bisect_stop(search, status, &reason);
    else
        search_edits(&c);
    free(c.done);
    free(c.in);
    free(c.of);
    spirv_diff_free(&c.diff);
    for (int i = 0; i < 2; i++) {
        spirv_code_free(&c.code[i]);
        free(c.module[i].word);
    }
}
