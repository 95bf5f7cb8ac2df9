/* Tables of all members for tests of pairs. Include after cmocka.h. */
#ifndef FUZZ_PAIR_FIXTURE_H
#define FUZZ_PAIR_FIXTURE_H

#include "fuzz/feedback/pair_coverage_inner.h"

#include <string.h>

static struct reason reason;

static inline void add(struct pair_tables *t, enum pair_factor factor, const void *member)
{
    t->member[factor][t->count[factor]++] = member;
}

static const char *const engine_names[] = {"cpu", "fast", "cpu_stackless", "brute",
                                           "embree_robust"};

/* Every member that is not as published. */
static inline struct pair_tables all_tables(void)
{
    struct pair_tables t = {.count = {[MEET_OPTIMIZE] = MEET_OPTIMIZATIONS, [MEET_MOTION] = 2}};
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
        add(&t, MEET_ENGINE, engine_find(engine_names[i]));
    for (size_t i = 0; layouts_all[i]; i++)
        if (!layouts_all[i]->faithful)
            add(&t, MEET_LAYOUT, layouts_all[i]);
    for (size_t i = 0; builders_all[i]; i++)
        if (!builders_all[i]->faithful)
            add(&t, MEET_BUILDER, builders_all[i]);
    for (size_t i = 0; tri_stores[i]; i++)
        add(&t, MEET_STORE, tri_stores[i]);
    for (size_t i = 0; tri_tests[i]; i++)
        if (!tri_tests[i]->faithful)
            add(&t, MEET_TRI, tri_tests[i]);
    for (size_t i = 0; box_tests[i]; i++)
        if (!box_tests[i]->faithful)
            add(&t, MEET_BOX, box_tests[i]);
    return t;
}

static inline struct pair_coverage *open_all(void)
{
    static struct pair_tables tables;
    struct pair_coverage *m;
    tables = all_tables();
    if (pair_coverage_open(&tables, &m, &reason))
        fail_msg("%s", reason.text);
    return m;
}

/* The member of that name. */
static inline uint32_t named(const struct pair_coverage *m, enum pair_factor factor,
                             const char *name)
{
    const struct pair_tables *t = pair_coverage_tables(m);
    for (uint32_t i = 0; i < t->count[factor]; i++)
        if (strcmp(pair_coverage_name(m, factor, i), name) == 0)
            return i;
    fail_msg("no %s %s", pair_factor_name(factor), name);
    return 0;
}

#endif
