/* Why two paths of one pixel part. They are followed step by step to the first hit or shadow that
 * differs. There each engine's answer to its own ray is judged against the exact truth. */
#ifndef DIFF_WHY_H
#define DIFF_WHY_H

#include "ref/judge/judge.h"
#include "scenes/render/diff_walk.h"

enum why {
    WHY_SAME,      /* all rays and hits are bit-identical */
    WHY_ROUNDING,  /* same triangles and shadows; t, u or v differ within bounds */
    WHY_ALLOWED,   /* an allowed verdict of the judge: path_why.verdict */
    WHY_DRIFT,     /* rays differ by earlier allowed differences; both answers are right */
    WHY_PUBLISHED, /* wrong answer of an engine on published parts: known faults */
    WHY_RENDERER,  /* the picture does not follow from the answers to its own rays */
    WHY_WRONG,     /* wrong by the judge's verdict */
    WHY_UNEXPLAINED,
    WHY_COUNT
};

/* "same", "rounding", "allowed", "drift", "published", "renderer", "wrong", "unexplained". */
const char *why_name(enum why why);

/* True for the faults: renderer, wrong, unexplained. */
static inline bool why_is_fault(enum why why)
{
    return why >= WHY_RENDERER;
}

#define WHY_NO_LIGHT UINT32_MAX

/* An answer and its judgement. */
struct why_answer {
    bool judged; /* false: nothing differs, and the other members are unused */
    struct ray ray;
    struct hit hit;
    struct oracle_answer truth;
    struct judgement judgement;
};

struct path_why {
    enum why why;
    enum verdict verdict;        /* if WHY_ALLOWED */
    uint32_t segment;            /* where the paths part; WHY_SAME, WHY_ROUNDING: their length */
    uint32_t light;              /* of the shadow ray; WHY_NO_LIGHT: the segment's own ray */
    unsigned side;               /* the side that is wrong or has the verdict: 0 or 1 */
    struct why_answer answer[2]; /* answers of both sides there */
    double over;                 /* largest err/E of t so far, of both */
};

/* Judges of two engines' answers. Only the judges themselves are owned (why_judges_free). */
struct why_judges {
    const struct oracle *oracle;
    struct judge *closest[2], *shadow[2];
    bool published[2]; /* set by the caller: wrong answers are expected */
};

/* Makes the judges. `model` has the two engines' models. Errors: STATUS_MEMORY. On error *out is
 * zero. */
enum status why_judges_make(const struct oracle *oracle, const struct model model[2],
                            enum query shadow_query, struct why_judges *out,
                            struct reason *reason) MUST_USE;
void why_judges_free(struct why_judges *judges);

/* Judges one answer of side 0 or 1; `shadow`: to a shadow ray. Errors: STATUS_MEMORY. */
enum status why_judge(const struct why_judges *judges, unsigned side, bool shadow,
                      const struct ray *ray, const struct hit *hit, struct why_answer *out,
                      struct reason *reason) MUST_USE;

/* Finds why path `index` of walks a and b parts, or what differs on it. May be called from several
 * threads. Errors: STATUS_MEMORY. */
enum status why_paths(const struct why_judges *judges, const struct diff_walk *a,
                      const struct diff_walk *b, size_t index, struct path_why *out,
                      struct reason *reason) MUST_USE;

/* Whether an engine's picture follows from the walk of its own rays: the segments are
 * bit-identical, and the value is within the bound of the walk's colour. If `by_waves` the values
 * must be equal, since the same code drew both. */
bool why_walk_is_frame(const struct diff_walk *walk, size_t index, const struct segment *segment,
                       uint32_t pixel, bool by_waves);

#endif
