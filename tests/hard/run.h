/* Plays hard cases on members. A member is one combination of engine, layout, builder, box test,
 * triangle test and query; a result is about all parts of a case. */
#ifndef HARD_RUN_H
#define HARD_RUN_H

#include "ref/match/match.h"
#include "tests/hard/hard.h"

#define HARD_NAME_MOST 320

struct hard_member {
    enum query query;
    const struct engine *engine;
    const struct layout *layout; /* NULL for engines without a tree, as are the next two */
    const struct layout *top;    /* of a world's top tree; NULL: `layout` */
    const struct builder *builder;
    const struct box_test *box;
    const struct tri_test *tri;
};

/* How many of layout, builder, box test and triangle test are as published, faults included. */
unsigned hard_member_published(const struct hard_member *member);

/* "closest.cpu.rf16.median.robust.woop"; "-" where there is none, "f32/rf16" for another layout of
 * the top. */
void hard_member_print(const struct hard_member *member, char name[HARD_NAME_MOST]);

/* "hard.05-grid-vertices.closest.cpu.rf16.median.robust.woop" */
void hard_name_print(const struct hard_case *one, const struct hard_member *member,
                     char name[HARD_NAME_MOST]);

enum hard_outcome {
    HARD_PASSED,
    HARD_FAILED,
    HARD_REFUSED, /* every part is refused, with a reason, by a builder, layout or engine */
    HARD_SKIPPED, /* the engine cannot run here */
};

struct hard_result {
    enum hard_outcome outcome;
    bool unfinished;        /* FAILED: the engine returned an error */
    struct reason reason;   /* why refused or skipped, or the first thing that is broken */
    size_t played, refused; /* parts */
    size_t asked, declined; /* parts: given to the engine; refused by it, not by a layout */
    bool absent;            /* SKIPPED: the engine cannot run here at all */
    size_t rays, hits;
    size_t count[VERDICT_COUNT];
    size_t wrong[WRONG_COUNT];
    size_t broken[PROPERTY_COUNT]; /* rays, or parts for what is no ray's */
    double worst_over;             /* largest err/E of t */
    /* The first ray of which something is broken; part_label "": none. */
    char part_label[HARD_LABEL_MOST];
    size_t part, ray_index;
    enum hard_property property;
    struct ray ray;
    struct hit got;
    struct judgement judgement;
};

struct hard_cache; /* of one part */

/* Keeps the parts of one case with their truth, trees and answers, so that each further member of
 * the case costs little. */
struct hard_stage {
    struct engine_options options; /* of the user; a case can name another driver */
    struct pool pool; /* on one thread: with a few hundred rays a second one costs more than it
                         does, and the float mode is a thread's own */
    struct pool many; /* the same engines on the user's number of threads, for HARD_FLOAT_MODE */
    const struct hard_case *one;
    struct hard_made *made;
    struct hard_cache *cache; /* one per part */
};

/* An empty stage with these engine options. */
struct hard_stage hard_stage_make(const struct engine_options *options);

/* Plays a case on a member. Errors: those of hard_make and the oracle. Failures of the member are
 * in *out, not errors. */
enum status hard_run(struct hard_stage *stage, const struct hard_case *one,
                     const struct hard_member *member, struct hard_result *out,
                     struct reason *reason) MUST_USE;

void hard_stage_free(struct hard_stage *stage);

/* One line: counts, what is broken how often, the first ray of it. */
void hard_result_print(const struct hard_result *result, char *text, size_t text_bytes);

#endif
