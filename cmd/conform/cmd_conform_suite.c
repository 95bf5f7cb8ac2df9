#include "cmd/conform/cmd_conform_suite_inner.h"

#include "fuzz/gen/covering.h"
#include "scenes/scenes.h"
#include "ref/store.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_DOTS    8 /* of a trial name whose scene has none */
#define LAYOUT_FIELD 2

/* The tables whose members form pairs, in the order of a row. */
static const enum table with_tree[] = {TABLE_ENGINES,    TABLE_LAYOUTS,   TABLE_BUILDERS,
                                       TABLE_BOX_TESTS,  TABLE_TRI_TESTS, TABLE_QUERIES,
                                       TABLE_GENERATORS, TABLE_RAY_SETS};
static const enum table with_stores[] = {TABLE_ENGINES,  TABLE_LAYOUTS,    TABLE_STORES,
                                         TABLE_BUILDERS, TABLE_BOX_TESTS,  TABLE_TRI_TESTS,
                                         TABLE_QUERIES,  TABLE_GENERATORS, TABLE_RAY_SETS};
static const enum table without_tree[] = {TABLE_ENGINES, TABLE_TRI_TESTS, TABLE_QUERIES,
                                          TABLE_GENERATORS, TABLE_RAY_SETS};

struct trial suite_trial(const struct suite_choice *c)
{
    struct trial trial = {.query = (enum query)c->index[TABLE_QUERIES],
                          .engine = engines[c->index[TABLE_ENGINES]],
                          .tri = tri_tests[c->index[TABLE_TRI_TESTS]],
                          .rays = ray_sets[c->index[TABLE_RAY_SETS]],
                          .seed = 1};
    strcpy(trial.scene, generators[c->index[TABLE_GENERATORS]]->name);
    if (trial.engine->needs_packed) {
        trial.layout = layouts_all[c->index[TABLE_LAYOUTS]];
        trial.store = tri_stores[c->index[TABLE_STORES]];
        trial.builder = builders_all[c->index[TABLE_BUILDERS]];
        trial.box = box_tests[c->index[TABLE_BOX_TESTS]];
    }
    return trial;
}

enum status suite_add(struct suite *suite, const struct trial *trial)
{
    char name[TRIAL_NAME_MOST];
    trial_print(trial, name);
    if (suite->kind == SUITE_PATTERN && fnmatch(suite->pattern, name, 0) != 0)
        return STATUS_OK;
    void *trials = suite->trial;
    enum status status = array_reserve(&trials, &suite->capacity, suite->count + 1, sizeof *trial);
    suite->trial = trials;
    if (!status)
        suite->trial[suite->count++] = *trial;
    return status;
}

/* --- members that take part ------------------------------------------------------------------- */

/* Matches a layout field, which is a name that may be followed by a storage. */
static bool layout_matches(const char *field, const char *name)
{
    char layout[TRIAL_NAME_MOST];
    snprintf(layout, sizeof layout, "%.*s", (int)strcspn(field, ":"), field);
    return fnmatch(layout, name, 0) == 0;
}

/* True if field `at` of the pattern matches the name; at < 0: any field except "*". */
static bool field_matches(const char *pattern, int at, const char *name)
{
    char field[TRIAL_NAME_MOST];
    for (int i = 0; *pattern; i++) {
        size_t length = strcspn(pattern, ".");
        if (length >= sizeof field)
            return true;
        memcpy(field, pattern, length);
        field[length] = '\0';
        if ((at < 0 ? strcmp(field, "*") != 0 : i == at) &&
            (at < 0 || at == LAYOUT_FIELD ? layout_matches(field, name)
                                          : fnmatch(field, name, 0) == 0))
            return true;
        pattern += length + (pattern[length] == '.');
    }
    return false;
}

static bool has_all_fields(const char *pattern)
{
    int dots = 0;
    for (const char *c = pattern; *c; c++)
        dots += *c == '.';
    return dots == NAME_DOTS;
}

bool suite_takes_stores(const struct suite *suite)
{
    if (suite->list[TABLE_STORES].count > 0)
        return true;
    if (suite->kind != SUITE_PATTERN || !has_all_fields(suite->pattern))
        return false;
    const char *field = suite->pattern;
    for (int i = 0; i < LAYOUT_FIELD; i++)
        field += strcspn(field, ".") + 1;
    return strcspn(field, ":") < strcspn(field, ".");
}

/* The tables of trials with or without a tree; sets *count to their number. */
static const enum table *tables_of(const struct suite *suite, bool tree, uint32_t *count)
{
    bool stores = tree && suite_takes_stores(suite);
    *count = stores ? ARRAY_COUNT(with_stores)
             : tree ? ARRAY_COUNT(with_tree)
                    : ARRAY_COUNT(without_tree);
    return stores ? with_stores : tree ? with_tree : without_tree;
}

/* If the pattern has as many dots as a name, no wildcard matches a dot, so each field belongs to
 * one table. */
static bool pattern_takes(const struct suite *suite, enum table table, size_t i)
{
    static const int field_of[TABLE_COUNT] = {
        [TABLE_QUERIES] = 0,    [TABLE_ENGINES] = 1,   [TABLE_LAYOUTS] = LAYOUT_FIELD,
        [TABLE_BUILDERS] = 3,   [TABLE_BOX_TESTS] = 4, [TABLE_TRI_TESTS] = 5,
        [TABLE_GENERATORS] = 6, [TABLE_RAY_SETS] = 7};
    const char *name = table_member(table, i, NULL);
    if (table == TABLE_STORES)
        return true;
    if (has_all_fields(suite->pattern))
        return field_matches(suite->pattern, field_of[table], name);
    if (table != TABLE_LAYOUTS)
        return true;
    struct list core = table_all(TABLE_LAYOUTS);
    return i < core.count || field_matches(suite->pattern, -1, name);
}

/* Lists take part where a pattern begins with them, so that others mean what they always meant. */
static bool names_lists(const struct suite *suite)
{
    return suite->kind == SUITE_PATTERN && strncmp(suite->pattern, "all.", 4) == 0;
}

/* A builder on a device takes part where it is named: not every machine has one. */
static bool is_elsewhere(const struct suite *suite, enum table table, size_t i)
{
    const bool named = suite->kind == SUITE_PATTERN && strstr(suite->pattern, "gpu") != NULL;
    return table == TABLE_BUILDERS && builders_all[i]->compare && suite->kind != SUITE_PRODUCT &&
           !named;
}

static bool takes_part(const struct suite *suite, enum table table, size_t i)
{
    const struct list *list = &suite->list[table];
    if (table == TABLE_QUERIES && i == QUERY_ALL && !names_lists(suite))
        return false;
    if (suite->kind == SUITE_PATTERN && !pattern_takes(suite, table, i))
        return false;
    if (list->count > 0)
        return list_has(list, i);
    if (is_elsewhere(suite, table, i))
        return false;
    return table != TABLE_ENGINES || suite->kind == SUITE_PATTERN ||
           engines[i] != engine_reference(false); /* others are compared with the reference */
}

struct list suite_members(const struct suite *suite, enum table table, bool tree)
{
    struct list list = {.count = 0};
    for (size_t i = 0; list.count < LIST_MOST && table_member(table, i, NULL); i++)
        if (takes_part(suite, table, i) &&
            (table != TABLE_ENGINES || engines[i]->needs_packed == tree))
            list.index[list.count++] = i;
    return list;
}

/* --- the three kinds -------------------------------------------------------------------------- */

static enum status add_covering(struct suite *suite, bool tree, struct reason *reason)
{
    uint32_t tables;
    const enum table *table = tables_of(suite, tree, &tables);
    struct list list[TABLE_COUNT];
    uint32_t members[TABLE_COUNT];
    struct covering covering;
    for (uint32_t t = 0; t < tables; t++) {
        list[t] = suite_members(suite, table[t], tree);
        members[t] = (uint32_t)list[t].count;
        if (members[t] == 0)
            return STATUS_OK;
    }
    enum status status = covering_make(members, tables, &covering, reason);
    for (uint32_t r = 0; r < covering.rows && !status; r++) {
        struct suite_choice choice = {{0}};
        for (uint32_t t = 0; t < tables; t++)
            choice.index[table[t]] = list[t].index[covering.member[r * tables + t]];
        struct trial trial = suite_trial(&choice);
        status = suite_add(suite, &trial);
    }
    covering_free(&covering);
    return status;
}

/* Adds every combination of members of the tables. With `everywhere` this includes scenes and ray
 * sets; otherwise they take turns. */
static enum status add_product(struct suite *suite, bool tree, bool everywhere)
{
    uint32_t tables;
    const enum table *table = tables_of(suite, tree, &tables);
    uint32_t combined = everywhere ? tables : tables - 2; /* scenes and ray sets are last */
    struct list list[TABLE_COUNT];
    size_t at[TABLE_COUNT] = {0}, serial = 0;
    for (uint32_t t = 0; t < tables; t++) {
        list[t] = suite_members(suite, table[t], tree);
        if (list[t].count == 0)
            return STATUS_OK;
    }
    for (uint32_t t = 0; t < combined;) {
        struct suite_choice choice = {{0}};
        if (!everywhere) {
            /* All engines, the first table, get the same scene and rays. */
            size_t turn = serial++ / list[0].count;
            at[tables - 2] = turn % list[tables - 2].count;
            at[tables - 1] = turn / list[tables - 2].count % list[tables - 1].count;
        }
        for (uint32_t k = 0; k < tables; k++)
            choice.index[table[k]] = list[k].index[at[k]];
        struct trial trial = suite_trial(&choice);
        enum status status = suite_add(suite, &trial);
        if (status)
            return status;
        for (t = 0; t < combined && ++at[t] == list[t].count; t++)
            at[t] = 0;
    }
    return STATUS_OK;
}

static enum status add_all(struct suite *suite, struct reason *reason)
{
    enum status status;
    if (suite->kind == SUITE_COVERING) {
        status = add_covering(suite, true, reason);
        if (!status)
            status = add_covering(suite, false, reason);
        return status;
    }
    status = add_product(suite, true, suite->kind == SUITE_PATTERN);
    if (!status)
        status = add_product(suite, false, suite->kind == SUITE_PATTERN);
    return status;
}

int suite_by_stage(const void *a, const void *b)
{
    static const enum table tables[] = {TABLE_GENERATORS, TABLE_RAY_SETS, TABLE_TRI_TESTS,
                                        TABLE_BUILDERS,   TABLE_LAYOUTS,  TABLE_STORES,
                                        TABLE_BOX_TESTS,  TABLE_QUERIES,  TABLE_ENGINES};
    const struct trial *x = a, *y = b;
    const char *of_x[TABLE_COUNT], *of_y[TABLE_COUNT];
    int order = 0;
    suite_names(x, of_x);
    suite_names(y, of_y);
    for (size_t i = 0; i < ARRAY_COUNT(tables) && order == 0; i++) {
        const char *p = of_x[tables[i]], *q = of_y[tables[i]];
        order = tables[i] == TABLE_QUERIES ? order_numbers(x->query, y->query)
                                           : strcmp(p ? p : "", q ? q : "");
    }
    return order;
}

enum status suite_make(struct suite *suite, struct reason *reason)
{
    struct trial one;
    enum status status;
    if (suite->kind == SUITE_PATTERN && strpbrk(suite->pattern, "*?[") == NULL) {
        status = trial_parse(suite->pattern, &one, reason);
        if (!status)
            status = suite_add(suite, &one);
    } else {
        status = add_all(suite, reason);
    }
    if (status == STATUS_MEMORY)
        return fail(reason, status, "no memory for the list of trials");
    if (status)
        return status;
    if (suite->count == 0)
        return fail(reason, STATUS_INPUT,
                    "no trial matches '%s'%s: raydiff conform --list prints their names",
                    suite->pattern ? suite->pattern : "*",
                    suite->list[TABLE_ENGINES].count ? " and --engine" : "");
    qsort(suite->trial, suite->count, sizeof *suite->trial, suite_by_stage);
    return STATUS_OK;
}

enum status suite_append(struct suite *suite, bool **ran, const struct suite *more)
{
    if (more->count == 0)
        return STATUS_OK;
    bool *all = alloc_zeroed(suite->count + more->count, sizeof *all);
    void *trials = suite->trial;
    enum status status = all ? array_reserve(&trials, &suite->capacity, suite->count + more->count,
                                             sizeof *suite->trial)
                             : STATUS_MEMORY;
    suite->trial = trials;
    if (status) {
        free(all);
        return status;
    }
    memcpy(all, *ran, suite->count * sizeof *all);
    memcpy(suite->trial + suite->count, more->trial, more->count * sizeof *more->trial);
    suite->count += more->count;
    free(*ran);
    *ran = all;
    return STATUS_OK;
}

void suite_free(struct suite *suite)
{
    free(suite->trial);
    suite->trial = NULL;
    suite->count = suite->capacity = 0;
}
