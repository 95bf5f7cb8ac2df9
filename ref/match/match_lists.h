/* Rows of all hits: every triangle along each ray, listed, sorted and judged; for match.c. */
#ifndef MATCH_LISTS_H
#define MATCH_LISTS_H

#include "ref/match/match.h"

/* Lists all hits of row->rays rays twice with an engine that is prepared for QUERY_ALL, judges
 * them, and counts in the row; match->answer gets the nearest hits.
 *   beside  the self of row->against, prepared for the same job, if that is another engine; else
 *           NULL
 * Errors: those of trace_all; STATUS_MEMORY. */
enum status match_lists(struct match *match, const struct engine *engine, void *self, void *beside,
                        const struct model *model, struct row *row) MUST_USE;

#endif
