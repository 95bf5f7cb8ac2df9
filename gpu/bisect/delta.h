/* Delta debugging: from a set of elements that shows something, to one of which no element can be
 * left out. Elements are what the caller says: passes, or hunks of a module. */
#ifndef DELTA_H
#define DELTA_H

#include "ref/base/base.h"

enum delta_answer {
    DELTA_SHOWS,
    DELTA_SHOWS_NOT,
    DELTA_UNRESOLVED, /* nothing can be said, such as of a module that is not valid */
    DELTA_STOP,       /* the search cannot go on: delta_reduce returns */
};

struct delta {
    /* Whether the elements with in[i] show it. Asked never twice for the same ones in a row, and
     * never for none. */
    enum delta_answer (*ask)(void *user, const bool *in);
    void *user;
    size_t count;
    size_t most;  /* the most questions */
    size_t tries; /* asked until now */
};

/* Takes elements out of `in`, which must show it, as long as the rest does (Zeller's ddmin): parts
 * first, halves before quarters, then what is left without each part. Returns true if each single
 * element was tried to be left out of the result; false if `most` was reached before, or on
 * DELTA_STOP: `in` is then the smallest set found. The same answers give the same result. Errors:
 * STATUS_MEMORY in *status, and false. */
bool delta_reduce(struct delta *delta, bool *in, enum status *status);

#endif
