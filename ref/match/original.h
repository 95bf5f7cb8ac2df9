/* The second judgement of answers to a scene that was quantised: for the scene as it was. */
#ifndef ORIGINAL_H
#define ORIGINAL_H

#include "ref/match/match.h"
#include "ref/scene/quantise.h"

/* Everything but oracle and truth is borrowed. */
struct original {
    const struct scene *scene;
    struct quantised quantised;
    struct oracle *oracle;
    struct oracle_answer *truth; /* of the match's rays */
};

/* Decides the rays for the scene as it was. Errors: as oracle_make and oracle_closest. */
enum status original_make(const struct scene *scene, const struct quantised *quantised,
                          const struct ray *ray, size_t ray_count, struct original *out,
                          struct reason *reason) MUST_USE;

/* Judges match->answer, of the row that was just run on the decoded scene, once more: fills in
 * row->original and adds to row->differences. An answer that needs a displacement of n to be right
 * for the decoded scene, by rounding, may need n + quantised.distance for the original, and no
 * more: what is WRONG for the decoded scene is not counted twice. Answers whose
 * triangle is none of the scene's or whose t is not finite, rays out of contract and lists are left
 * out. Errors: STATUS_MEMORY. */
enum status original_judge(const struct original *original, const struct match *match,
                           struct row *row) MUST_USE;

/* Counts the triangles of a decoded scene whose vertices are collinear. */
uint32_t original_flat(const struct scene *decoded);

void original_free(struct original *original);

#endif
