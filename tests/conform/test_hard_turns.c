/* Which layouts and builders meet which hard cases if none is named. */
#include "tests/hard/members.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define MOST  256
#define APART 3u /* of so many neighbouring cases every layout meets one */

/* Who meets a case on engine cpu, by places in layouts_all[] and builders_all[]; and on which
 * builder, and with which box test, triangle test and query together. */
struct turns_met {
    bool layout[MOST], builder[MOST], with[MOST][MOST], on[MOST][8];
};

static void meet(void *user, const struct hard_case *one, const struct hard_member *m)
{
    struct turns_met *met = user;
    (void)one;
    if (strcmp(m->engine->name, "cpu") != 0 || m->query == QUERY_ALL)
        return;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t b = 0; builders_all[b] && layouts_all[l] == m->layout; b++) {
            met->layout[l] = true;
            met->builder[b] |= builders_all[b] == m->builder;
            met->with[l][b] |= builders_all[b] == m->builder;
            met->on[l][(m->query == QUERY_ANY) + 2 * (strcmp(m->box->name, "robust") == 0) +
                       4 * (strcmp(m->tri->name, "mt") == 0)] = true;
        }
}

static bool in_product(const struct builder *builder)
{
    for (size_t b = 0; builders[b]; b++)
        if (builders[b] == builder)
            return true;
    return false;
}

static bool layout_in_product(const struct layout *layout)
{
    for (size_t l = 0; layouts[l]; l++)
        if (layouts[l] == layout)
            return true;
    return false;
}

/* Every builder meets every case with trees, every layout one of any three neighbours; but those as
 * published outside the product, whose faults are known. */
static void everybody_meets_hard_cases(void **state)
{
    const struct hard_tables tables = hard_tables_all();
    size_t cases = 0, since[MOST] = {0};
    (void)state;
    for (size_t i = 0; hard_case_at(i); i++) {
        static struct turns_met met;
        met = (struct turns_met){.layout = {false}};
        if (hard_case_at(i)->probe || hard_case_at(i)->flags & (HARD_NO_TREES | HARD_WORLD))
            continue;
        cases++;
        hard_each_member(hard_case_at(i), &tables, meet, &met);
        for (size_t l = 0; layouts_all[l]; l++) {
            const bool taken = layout_in_product(layouts_all[l]) || !layouts_all[l]->faithful;
            since[l] = met.layout[l] || !taken ? 0 : since[l] + 1;
            if (since[l] >= APART)
                fail_msg("layout %s misses case %u and those before it", layouts_all[l]->name,
                         hard_case_at(i)->number);
        }
        for (size_t b = 0; builders_all[b]; b++)
            if (!met.builder[b])
                fail_msg("builder %s misses case %u", builders_all[b]->name,
                         hard_case_at(i)->number);
    }
    assert_true(cases >= 60);
}

/* Every layout comes with every builder that is repaired, where it is not in the product, and with
 * every combination of box test, triangle test and query. */
static void every_layout_meets_every_builder(void **state)
{
    static struct turns_met all;
    const struct hard_tables tables = hard_tables_all();
    (void)state;
    for (size_t i = 0; hard_case_at(i); i++)
        hard_each_member(hard_case_at(i), &tables, meet, &all);
    for (size_t l = 0; layouts_all[l]; l++) {
        const bool product = layout_in_product(layouts_all[l]);
        if (!product && layouts_all[l]->faithful)
            continue;
        for (size_t b = 0; builders_all[b]; b++)
            if (!all.with[l][b] &&
                (product ? in_product(builders_all[b]) : !builders_all[b]->faithful))
                fail_msg("%s misses builder %s", layouts_all[l]->name, builders_all[b]->name);
        for (size_t c = 0; c < 8; c++)
            if (!all.on[l][c])
                fail_msg("layout %s misses combination %zu", layouts_all[l]->name, c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everybody_meets_hard_cases),
        cmocka_unit_test(every_layout_meets_every_builder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
