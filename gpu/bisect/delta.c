#include "gpu/bisect/delta.h"

#include <stdlib.h>
#include <string.h>

/* A search: the set, its size, and one to ask about. */
struct reducing {
    struct delta *delta;
    bool *in, *ask;
    size_t left;
    bool stopped;
};

/* Sets r->ask to the elements of part `part` of `parts` of the set, or to all but these. */
static void choose(struct reducing *r, size_t part, size_t parts, bool without)
{
    const size_t from = part * r->left / parts, to = (part + 1) * r->left / parts;
    for (size_t i = 0, at = 0; i < r->delta->count; i++) {
        const bool inside = r->in[i] && at >= from && at < to;
        r->ask[i] = r->in[i] && inside != without;
        at += r->in[i];
    }
}

static bool shows(struct reducing *r)
{
    if (r->delta->tries >= r->delta->most) {
        r->stopped = true;
        return false;
    }
    r->delta->tries++;
    const enum delta_answer answer = r->delta->ask(r->delta->user, r->ask);
    r->stopped = r->stopped || answer == DELTA_STOP;
    return answer == DELTA_SHOWS;
}

static size_t count_of(const bool *in, size_t count)
{
    size_t left = 0;
    for (size_t i = 0; i < count; i++)
        left += in[i];
    return left;
}

static void take(struct reducing *r)
{
    memcpy(r->in, r->ask, r->delta->count * sizeof *r->in);
    r->left = count_of(r->in, r->delta->count);
}

/* Looks for a smaller set that shows it: a part, or all but a part. *parts: as many next time. */
static bool reduce_once(struct reducing *r, size_t *parts)
{
    const size_t of = *parts;
    for (size_t i = 0; i < of && !r->stopped; i++) {
        choose(r, i, of, false);
        if (shows(r)) {
            take(r);
            *parts = 2;
            return true;
        }
    }
    for (size_t i = 0; i < of && of > 2 && !r->stopped; i++) {
        choose(r, i, of, true);
        if (shows(r)) {
            take(r);
            *parts = of - 1;
            return true;
        }
    }
    return false;
}

bool delta_reduce(struct delta *delta, bool *in, enum status *status)
{
    struct reducing r = {.delta = delta, .in = in, .left = count_of(in, delta->count)};
    *status = STATUS_OK;
    r.ask = alloc_zeroed(delta->count, sizeof *r.ask);
    if (!r.ask) {
        *status = STATUS_MEMORY;
        return false;
    }
    for (size_t parts = 2; r.left > 1 && !r.stopped;) {
        if (parts > r.left)
            parts = r.left;
        if (reduce_once(&r, &parts))
            continue;
        if (parts == r.left)
            break;
        parts *= 2;
    }
    free(r.ask);
    return !r.stopped;
}
