/* The judge: is an answer allowed, given the reference's? Knows scenes, rays and triangle tests;
 * never a tree, a layout or an engine's internals. Every allowed class has a name, a counter that
 * is always printed and a paragraph in the README; there is no percentage that passes. */
#ifndef JUDGE_H
#define JUDGE_H

#include "ref/scene.h"
#include "ref/twin.h"

enum verdict {
    VERDICT_SAME,            /* the same bits; Embree: the same triangle, t within both bounds */
    VERDICT_TIE,             /* A1 another triangle at exactly the same t */
    VERDICT_NEAR_TIE,        /* A2 another triangle, t apart by at most both error bounds */
    VERDICT_BOUNDARY,        /* A3 an edge function, determinant or range end within its error */
    VERDICT_SLAB,            /* A4 Embree's default box test cannot see the hit */
    VERDICT_NOISE,           /* A5 Embree's t of a triangle seen edge-on lies off the triangle */
    VERDICT_OUT_OF_CONTRACT, /* A6 the ray is outside what the tests promise */
    VERDICT_DIFFERENT,       /* everything else: a bug in someone */
    VERDICT_COUNT
};

/* "same", "tie", ... as in the JSON and the tables. */
const char *verdict_name(enum verdict verdict);

/* Whose answer is judged. */
enum subject {
    SUBJECT_TREE,          /* the reference's own triangle test, over some tree */
    SUBJECT_EMBREE,        /* Embree, default */
    SUBJECT_EMBREE_ROBUST, /* Embree, robust */
};

/* What does not change from ray to ray. */
struct judge {
    const struct scene *scene;  /* borrowed */
    const struct tri_test *tri; /* of the reference, and of SUBJECT_TREE */
    enum query query;
    enum subject subject;
    bool reference_complete; /* the reference tested every triangle (brute) */
    float largest[3];        /* largest |coordinate| per axis of the scene */
};

struct judge judge_make(const struct scene *scene, const struct tri_test *tri, enum query query,
                        enum subject subject, bool reference_complete);

/* Judges one answer.
 *   reference   closest hit of the same ray with judge->tri, also for QUERY_ANY
 *   answer      of the subject; any-hit is compared as hit or miss, and an own engine's any-hit
 *               must be what its triangle test says of the triangle it names
 * A reference that is not complete can be the one that lost a hit: that is VERDICT_DIFFERENT too.
 * Never VERDICT_SAME for bits that differ under SUBJECT_TREE. */
enum verdict judge_answer(const struct judge *judge, const struct ray *ray,
                          const struct hit *reference, const struct hit *answer);

/* Two engines that must agree bit for bit: VERDICT_SAME, VERDICT_OUT_OF_CONTRACT (differing bits of
 * a ray out of contract) or VERDICT_DIFFERENT. Any-hit too: both visit in the same order. */
enum verdict judge_bits(const struct ray *ray, const struct hit *a, const struct hit *b);

/* Writes one line: the ray, the reference's and the subject's answer in hexadecimal floats. */
void judge_line(const struct ray *ray, const struct hit *reference, const struct hit *answer,
                char *text, size_t text_bytes);

#endif
