/* The list of passes: delta debugging, then shorter lists. */
#include "gpu/bisect/bisect_inner.h"

#include <stdlib.h>
#include <string.h>

static enum delta_answer ask_list(void *user, const bool *in)
{
    struct bisect_search *search = user;
    struct bisect_module module;
    struct reason reason = {""};
    if (search->job->step)
        search->job->step(search->job->user, search->what, ++search->out->pass_tries);
    enum status status = bisect_make(search, in, &module, &reason);
    if (status == STATUS_DEVICE) /* a pass that works behind others alone */
        return DELTA_UNRESOLVED;
    if (status)
        return bisect_stop(search, status, &reason);
    return bisect_ask(search, module);
}

static size_t count_of(const bool *in, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += in[i];
    return found;
}

/* Looks for a list of one pass, or of two, in their order. `in` has room for all of them, and is
 * that list if one is found. *whole: all were tried. */
static bool find_shorter(struct bisect_search *search, size_t passes, size_t *left, bool *in,
                         bool *whole)
{
    const struct bisect *out = search->out;
    for (size_t i = 0; i < out->pass_count; i++)
        for (size_t j = passes == 1 ? out->pass_count - 1 : i + 1; j < out->pass_count; j++) {
            if (*left == 0 || search->status) {
                *whole = false;
                return false;
            }
            memset(in, 0, out->pass_count * sizeof *in);
            in[i] = true;
            in[j] = in[j] || passes == 2;
            --*left;
            if (ask_list(search, in) == DELTA_SHOWS)
                return true;
        }
    return false;
}

/* Tries shorter lists than the one found. */
static void shorten(struct bisect_search *search)
{
    struct bisect *out = search->out;
    size_t found = count_of(out->in, out->pass_count), left = search->job->most;
    bool whole = true, *in = alloc_zeroed(out->pass_count, sizeof *in);
    if (!in) {
        bisect_stop(search, STATUS_MEMORY, NULL);
        return;
    }
    search->what = "shorter lists";
    for (size_t passes = 1; passes < found && passes <= 2 && whole; passes++)
        if (find_shorter(search, passes, &left, in, &whole)) {
            memcpy(out->in, in, out->pass_count * sizeof *in);
            found = passes;
        }
    out->proof = whole && found <= 3 ? BISECT_SHORTEST : BISECT_MINIMAL;
    free(in);
}

/* Leaves out passes, as long as it shows. */
static void reduce(struct bisect_search *search)
{
    struct bisect *out = search->out;
    struct delta delta = {
        .ask = ask_list, .user = search, .count = out->pass_count, .most = search->job->most};
    enum status status;
    search->what = "lists of passes";
    const bool least = delta_reduce(&delta, out->in, &status);
    if (status)
        bisect_stop(search, status, NULL);
    out->proof = least ? BISECT_MINIMAL : BISECT_ENDED;
    if (least && !search->status)
        shorten(search);
    out->found_count = count_of(out->in, out->pass_count);
}

void bisect_passes(struct bisect_search *search)
{
    struct bisect *out = search->out;
    for (size_t i = 0; i < out->pass_count; i++)
        out->in[i] = true;
    search->what = "lists of passes";
    if (ask_list(search, out->in) != DELTA_SHOWS) {
        out->end = BISECT_UNLIKE;
        return;
    }
    const enum delta_answer begun = ask_list(search, NULL);
    if (search->status)
        return;
    if (begun == DELTA_SHOWS) {
        struct bisect_module module;
        memset(out->in, 0, out->pass_count * sizeof *out->in);
        out->end = BISECT_AS_BUILT;
        out->proof = BISECT_SHORTEST;
        struct reason reason;
        if (search->job->compiler.decorate != DECORATE_NONE)
            return;
        enum status status = bisect_make(search, NULL, &module, &reason);
        if (status)
            bisect_stop(search, status, &reason);
        else
            bisect_decorations(search, module);
        return;
    }
    reduce(search);
    if (!search->status)
        bisect_change(search);
}
