/* Finds the cheapest split of a few references, exactly. */
#ifndef FEW_H
#define FEW_H

#include "ref/build/refs.h"

#define FEW_MOST 8u

/* Cost of a node relative to a triangle, each per unit of area: see docs/builders.md. */
#define COST_NODE 1.0f

/* Orders 2 to FEW_MOST references so that the first side of the cheapest of all splits between
 * centres comes first, and returns its size. Returns 0 if a leaf costs no more and may hold all of
 * them; `leaf` is the most that it may hold. */
uint32_t few_split(struct ref *ref, uint32_t count, uint32_t leaf);

#endif
