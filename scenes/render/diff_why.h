/* Why two paths of one pixel part: they are followed, step by step, to the first hit or shadow that
 * differs, and each engine's own answer to its own ray is judged against the exact truth. */
#ifndef DIFF_WHY_H
#define DIFF_WHY_H

#include "ref/judge/judge.h"
#include "scenes/render/diff_walk.h"

enum why {
    WHY_SAME,      /* every ray and every hit has the same bits */
    WHY_ROUNDING,  /* the same triangles and shadows all along; t, u or v differ within their bounds
                    */
    WHY_ALLOWED,   /* an allowed class of the judge's: path_why.verdict */
    WHY_DRIFT,     /* the rays differ already, by what was allowed before; both are right about
                      their own */
    WHY_PUBLISHED, /* the judge calls the answer of an engine on parts as published wrong: their
                      faults are known */
    WHY_RENDERER,  /* the engine's picture is not what the answers to its own rays give */
    WHY_WRONG,     /* by the judge's verdict */
    WHY_UNEXPLAINED,
    WHY_COUNT
};

/* "same", "rounding", "allowed", "drift", "published", "renderer", "wrong", "unexplained". */
const char *why_name(enum why why);

/* True if neither is right: renderer, wrong, unexplained. */
static inline bool why_is_fault(enum why why)
{
    return why >= WHY_RENDERER;
}

#define WHY_NO_LIGHT UINT32_MAX

/* An answer and its judgement. */
struct why_answer {
    bool judged; /* else the next are zero: nothing that differs */
    struct ray ray;
    struct hit hit;
    struct oracle_answer truth;
    struct judgement judgement;
};

struct path_why {
    enum why why;
    enum verdict verdict;        /* of WHY_ALLOWED */
    uint32_t segment;            /* where the paths part; of WHY_SAME and _ROUNDING: their length */
    uint32_t light;              /* the light of the shadow ray; WHY_NO_LIGHT: the segment's own
                                    ray */
    unsigned side;               /* the side that is wrong, or has the verdict: 0 or 1 */
    struct why_answer answer[2]; /* there */
    double over;                 /* largest err/E of t on the way, of both */
};

/* Judges of two engines' answers; all borrowed but the judges themselves. */
struct why_judges {
    const struct oracle *oracle;
    struct judge *closest[2], *shadow[2];
    bool published[2]; /* false unless the caller sets it: wrong answers are expected */
};

/* `model` has the two engines' models. Errors: STATUS_MEMORY. On error *out is zero. */
enum status why_judges_make(const struct oracle *oracle, const struct model model[2],
                            enum query shadow_query, struct why_judges *out,
                            struct reason *reason) MUST_USE;
void why_judges_free(struct why_judges *judges);

/* Judges one answer of side 0 or 1. Errors: STATUS_MEMORY. */
enum status why_judge(const struct why_judges *judges, unsigned side, bool shadow,
                      const struct ray *ray, const struct hit *hit, struct why_answer *out,
                      struct reason *reason) MUST_USE;

/* Why path `index` of walk a and that of walk b part, or what differs on them. Safe from several
 * threads. Errors: STATUS_MEMORY. */
enum status why_paths(const struct why_judges *judges, const struct diff_walk *a,
                      const struct diff_walk *b, size_t index, struct path_why *out,
                      struct reason *reason) MUST_USE;

/* Whether an engine's picture is what the walk of its own rays gives: the same segments to the bit,
 * and the value within the bound of the walk's colour (the same value if `by_waves`: the same code
 * drew it). */
bool why_walk_is_frame(const struct diff_walk *walk, size_t index, const struct segment *segment,
                       uint32_t pixel, bool by_waves);

#endif
