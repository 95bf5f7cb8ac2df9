/* Judging the answers of a row; for match.c. */
#ifndef MATCH_JUDGE_H
#define MATCH_JUDGE_H

#include "ref/match/match.h"

/* Judges match->answer and counts in the row: against the truth; against match->against if the row
 * is compared; repeatability by match->unstable; any-hits against match->closest if that is of the
 * same engine and box test. Errors: STATUS_MEMORY. */
enum status match_judge(const struct match *match, const struct model *model,
                        struct row *row) MUST_USE;

/* Sorts an unknown formula's row->displacement.count displacements and takes their percentiles, by
 * nearest rank. */
void match_displacements(double *displacement, struct row *row);

/* Counts judgements of answers or lists in a row. */
struct match_tally {
    struct row *row;
    double *displacement; /* of an unknown formula, or NULL */
    uint8_t *note;        /* likewise, but of scenes alone: of match_edges_note, one per ray */
};

/* Returns false without memory; match_tally_end frees it in any case. */
bool match_tally_start(struct row *row, struct match_tally *out);

/* Counts the judgement of ray i. `hit`: a triangle was answered. */
void match_tally_add(struct match_tally *tally, size_t i, bool hit,
                     const struct judgement *judgement);

/* Keeps `what`, all of it but the ray and its truth, as a finding about ray i; of a world's, `what`
 * has the tags. */
void match_keep_finding(const struct match *match, size_t i, const struct finding *what,
                        struct row *row);

/* Fills in what follows from the counts; `status`: that of the judging. Returns it, or
 * STATUS_MEMORY. */
enum status match_tally_end(struct match_tally *tally, const struct match *match,
                            enum status status) MUST_USE;

#endif
