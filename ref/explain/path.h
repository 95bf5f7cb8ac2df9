/* The path to one triangle through a packed tree, with everything that is stored on it. */
#ifndef EXPLAIN_PATH_H
#define EXPLAIN_PATH_H

#include "ref/explain/explain.h"

/* Follows the path to out->prim: sets step, step_count, last, end, slot and their details.
 * Errors: STATUS_MEMORY. */
enum status explain_path(const struct explain_case *the, struct explanation *out) MUST_USE;

#endif
