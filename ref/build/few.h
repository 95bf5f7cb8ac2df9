/* The cheapest split of a few references, exactly. */
#ifndef FEW_H
#define FEW_H

#include "ref/build/refs.h"

#define FEW_MOST 8u

/* What a node costs against its triangles, each per unit of area: see README, quality of trees. */
#define COST_NODE 1.0f

/* Orders 2 to FEW_MOST references so that the first side of the cheapest of all splits between
 * centres comes first, and returns how many these are; 0 where a leaf costs no more and may hold
 * them all, `leaf` being the most. */
uint32_t few_split(struct ref *ref, uint32_t count, uint32_t leaf);

#endif
