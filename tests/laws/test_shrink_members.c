/* Every simpler value of a member is tried: if a trial may have that one value beside its own and
 * no other, it is shrunk to that. */
#include "fuzz/shrink/shrink.h"
#include "ref/store.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* Of a member: its number, and a way to give it another. */
#define MEMBER(name, of)                                                                           \
    static double get_##name(const struct fuzz_trial *t)                                           \
    {                                                                                              \
        return (double)t->of;                                                                      \
    }                                                                                              \
    static void set_##name(struct fuzz_trial *t, double x)                                         \
    {                                                                                              \
        t->of = (__typeof__(t->of))x;                                                              \
    }
/* The same of a member of a table: its place there. */
#define PLACED(name, of, table)                                                                    \
    static double get_##name(const struct fuzz_trial *t)                                           \
    {                                                                                              \
        double place = 0;                                                                          \
        for (size_t i = 0; table[i] != t->of; i++)                                                 \
            place++;                                                                               \
        return place;                                                                              \
    }                                                                                              \
    static void set_##name(struct fuzz_trial *t, double x)                                         \
    {                                                                                              \
        t->of = table[(size_t)x];                                                                  \
    }

MEMBER(query, query)
MEMBER(eps, build.eps)
MEMBER(leaf, build.leaf)
MEMBER(passes, build.passes)
MEMBER(rotates, build.rotates)
MEMBER(presplit, build.presplit)
MEMBER(move, move)
MEMBER(seed, move_seed)
PLACED(store, store, tri_stores)
PLACED(builder, builder, builders)
PLACED(box, box, box_tests)
PLACED(tri, tri, tri_tests)

#define BOTH(name) #name, get_##name, set_##name

/* From which value to which one, and what else the trial must have for either. */
static const struct member {
    const char *name;
    double (*get)(const struct fuzz_trial *);
    void (*set)(struct fuzz_trial *, double);
    double from, to;
    uint32_t passes;
    float move;
} members[] = {
    {BOTH(query), QUERY_ANY, QUERY_CLOSEST, 0, 0},
    {BOTH(eps), 0.3f, BUILD_EPS_DEFAULT, 0, 0},
    {BOTH(eps), 0.3f, 0, 0, 0},
    {BOTH(eps), 0x1.23456p-3f, 0, 0, 0},
    {BOTH(leaf), 8, BUILD_LEAF_DEFAULT, 0, 0},
    {BOTH(leaf), 2, BUILD_LEAF_DEFAULT, 0, 0},
    {BOTH(leaf), 14, 7, 0, 0},
    {BOTH(leaf), 15, 7, 0, 0},
    {BOTH(leaf), 8, 7, 0, 0},
    {BOTH(leaf), 3, 2, 0, 0},
    {BOTH(leaf), 9, 1, 0, 0},
    {BOTH(passes), 3, 0, 0, 0},
    {BOTH(passes), 3, 1, 0, 0},
    {BOTH(rotates), 1, 0, 2, 0},
    {BOTH(presplit), 0.3f, 0, 0, 0},
    {BOTH(presplit), 0.3f, 1, 0, 0},
    {BOTH(move), 0.3f, 0, 0, 0},
    {BOTH(move), 0.3f, 1, 0, 0},
    {BOTH(seed), 7, 0, 0, 1},
};

struct two_values {
    const struct member *member;
    double to, from;
};

static bool is_allowed(const struct two_values *asking, const struct fuzz_trial *trial)
{
    const struct member *m = asking->member;
    double x = m->get(trial);
    return (x == asking->from || x == asking->to) && (!m->passes || trial->build.passes > 0) &&
           (!(m->move > 0) || trial->move > 0);
}

static enum status ask(void *user, const struct fuzz_trial *candidate, size_t count, size_t *first,
                       struct reason *why)
{
    (void)why;
    for (*first = 0; *first < count && !is_allowed(user, &candidate[*first]); ++*first) {
    }
    return STATUS_OK;
}

static void assert_reached(const struct member *member, double from, double to)
{
    struct two_values asking = {member, to, from};
    struct fuzz_trial trial, out;
    struct shrink_stats stats;
    const struct shrink_options options = {0};
    assert_int_equal(fuzz_trial_make(3, 2, 1, &trial, &reason), STATUS_OK);
    for (uint32_t i = 0; i < 6; i++)
        trial.scene.index[i] = i % 3;
    trial.scene.vertex[0] = trial.scene.vertex[4] = 1;
    trial.ray[0].dir[2] = 1;
    trial.builder = builder_find("sah_binned");
    trial.build.passes = member->passes;
    trial.move = member->move;
    member->set(&trial, from);
    for (size_t i = 0; fuzz_trial_check(&trial, &reason) && member->get == get_store; i++) {
        assert_non_null(tri_tests[i]); /* some test takes what is stored */
        trial.tri = tri_tests[i];
    }
    if (fuzz_trial_check(&trial, &reason))
        fail_msg("%s %g: %s", member->name, from, reason.text);
    if (fuzz_shrink_trial(&trial, ask, &asking, &options, &out, &stats, &reason))
        fail_msg("%s", reason.text);
    if (member->get(&out) != to)
        fail_msg("%s: from %g to %g, not %g", member->name, from, member->get(&out), to);
    fuzz_trial_free(&out);
    fuzz_trial_free(&trial);
}

static void each_simpler_number_is_tried(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(members); i++)
        assert_reached(&members[i], members[i].from, members[i].to);
}

/* Any member of a table to any that stands before it; of a storage to the first. */
static void each_member_before_it_is_tried(void **state)
{
    (void)state;
    static const struct member tables[] = {
        {BOTH(builder), 0, 0, 0, 0}, {BOTH(box), 0, 0, 0, 0}, {BOTH(tri), 0, 0, 0, 0}};
    static const struct member stores = {BOTH(store), 0, 0, 0, 0};
    size_t count[3] = {0};
    while (builders[count[0]])
        count[0]++;
    while (box_tests[count[1]])
        count[1]++;
    while (tri_tests[count[2]])
        count[2]++;
    for (size_t t = 0; t < ARRAY_COUNT(tables); t++)
        for (size_t from = 1; from < count[t]; from++)
            for (size_t to = 0; to < from; to++)
                assert_reached(&tables[t], (double)from, (double)to);
    for (size_t from = 1; tri_stores[from]; from++)
        assert_reached(&stores, (double)from, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_simpler_number_is_tried),
        cmocka_unit_test(each_member_before_it_is_tried),
    };
    return cmocka_run_group_tests_name("shrink_members", tests, NULL, NULL);
}
