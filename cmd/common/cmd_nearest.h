/* The name that a typo may have meant. For commands only. */
#ifndef CMD_NEAREST_H
#define CMD_NEAREST_H

#include "ref/base/base.h"

/* A word that is none of some names: nearest_make, nearest_try on each name, and then `name` is the
 * one with the fewest changes of a character (inserted, deleted, replaced, swapped with the next),
 * at most one and one more for every four characters; the first of several. */
struct nearest_name {
    const char *word;
    size_t length;
    const char *name; /* NULL: nothing is near */
    size_t distance;
};

struct nearest_name nearest_make(const char *word, size_t length);
void nearest_try(struct nearest_name *nearest, const char *name);

#endif
