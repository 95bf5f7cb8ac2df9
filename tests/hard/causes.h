/* Why a member breaks a case: its wrong answers explained (ref/explain). */
#ifndef HARD_CAUSES_H
#define HARD_CAUSES_H

#include "ref/explain/repair.h"
#include "tests/hard/run.h"

#define HARD_EXPLAINED 8   /* rays of a case that are explained */
#define HARD_LOST      256 /* and lost hits of an engine that keeps its tree to itself */

struct hard_causes {
    size_t count[CAUSE_COUNT]; /* explained rays by cause */
    size_t explained;
    enum cause most; /* the most frequent; CAUSE_NONE: nothing could be explained */
    char hint[400];  /* an engine that keeps its tree to itself: which box tests lose rays too */
};

/* Explains the first wrong rays of a case that `member` has just been played on, with that
 * `result`. Hits lost by an engine with a tree of its own are tried against known box tests
 * (ref/explain/outside.h). Errors: those of the engine and the oracle; STATUS_MEMORY. */
enum status hard_explain(struct hard_stage *stage, const struct hard_member *member,
                         const struct hard_result *result, struct hard_causes *out,
                         struct reason *reason) MUST_USE;

/* "rounded_inward (7 of 8 rays)", with the hint. */
void hard_causes_print(const struct hard_causes *causes, char *text, size_t text_bytes);

#endif
