/* The judge: is an engine's answer right? Each answer is judged alone, against the exact truth
 * (ref/oracle) and the proven error of that engine's own formula (ref/twin); no other engine takes
 * part. It depends on scenes, rays and triangle tests, never on a tree, a layout or an engine's
 * internals. Every allowed class has a name, a counter that is always printed and a paragraph in
 * docs/verdicts.md; no share of wrong answers is accepted. */
#ifndef JUDGE_H
#define JUDGE_H

#include "ref/oracle/oracle.h"
#include "ref/twin/twin.h"

enum verdict {
    VERDICT_RIGHT,           /* the exact nearest triangle (any: a triangle exactly hit), t within
                                the bound; or an exact miss */
    VERDICT_TIE,             /* A1 one of several triangles at exactly the same nearest t */
    VERDICT_NEAR_TIE,        /* A2 an exact hit behind the nearest, by no more than both bounds */
    VERDICT_BOUNDARY,        /* A3 an edge function's or determinant's sign is within its error */
    VERDICT_BORDER,          /* A4 the exact t is within its error of tmin or tmax */
    VERDICT_IN_PLANE,        /* A5 the ray lies in the triangle's plane (or it has no area) */
    VERDICT_SLAB,            /* A6 Embree's default box test cannot see the hit */
    VERDICT_NOISE,           /* A7 the determinant's sign is open and t lies off the triangle */
    VERDICT_OUT_OF_CONTRACT, /* A8 the ray or the scene is outside what the tests promise */
    VERDICT_WRONG,           /* everything else: a bug, see enum wrong */
    VERDICT_COUNT
};

enum wrong {
    WRONG_NOT,
    WRONG_MISSED,      /* a hit that this formula cannot help finding was lost */
    WRONG_PHANTOM,     /* a triangle that it cannot find, where nothing is hit; no such triangle */
    WRONG_TRIANGLE,    /* a triangle that it cannot find, where another one is hit */
    WRONG_DISTANCE,    /* t is farther from the exact t than the bound, or out of the range */
    WRONG_BARYCENTRIC, /* u or v is farther from the exact value than the bound */
    WRONG_NOT_FINITE,  /* t, u or v is NaN or infinite */
    WRONG_NOT_REPEATABLE, /* the same job gave other bits the second time; given by the caller */
    WRONG_ANY_DISAGREES, /* any-hit and closest-hit of one engine contradict each other; likewise */
    WRONG_TWICE,         /* all hits: one triangle is listed twice, see ref/judge/judge_all.h */
    WRONG_ORDER,         /* all hits: a later t before an earlier one */
    WRONG_MASKED,        /* worlds: of an instance that the ray does not meet */
    WRONG_CULLED,        /* worlds: of a side that the ray's flags cull */
    WRONG_OPACITY,       /* worlds: culled as opaque or not, or passed over by the filter */
    WRONG_INSTANCE,      /* worlds: another instance is hit, or its custom index is another */
    WRONG_FACING,        /* worlds: the other side is seen */
    WRONG_COUNT
};

struct judgement {
    enum verdict verdict;
    enum wrong wrong;  /* WRONG_NOT unless verdict is VERDICT_WRONG */
    uint32_t expected; /* the exactly nearest triangle, or ABI_NO_PRIM */
    double t_lo, t_hi; /* enclose the exact t of `expected` */
    bool behind;   /* WRONG_MISSED, and what proves it is not `expected` but `lost`, behind it */
    uint32_t lost; /* then: a hit that cannot have been missed, where the loss of `expected`
                      may be excused; unknown formula: the one that needs the displacement */
    double lost_lo, lost_hi; /* enclose its exact t */
    double over;             /* err/E: error of t over its bound; 0 where t is not bounded */
    double displacement; /* unknown formula: smallest displacement of vertices that makes the answer
                            right, in units of u * max |vertex - origin|, u = 2^-24; else 0 */
    double share;        /* unknown formula: displacement over what is allowed there; else 0 */
    double margin;       /* unknown formula: of an exact nearest hit (of a list, of one hit) that
                            rounding may lose, its distance to the nearest edge in parts of the
                            classical test's bound, where more than JUDGE_DISPLACEMENT_MOST is
                            allowed in as many parts of that; else 0 */
    bool edge_lost;      /* likewise: it was lost for that */
    bool ill_conditioned; /* worlds, VERDICT_OUT_OF_CONTRACT of an unknown formula: kappa of the
                             instance is over 2^10 */
    bool fan; /* unknown formula: a hit inside a closed fan was lost, see judge_answer */
};

/* The displacement of any triangle that an answer of an unknown formula may need, in units, unless
 * its model has another: above the 21.3 of Woop 2013 with Vulkan's loosest rounding. Where the
 * worst published test in float32 needs more, of slivers and near edge-on, that much is allowed
 * (ref/judge/judge_allowed.c). What lies beyond both is not rounding. */
#define JUDGE_DISPLACEMENT_MOST 32.0

/* Makes a judgement WRONG. Returns VERDICT_WRONG. */
static inline enum verdict judge_set_wrong(struct judgement *out, enum wrong kind)
{
    out->wrong = kind;
    return out->verdict = VERDICT_WRONG;
}

/* "right", "tie", ... as in the JSON and the tables. */
const char *verdict_name(enum verdict verdict);

/* "not", "missed", "phantom", ..., likewise. */
const char *wrong_name(enum wrong wrong);

struct judge;

/* Makes the judge of answers to `query` of an engine with this model, on the oracle's scene, or
 * world (ref/judge/judge_world.h). The oracle and what it was made of are borrowed. Errors:
 * STATUS_LIMIT the inverse of an instance's transform is beyond float32; STATUS_MEMORY. */
enum status judge_make(const struct oracle *oracle, const struct model *model, enum query query,
                       struct judge **out, struct reason *reason) MUST_USE;

/* With `on` the judge accepts every answer that is within the bounds of a triangle which some
 * evaluation accepts, even where the bounds are so wide that it would else replay the formula. What
 * it accepts of a triangle are then intervals of t, u and v, which can be exported. */
void judge_by_bounds(struct judge *judge, bool on);

/* Judges one answer; safe from several threads at once.
 *   truth   oracle_closest of the same ray with ORACLE_CLOSED, also for QUERY_ANY and open ranges
 * A watertight model has no boundary band inside a closed fan: a hit is lost there only if all
 * triangles of the fan were (ref/judge/judge_fan.c). For an unknown formula out->fan is set, and
 * the answer is WRONG only if the model promises to be watertight.
 * Errors: STATUS_MEMORY (*out is then VERDICT_OUT_OF_CONTRACT: not judged). */
enum status judge_answer(const struct judge *judge, const struct ray *ray,
                         const struct oracle_answer *truth, const struct hit *answer,
                         struct judgement *out);

/* An engine's answer to a ray, and the truth. */
struct judge_question {
    const struct ray *ray;
    const struct oracle_answer *truth;
    const struct hit *answer;
};

/* Judges many answers to the same judgements as judge_answer, several times as fast: twins are
 * computed together. Errors: STATUS_MEMORY (of one). */
enum status judge_answers(const struct judge *judge, const struct judge_question *question,
                          size_t count, struct judgement *out);

/* The smallest displacement of vertices, in units of the scene, that makes an answer right,
 * whatever the formula and however large; u and v are not judged. Where the vertices of another
 * scene lie no farther away than D, an answer to the same ray needs at most D more or less of them.
 * The ray and the answer are finite, the triangle is one of the scene's. Errors: STATUS_MEMORY. */
enum status judge_need(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, const struct hit *answer, double *need);

/* Turns a judgement into WRONG_ANY_DISAGREES if the same engine's closest-hit answer contradicts
 * its any-hit answer, one being a hit and the other a miss. An own formula gives both queries the
 * same triangle tests in the same order until the first hit, so nothing excuses it. Other formulas
 * may run different code for each, whose roundings differ: then the one that contradicts the exact
 * truth must be of a class that leaves open whether something is hit: a boundary, not a tie. */
void judge_any_against_closest(const struct judge *judge, const struct ray *ray,
                               const struct hit *closest, const struct judgement *closest_judgement,
                               const struct hit *any, struct judgement *any_judgement);

void judge_free(struct judge *judge); /* NULL is fine */

/* Two engines that must agree bit for bit: VERDICT_RIGHT, VERDICT_OUT_OF_CONTRACT (differing bits
 * of a ray out of contract) or VERDICT_WRONG. Any-hit too: both visit in the same order. */
enum verdict judge_bits(const struct ray *ray, const struct hit *a, const struct hit *b);

/* True if an unknown formula may take this triangle for hit, in the ray's range. */
bool judge_may_be_hit(const struct judge *judge, const struct ray *ray, uint32_t prim);

/* Names the hit whose loss is WRONG_MISSED, found by the oracle. */
void judge_set_lost(struct judgement *out, uint32_t prim, double t_lo, double t_hi);

/* Writes one line: the ray and the answer in hexadecimal floats, the expected hit (and the lost one
 * if that is another), and err/E or the displacement if there is one. */
void judge_line(const struct ray *ray, const struct judgement *judgement, const struct hit *answer,
                char *text, size_t text_bytes);

/* The same for two answers that should have the same bits. */
void judge_bits_line(const struct ray *ray, const struct hit *expected, const struct hit *answer,
                     char *text, size_t text_bytes);

#endif
