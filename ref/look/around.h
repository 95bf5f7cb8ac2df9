/* The boxes of a packed tree that a point lies in. */
#ifndef LOOK_AROUND_H
#define LOOK_AROUND_H

#include "ref/layout.h"

struct around; /* the decoded tree, each node once */

/* Errors: STATUS_MEMORY; *out is then NULL. */
enum status around_make(const struct packed *packed, struct around **out) MUST_USE;

/* Counts the boxes around `p` all of whose ancestors are around it, too: all, and those of leaves.
 * Safe from several threads at once. */
void around_count(const struct around *around, const double p[3], uint32_t *boxes,
                  uint32_t *leaves);

void around_free(struct around *around); /* NULL is fine */

#endif
