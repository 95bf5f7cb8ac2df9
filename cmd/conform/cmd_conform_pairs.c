/* Counts the pairs of members that met in a conformance run, and adds trials for missing pairs. */
#include "cmd/conform/cmd_conform_suite_inner.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void suite_names(const struct trial *trial, const char *name[TABLE_COUNT])
{
    name[TABLE_BUILDERS] = trial->builder ? trial->builder->name : NULL;
    name[TABLE_LAYOUTS] = trial->layout ? trial->layout->name : NULL;
    name[TABLE_STORES] = trial->store ? trial->store->name : NULL;
    name[TABLE_BOX_TESTS] = trial->box ? trial->box->name : NULL;
    name[TABLE_TRI_TESTS] = trial->tri->name;
    name[TABLE_QUERIES] = query_name(trial->query);
    name[TABLE_ENGINES] = trial->engine->name;
    name[TABLE_GENERATORS] = trial->scene;
    name[TABLE_RAY_SETS] = trial->rays->name;
}

struct met {
    enum table a, b;
    char name[2][64];
    bool ran;
};

static int by_pair(const void *a, const void *b)
{
    const struct met *x = a, *y = b;
    int order = order_numbers(x->a, y->a);
    if (order == 0)
        order = order_numbers(x->b, y->b);
    if (order == 0)
        order = strcmp(x->name[0], y->name[0]);
    if (order == 0)
        order = strcmp(x->name[1], y->name[1]);
    return order ? order : (int)y->ran - (int)x->ran; /* the first of equal pairs ran if any did */
}

static size_t put_pairs(const struct trial *trial, bool stores, bool ran, struct met *met)
{
    const char *name[TABLE_COUNT] = {NULL};
    size_t count = 0;
    suite_names(trial, name);
    if (!stores)
        name[TABLE_STORES] = NULL;
    for (enum table a = 0; a < TABLE_COUNT; a++)
        for (enum table b = a + 1; b < TABLE_COUNT; b++) {
            if (!name[a] || !name[b])
                continue;
            struct met *one = &met[count++];
            *one = (struct met){.a = a, .b = b, .ran = ran};
            snprintf(one->name[0], sizeof one->name[0], "%s", name[a]);
            snprintf(one->name[1], sizeof one->name[1], "%s", name[b]);
        }
    return count;
}

static size_t index_of(enum table table, const char *name)
{
    size_t i = 0;
    const char *one;
    while ((one = table_member(table, i, NULL)) && strcmp(one, name) != 0)
        i++;
    return i;
}

/* The default engine for pairs that name none: `cpu` if it takes part, else the first engine that
 * takes part and matches `tree`. */
static size_t stand_in(const struct suite *suite, bool tree)
{
    struct list list = suite_members(suite, TABLE_ENGINES, tree);
    size_t cpu = index_of(TABLE_ENGINES, "cpu");
    return list_has(&list, cpu) || !list.count ? cpu : list.index[0];
}

static bool is_of_trees(enum table table)
{
    return table == TABLE_LAYOUTS || table == TABLE_STORES || table == TABLE_BUILDERS ||
           table == TABLE_BOX_TESTS;
}

/* Adds a trial with the pair and the first participating member of every other table. */
static enum status add_pair(const struct suite *suite, const struct met *met, struct suite *more)
{
    struct suite_choice choice = {{0}};
    bool tree = is_of_trees(met->a) || is_of_trees(met->b) ||
                suite_members(suite, TABLE_ENGINES, true).count > 0;
    for (enum table t = 0; t < TABLE_COUNT; t++) {
        struct list list = suite_members(suite, t, tree);
        choice.index[t] = list.count ? list.index[0] : 0;
    }
    choice.index[TABLE_ENGINES] = stand_in(suite, tree);
    choice.index[met->a] = index_of(met->a, met->name[0]);
    choice.index[met->b] = index_of(met->b, met->name[1]);
    struct trial trial = suite_trial(&choice);
    return suite_add(more, &trial);
}

enum status suite_pairs(const struct suite *suite, const bool *ran, size_t *pairs, size_t *unmet,
                        char *example, size_t example_bytes, struct suite *more)
{
    size_t each = TABLE_COUNT * (TABLE_COUNT - 1) / 2, count = 0;
    struct met *met = alloc_zeroed(suite->count * each, sizeof *met);
    enum status status = met ? STATUS_OK : STATUS_MEMORY;
    *pairs = *unmet = 0;
    example[0] = '\0';
    for (size_t i = 0; i < suite->count && met; i++)
        count += put_pairs(&suite->trial[i], suite_takes_stores(suite), ran[i], met + count);
    if (met)
        qsort(met, count, sizeof *met, by_pair);
    for (size_t i = 0; i < count && !status; i++) {
        bool same = i > 0 && met[i].a == met[i - 1].a && met[i].b == met[i - 1].b &&
                    strcmp(met[i].name[0], met[i - 1].name[0]) == 0 &&
                    strcmp(met[i].name[1], met[i - 1].name[1]) == 0;
        *pairs += !same;
        if (same || met[i].ran)
            continue;
        if ((*unmet)++ == 0)
            snprintf(example, example_bytes, "%s with %s", met[i].name[0], met[i].name[1]);
        if (more)
            status = add_pair(suite, &met[i], more);
    }
    free(met);
    if (more && more->count > 0 && !status)
        qsort(more->trial, more->count, sizeof *more->trial, suite_by_stage);
    return status;
}
