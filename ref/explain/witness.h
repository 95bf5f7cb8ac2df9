/* Other rays of a scene, and an engine's answers to them: a defect that is planted to imitate the
 * engine has to give these answers, too. */
#ifndef EXPLAIN_WITNESS_H
#define EXPLAIN_WITNESS_H

#include "ref/explain/explain.h"

struct witnesses {
    struct ray ray[EXPLAIN_WITNESSES];
    bool is_far[EXPLAIN_WITNESSES];                   /* not the ray itself a little moved */
    struct explain_answer healthy[EXPLAIN_WITNESSES]; /* C's; the caller's */
    struct explain_answer answer[EXPLAIN_WITNESSES];  /* without flags */
    uint32_t count;
};

enum witness_kind {
    WITNESS_ALL,      /* near and far, by turns */
    WITNESS_VERTICES, /* far away and aimed at vertices, where boxes end */
    WITNESS_ALONG     /* the ray itself, moved along edges of triangles */
};

/* Makes the EXPLAIN_WITNESSES rays of round `round`. The scene has a triangle. */
void witnesses_make(const struct explain_case *the, uint32_t round, enum witness_kind kind,
                    struct witnesses *w);

/* Traces the `count` rays with the engine. */
void witnesses_ask(const struct explain_case *the, struct witnesses *w);

#endif
