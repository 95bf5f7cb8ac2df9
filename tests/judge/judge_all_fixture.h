/* What test_judge_all.c and test_judge_all_classes.c share; includes cmocka.h. */
#ifndef JUDGE_ALL_FIXTURE_H
#define JUDGE_ALL_FIXTURE_H

#include "ref/judge/judge_all.h"
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include "tests/judge/judge_fixture.h"
#include <math.h>

#define MOST 8

/* A list in the making. */
struct judged_list {
    struct hit hit[MOST];
    size_t count;
    struct list_judgement judged;
};

/* The right answers of these triangles, in this order. */
static struct judged_list list_of(const struct judge_fixture *c, size_t count, const uint32_t *prim)
{
    struct judged_list list = {.count = count};
    assert_true(count <= MOST);
    for (size_t i = 0; i < count; i++)
        list.hit[i] = right_answer(c, prim[i]);
    return list;
}

#define LIST(c, ...)                                                                               \
    list_of((c), sizeof((uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t), (uint32_t[]){__VA_ARGS__})

static const struct judged_list empty;

static enum verdict judge(struct judge_fixture *c, struct judged_list *list)
{
    assert_int_equal(
        judge_list(c->judge, &c->ray, list->count ? list->hit : NULL, list->count, &list->judged),
        STATUS_OK);
    const struct judgement *j = &list->judged.judgement;
    assert_int_equal(j->verdict == VERDICT_WRONG, j->wrong != WRONG_NOT);
    return j->verdict;
}

static struct judged_list must(struct judge_fixture *c, struct judged_list list,
                               enum verdict expected)
{
    if (judge(c, &list) != expected)
        fail_msg("%s: %s (%s), not %s", c->subject->name,
                 verdict_name(list.judged.judgement.verdict),
                 wrong_name(list.judged.judgement.wrong), verdict_name(expected));
    if (expected != VERDICT_WRONG)
        assert_int_equal(list.judged.at_fault.prim, ABI_NO_PRIM);
    return list;
}

/* WRONG of this kind; `at_fault` is the hit that is, `expected` the triangle that is not there. */
static struct judged_list must_wrong(struct judge_fixture *c, struct judged_list list,
                                     enum wrong kind, uint32_t at_fault, uint32_t expected)
{
    list = must(c, list, VERDICT_WRONG);
    const struct judgement *j = &list.judged.judgement;
    if (j->wrong != kind || list.judged.at_fault.prim != at_fault || j->expected != expected)
        fail_msg("%s: %s of %u, %u, not %s of %u, %u", c->subject->name, wrong_name(j->wrong),
                 list.judged.at_fault.prim, j->expected, wrong_name(kind), at_fault, expected);
    return list;
}

#endif
