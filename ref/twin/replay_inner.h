/* What the replays of formulas share; for ref/twin/replay*.c only. */
#ifndef REPLAY_INNER_H
#define REPLAY_INNER_H

#include "ref/twin/quotients.h"
#include "ref/twin/twin_replay.h"

/* One replay. */
struct replay {
    const struct liberty *k;
    const struct replay_answer *answer;
    struct scatter o[3], d[3], v[3][3];
    bool same[3]; /* the vertices other than this one are equal */
};

/* a - b and a x b of vectors. */
void replay_subtract(const struct liberty *k, const struct scatter a[3], const struct scatter b[3],
                     struct scatter out[3]);
void replay_cross(const struct liberty *k, const struct scatter a[3], const struct scatter b[3],
                  struct scatter out[3]);

/* Quotients by `divisor`, none as yet. */
struct quotients replay_quotients(const struct replay *w, struct scatter divisor);

/* Adds the numerator of t, u or v; `which`: 0, 1 or 2. */
void replay_part(const struct replay *w, struct quotients *s, struct scatter number, int which);

/* u, v and u + v as a test accepts them: each from 0, the sum up to 1, but for roundings and what a
 * numerator may lose when it is flushed. `band`: how far they may lie outside besides. */
bool replay_weights(const struct replay *w, const struct scatter *divisor, double band);

/* The vertices in the order of the formula's axes. */
void replay_vertices(struct replay *w, const int axis[3], float v[3][3]);

/* Whether the formula can give the answer. */
bool replay_formula(struct replay *w, enum twin_formula formula);

/* `accel`: tri_accel, of the same numbers. */
bool replay_baldwin_webber(const struct replay *w, bool accel);

#endif
