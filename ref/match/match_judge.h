/* Judging the answers of a row; for match.c. */
#ifndef MATCH_JUDGE_H
#define MATCH_JUDGE_H

#include "ref/match/match.h"

/* Judges match->answer and counts in the row: against the truth; against match->cpu if row->bits;
 * repeatability by match->unstable; any-hits against match->closest if that is of the same engine and
 * box test. Errors: STATUS_MEMORY. */
enum status match_judge(const struct match *match, const struct model *model,
                        struct row *row) MUST_USE;

/* Sorts an unknown formula's row->displacement.count displacements and takes their percentiles. */
void match_displacements(double *displacement, struct row *row);

#endif
