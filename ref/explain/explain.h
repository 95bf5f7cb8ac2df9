/* Why one answer is wrong. The judge decides whether it is; here the ray is answered again with one
 * thing changed at a time, and the change that corrects the answer names the cause. */
#ifndef EXPLAIN_H
#define EXPLAIN_H

#include "ref/explain/replay.h"

/* The judgement of an answer. */
struct opinion {
    bool allowed;
    const char *text;  /* the class: "right", "tie", ..., "wrong: missed"; static */
    uint32_t expected; /* the triangle that should have been answered, or ABI_NO_PRIM */
};

typedef void opinion_fn(const void *user, const struct ray *ray, const struct hit *answer,
                        struct opinion *out);

/* Traces rays with the engine; false if it did not finish them. */
typedef bool ask_fn(void *user, const struct ray *ray, size_t count, struct hit *out);

/* What is to be explained; everything borrowed. */
struct explain_case {
    struct explain_replay replay; /* the same bytes, traced in C; tree NULL: engines without one */
    struct ray ray;
    opinion_fn *judge;
    const void *judge_user;
    ask_fn *ask; /* the engine, for witnesses; may be NULL */
    void *ask_user;
    bool bits;  /* the engine promises C's bits */
    bool exact; /* its operators are known to round as C's */
    bool known; /* its formula and its tree are those of `replay`; else both are unknown */
};

/* The engine's answer. */
struct explain_answer {
    bool finished;
    uint32_t flags; /* ABI_FLAG_* if it did not finish and reported why, else 0 */
    struct hit hit;
};

/* One repair that was tried. */
struct explain_attempt {
    enum repair repair;
    enum replay_end end;
    struct hit hit;
    struct opinion opinion;
    bool changed; /* the answer differs from that without it */
};

/* One planted defect that was tried. */
struct explain_imitation {
    enum defect defect;
    uint32_t parameter;
    bool same;          /* it gives the engine's answer to the ray */
    bool refuted;       /* and another one to too many of the other rays */
    uint32_t witnesses; /* other rays to which it gives the engine's answer */
    uint32_t telling;   /* other rays to which its answer is not C's: only these are evidence */
    uint32_t told;      /* those of them to which it gives the engine's answer */
    uint32_t far_telling,
        far_told;   /* the same of rays that are not the ray itself a little moved */
    uint32_t kept;  /* other rays to which both give the same hit */
    uint32_t asked; /* other rays until it was refuted, or all */
};

#define EXPLAIN_IMITATIONS (DEFECT_COUNT + 8 + 2 * ABI_STACK_MAX + 8)
/* An imitation is a cause only if the engine agrees with it on at least this many other rays to
 * which C answers otherwise, and also finds hits: what differs from C on the ray alone could be any
 * miss, and so could what loses everything. */
#define EXPLAIN_TELLING   3u
#define EXPLAIN_WITNESSES 400u /* of one round */

/* One bound of a box on the path, in all its forms. */
struct explain_bound {
    float exact, canonical, decoded;
    enum bound_fault fault;
    double half_steps;   /* from exact to decoded, positive outward */
    int64_t float_steps; /* the same */
};

/* The oriented box of a node, and its test (layout->oblique). */
struct explain_oriented {
    bool missed;                       /* as note.missed */
    bool there;                        /* it was tested */
    struct oblique_box box;            /* as stored, and for this ray */
    struct explain_bound lo[3], hi[3]; /* along its axes; the tree has none, so canonical = exact */
    double exact_enter[3], exact_leave[3]; /* of the stored bounds, without an allowance */
};

/* A node on the path to the triangle, root first. */
struct explain_step {
    struct replay_note note; /* of the plain replay */
    uint32_t record;         /* or EXPLAIN_NONE */
    bool leaf;
    enum ref_fault ref; /* of its children */
    struct explain_bound lo[3], hi[3];
    struct slab_axis slab[3]; /* of its decoded box */
    struct explain_oriented oriented;
    uint32_t word[WIDE_MAX * 8];
    uint32_t word_count;
};

/* Where the path ended. */
enum explain_end {
    END_NOWHERE,  /* there is no triangle that should have been hit, or no tree */
    END_BOX,      /* the box test of step `last` rejected the ray */
    END_ORIENTED, /* the box of step `last` is hit, the test of its oriented box rejected the ray */
    END_SKIPPED,  /* step `last` waited on the stack and was skipped for a nearer best hit */
    END_REFERENCE, /* step `last` was never tested: its parent does not refer to it */
    END_SLOT,      /* the leaf was entered, its item is not there */
    END_TRIANGLE,  /* the triangle test rejected it */
    END_FARTHER,   /* it was hit, but not nearer than the best */
    END_HIT,       /* it was hit and kept */
};

/* Owns `step` (see explain_free). */
struct explanation {
    struct opinion opinion; /* of the engine's answer, if it finished */
    enum cause cause;
    uint32_t needed; /* mask of 1u << repair that help only together; 0: one alone does, or none.
                        `cause` is that of the first */
    bool inside;     /* C on the same bytes fails in the same way */
    enum replay_end replayed_end;
    struct hit replayed;
    struct opinion replayed_opinion;
    struct explain_attempt attempt[REPAIR_COUNT];
    size_t attempt_count;
    struct explain_imitation imitation[EXPLAIN_IMITATIONS];
    size_t imitation_count;
    size_t imitated;        /* index of the best, whether the cause or not; or imitation_count */
    uint32_t witness_count; /* other rays that the engine traced */
    uint32_t prim;          /* the triangle at the end of the path, or ABI_NO_PRIM */
    struct explain_step *step;
    uint32_t step_count, last;
    enum explain_end end;
    uint32_t slot;             /* of prim in its leaf */
    uint32_t slot_stored;      /* the triangle that is tested there, or ABI_NO_PRIM */
    struct replay_notes notes; /* prim_*: the result of the triangle test */
};

/* Explains `answer`. An allowed answer has cause CAUSE_NONE, unless the engine promises C's bits
 * and has others. Errors: STATUS_MEMORY; on error *out is zero. */
enum status explain_make(const struct explain_case *the, const struct explain_answer *answer,
                         struct explanation *out, struct reason *reason) MUST_USE;

void explain_free(struct explanation *explanation);

/* "box", "skipped", "reference", ..., as in the JSON. */
const char *explain_end_name(enum explain_end end);

#endif
