/* What the tests of explain share: a packed tree, rays, and an opinion of answers that is nothing
 * but brute force with a triangle test that has no faults. Include after cmocka.h. */
#ifndef TESTS_EXPLAINED_H
#define TESTS_EXPLAINED_H

#include "ref/explain/explain.h"
#include "ref/trace/trace.h"

#include <string.h>

/* Everything that is explained lies on a packed tree. */
struct suspect {
    const struct scene *scene;
    struct explain_tree tree;
    const char *box, *tri;
};

static inline struct suspect suspect_make(const struct scene *scene, const struct bvh *bvh,
                                          const struct packed *packed, const char *box,
                                          const char *tri)
{
    struct suspect s = {.scene = scene, .box = box, .tri = tri};
    assert_int_equal(explain_tree_make(scene, bvh, packed, &s.tree, NULL), STATUS_OK);
    return s;
}

static inline void suspect_free(struct suspect *s)
{
    explain_tree_free(&s->tree);
}

/* user: the suspect. What is as near as what its triangle test (mt for mt_rtrs) hits of all
 * triangles is allowed. */
static inline void brute_opinion(const void *user, const struct ray *ray, const struct hit *answer,
                                 struct opinion *out)
{
    const struct suspect *s = user;
    struct hit best;
    const char *tri = strcmp(s->tri, "mt_rtrs") == 0 ? "mt" : s->tri;
    trace_brute(s->scene, tri_test_find(tri), QUERY_CLOSEST, ray, &best);
    bool same = (answer->prim == ABI_NO_PRIM) == (best.prim == ABI_NO_PRIM);
    *out = (struct opinion){same && answer->t == best.t, "brute", best.prim};
}

static inline struct explain_case case_of(const struct suspect *s, const struct ray *ray)
{
    return (struct explain_case){
        .replay = {.scene = s->scene,
                   .tree = &s->tree,
                   .box_id = box_test_find(s->box)->id,
                   .tri_id = tri_test_find(s->tri)->id,
                   .query = QUERY_CLOSEST},
        .ray = *ray,
        .judge = brute_opinion,
        .judge_user = s,
        .bits = true,
        .exact = true,
        .known = true,
    };
}

/* What the reference traversal answers. */
static inline struct explain_answer answer_of(const struct suspect *s, const struct ray *ray)
{
    struct explain_answer answer = {.finished = true};
    answer.finished = trace_ray(&(struct job){.scene = s->scene,
                                              .packed = s->tree.packed,
                                              .box = box_test_find(s->box),
                                              .tri = tri_test_find(s->tri),
                                              .query = QUERY_CLOSEST},
                                ray, &answer.hit, NULL) == STATUS_OK;
    return answer;
}

/* Explains what the reference traversal answers; free the explanation. */
static inline struct explanation explained(const struct suspect *s, const struct ray *ray)
{
    struct explain_case the = case_of(s, ray);
    struct explain_answer answer = answer_of(s, ray);
    struct explanation out;
    assert_int_equal(explain_make(&the, &answer, &out, NULL), STATUS_OK);
    return out;
}

static inline enum cause cause_of(const struct suspect *s, const struct ray *ray)
{
    struct explanation out = explained(s, ray);
    enum cause cause = out.cause;
    explain_free(&out);
    return cause;
}

/* Explains every ray; how many have each cause. */
static inline void count_causes(const struct suspect *s, const struct ray *ray, size_t count,
                                size_t causes[CAUSE_COUNT])
{
    memset(causes, 0, CAUSE_COUNT * sizeof *causes);
    for (size_t i = 0; i < count; i++)
        causes[cause_of(s, &ray[i])]++;
}

/* Fails unless all that is wrong has this cause, `least` rays or more. */
static inline void assert_cause(const struct suspect *s, const struct ray *ray, size_t count,
                                enum cause cause, size_t least)
{
    size_t causes[CAUSE_COUNT];
    count_causes(s, ray, count, causes);
    for (enum cause c = CAUSE_NONE + 1; c < CAUSE_COUNT; c++)
        if (c != cause && causes[c] > 0)
            fail_msg("%zu of %zu rays: %s, not %s", causes[c], count, cause_name(c),
                     cause_name(cause));
    if (cause != CAUSE_NONE && causes[cause] < least)
        fail_msg("%zu of %zu rays: %s, not %zu", causes[cause], count, cause_name(cause), least);
}

#endif
