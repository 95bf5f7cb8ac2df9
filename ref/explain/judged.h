/* An engine's answer to one ray: traced, judged against the exact truth, explained. */
#ifndef EXPLAIN_JUDGED_H
#define EXPLAIN_JUDGED_H

#include "ref/engine.h"
#include "ref/explain/explain.h"
#include "ref/judge/judge.h"

/* An engine prepared for a job, and the data that its answers are judged by; all borrowed. */
struct judged_job {
    const struct engine *engine;
    void *self; /* opened, and prepared with `job` */
    const struct job *job;
    const struct bvh *bvh; /* the tree that job->packed was made from; NULL without packed */
    const struct oracle *oracle;
};

/* Owns what it made (judged_free). */
struct judged {
    struct judged_job from;
    struct model model; /* the engine's; for a triangle test as published that of the repaired one,
                           so that its faults are not excused */
    struct explain_tree tree; /* if from.job->packed has nodes */
    bool has_tree;
    struct judge *judge;
    bool known; /* formula and tree are those that C replays; else both are unknown */
};

/* One ray. Owns `why` (explain_free). */
struct judged_ray {
    struct ray ray;
    struct explain_answer answer;
    struct reason reason; /* if the engine did not finish */
    struct oracle_answer truth;
    struct judgement judgement; /* of the answer; of a miss if the engine did not finish */
    struct explanation why;
    size_t among;     /* the answer is that to the ray among so many, and wrong; asked
                                   alone it has another one: */
    struct hit alone; /* 0 rays: not so */
    struct judgement alone_judgement;
};

/* Errors: STATUS_MEMORY. On error *out is zero. */
enum status judged_make(const struct judged_job *from, struct judged *out,
                        struct reason *reason) MUST_USE;
void judged_free(struct judged *judged);

/* Traces, judges and explains. Errors: STATUS_MEMORY; those of the oracle. */
enum status judged_explain(struct judged *judged, const struct ray *ray, struct judged_ray *out,
                           struct reason *reason) MUST_USE;

/* The same of ray[index] of `count`. If its answer is wrong when it is traced with others, as many
 * of them as judged_find traces at a time, and another one when it is traced alone, the former is
 * explained, with CAUSE_NOT_REPEATABLE. */
enum status judged_explain_among(struct judged *judged, const struct ray *ray, size_t count,
                                 size_t index, struct judged_ray *out,
                                 struct reason *reason) MUST_USE;

/* Whether the engine, opened anew and prepared with the job alone, answers a ray rightly, and with
 * C's bits where it promises them. If one that was taken through steps does not, what is wrong is
 * what it kept of them: CAUSE_STALE. It is not, if no engine can be opened or prepared. Errors:
 * STATUS_MEMORY; those of the oracle. */
enum status judged_fresh(const struct judged *judged, const struct engine_options *options,
                         const struct ray *ray, bool *right, struct reason *reason) MUST_USE;

/* Gives a wrong answer of an engine that was taken through steps CAUSE_STALE, if that is so; one
 * that is not repeatable stays so. Errors: as judged_fresh. */
enum status judged_stale(const struct judged *judged, const struct engine_options *options,
                         struct judged_ray *ray, struct reason *reason) MUST_USE;

/* Finds the first ray from `first` on that the engine does not finish, answers wrongly, or with
 * other bits than C where it promises C's: *index is that ray, or `count`. Errors: as
 * judged_explain. */
enum status judged_find(struct judged *judged, const struct ray *ray, size_t first, size_t count,
                        size_t *index, struct reason *reason) MUST_USE;

#endif
