/* WRONG answers by signature: how many, which was first, which scene is the smallest. */
#ifndef TRUTH_TALLY_H
#define TRUTH_TALLY_H

#include "ref/abi_world.h"
#include "ref/engine.h"
#include "ref/explain/repair.h"
#include "ref/judge/judge.h"
#include "tests/exact/exact_gmp_redecide.h"

#include <stdio.h>

/* Who answers. */
struct tally_contestant {
    const struct engine *engine;
    const struct layout *layout; /* NULL: the engine has no tree of ours */
    const struct box_test *box;
    const struct tri_test *tri;
};

/* One answer that the judge calls wrong. */
struct wrong_answer {
    struct tally_contestant who;
    enum cause cause;
    char scene[80];
    const char *rays;
    size_t index; /* of the ray in its set */
    uint64_t seed;
    struct ray ray;
    struct hit hit;
    struct ray_mode mode; /* in a world; else zero */
    uint32_t tag;         /* likewise */
    struct judgement judgement;
    enum gmp_opinion opinion;
};

/* A scene cut down so far that the answer is still wrong in the same way. */
struct smallest {
    struct wrong_answer answer;
    struct scene scene; /* owned; tri_count 0: none yet */
};

#define SIGNATURES_MOST   256
#define GMP_OPINION_COUNT (GMP_OVERTURNED + 1)

struct signature {
    struct wrong_answer first;
    struct smallest smallest;
    size_t count, opinion[GMP_OPINION_COUNT];
};

#define DOUBTFUL_MOST 16

struct tally {
    struct signature signature[SIGNATURES_MOST];
    size_t count;
    struct wrong_answer doubtful[DOUBTFUL_MOST]; /* the first that rationals did not confirm */
    size_t doubtful_count;
    size_t beyond; /* wrong answers that found no room: must be 0 */
};

/* Counts `wrong` under its engine, layout, box test, triangle test, kind and cause. Returns its
 * signature, NULL if there is no room. */
struct signature *tally_add(struct tally *tally, const struct wrong_answer *wrong);

/* "cpu.f32.robust.mt.missed.rounded_inward": unique, and fit for a file's name. */
void signature_name(const struct signature *signature, char *text, size_t text_bytes);

/* Prints one answer: scene, rays, who, and the judge's line. */
void wrong_answer_print(const struct wrong_answer *wrong, FILE *stream);

/* Writes DIR/NAME.txt and DIR/NAME.ply of every signature: counts, the first, and the smallest with
 * the command that explains it. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status tally_write(const struct tally *tally, const char *dir, struct reason *reason) MUST_USE;

void tally_free(struct tally *tally);

#endif
