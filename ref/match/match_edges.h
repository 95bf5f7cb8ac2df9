/* How often a black box loses hits beside edges; for match*.c. */
#ifndef MATCH_EDGES_H
#define MATCH_EDGES_H

#include "ref/match/match.h"

/* The class of an answer's margin, 1 + place in row->edges, and whether the hit was lost; 0: the
 * exact nearest hit lies farther inside, or so near an edge that any test may lose it. */
uint8_t match_edges_note(const struct judgement *judgement);

/* Adds the notes of `count` rays to `edges`; a ray that was given several times counts once.
 * Errors: STATUS_MEMORY. */
enum status match_edges_add(const struct ray *ray, const uint8_t *note, size_t count,
                            struct edges_lost edges[MATCH_EDGES]) MUST_USE;

/* The same of row->rays rays for row->edges, and row->edges_beyond. Errors: STATUS_MEMORY. */
enum status match_edges_count(const struct ray *ray, const uint8_t *note, struct row *row);

#endif
