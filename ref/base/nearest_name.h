/* Finds the name that a mistyped word may mean. */
#ifndef NEAREST_NAME_H
#define NEAREST_NAME_H

#include "ref/base/base.h"

/* Call nearest_make with a word that is no known name, then nearest_try with each name. `name` is
 * then the name with the fewest changed characters (inserted, deleted, replaced, swapped with the
 * next), the first of several. At most 1 + length / 4 changes are allowed. */
struct nearest_name {
    const char *word;
    size_t length;
    const char *name; /* NULL: no name is near */
    size_t distance;
};

struct nearest_name nearest_make(const char *word, size_t length);
void nearest_try(struct nearest_name *nearest, const char *name);

/* Bytes of nearest_hint. */
#define NEAREST_HINT 64

/* Writes "; did you mean NAME?", or nothing if no name is near. Returns `text`. */
const char *nearest_hint(const struct nearest_name *nearest, char text[NEAREST_HINT]);

#endif
