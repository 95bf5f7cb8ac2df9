#include "cmd/conform/cmd_world_suite.h"

#include "fuzz/gen/covering.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TWO_MOST 512

/* Layouts, builders or tests, two at a time. */
struct twos {
    struct {
        const void *first, *second;
    } of[TWO_MOST];
    uint32_t count;
};

static void twos_add(struct twos *twos, const void *first, const void *second)
{
    if (twos->count == TWO_MOST)
        return;
    twos->of[twos->count].first = first;
    twos->of[twos->count++].second = second;
}

/* As published, or on a device. */
static bool is_published(enum table table, size_t i)
{
    return (table == TABLE_LAYOUTS && layouts_all[i]->faithful) ||
           (table == TABLE_BUILDERS && (builders_all[i]->faithful || builders_all[i]->compare)) ||
           (table == TABLE_BOX_TESTS && box_tests[i]->faithful) ||
           (table == TABLE_TRI_TESTS && tri_tests[i]->faithful);
}

/* The members of a table that take part. */
static struct list members(const struct world_suite *suite, enum table table)
{
    const struct list *named = &suite->list[table];
    struct list all = named->count > 0 ? *named : table_all(table), out = {.count = 0};
    for (size_t i = 0; i < all.count; i++)
        if (named->count > 0 || !is_published(table, all.index[i]))
            out.index[out.count++] = all.index[i];
    return out;
}

/* Each member below itself, and with `others` below the one after it if there are several. */
static struct twos below(const struct world_suite *suite, enum table table, bool others)
{
    const struct list list = members(suite, table);
    struct twos out = {.count = 0};
    for (size_t i = 0; i < list.count; i++)
        twos_add(&out, table_pointer(table, list.index[i]), NULL);
    for (size_t i = 0; i < list.count && list.count > 1 && others; i++)
        twos_add(&out, table_pointer(table, list.index[i]),
                 table_pointer(table, list.index[(i + 1) % list.count]));
    return out;
}

/* Every box test with every triangle test; without a tree triangle tests alone. */
static struct twos tests(const struct world_suite *suite, bool tree)
{
    const struct list box = members(suite, TABLE_BOX_TESTS), tri = members(suite, TABLE_TRI_TESTS);
    struct twos out = {.count = 0};
    for (size_t b = 0; b < (tree ? box.count : 1); b++)
        for (size_t t = 0; t < tri.count; t++)
            twos_add(&out, tree ? box_tests[box.index[b]] : NULL, tri_tests[tri.index[t]]);
    return out;
}

/* Which engines a covering array is of. Shaders have one layout for both levels, so that a top of
 * another is for the processor alone. */
enum world_engines { ON_TREES, ON_TREES_IN_SHADERS, WITHOUT_TREES, WORLD_ENGINES };

static struct list engines_of(const struct world_suite *suite, enum world_engines kind)
{
    const struct list all = members(suite, TABLE_ENGINES);
    struct list out = {.count = 0};
    for (size_t i = 0; i < all.count; i++) {
        const struct engine *engine = engines[all.index[i]];
        const enum world_engines is = !engine->needs_packed ? WITHOUT_TREES
                                      : engine->gpu         ? ON_TREES_IN_SHADERS
                                                            : ON_TREES;
        if (engine->worlds && is == kind)
            out.index[out.count++] = all.index[i];
    }
    return out;
}

static enum status add(struct world_suite *suite, const struct world_trial *trial)
{
    char name[WORLD_NAME_MOST];
    void *trials = suite->trial;
    world_trial_print(trial, name);
    if (suite->pattern && fnmatch(suite->pattern, name, 0) != 0)
        return STATUS_OK;
    enum status status = array_reserve(&trials, &suite->capacity, suite->count + 1, sizeof *trial);
    suite->trial = trials;
    if (!status)
        suite->trial[suite->count++] = *trial;
    return status;
}

/* --- the covering array ----------------------------------------------------------------------- */

/* Closest and any; lists too, if one of the engines makes any. */
static uint32_t queries_of(const struct list *engine)
{
    bool lists = false;
    for (size_t i = 0; i < engine->count; i++)
        lists = lists || engines[engine->index[i]]->worlds->trace_world_all;
    return lists ? QUERY_COUNT : QUERY_ALL;
}

/* Its tables; the last are those of struct composition. */
enum world_table { OF_ENGINE, OF_QUERY, OF_TESTS, OF_LAYOUTS, OF_BUILDERS, OF_TREE_COUNT };

static enum status add_covering(struct world_suite *suite, enum world_engines kind,
                                struct reason *reason)
{
    const bool tree = kind != WITHOUT_TREES;
    const struct list engine = engines_of(suite, kind);
    const struct twos test = tests(suite, tree),
                      layout = below(suite, TABLE_LAYOUTS, kind == ON_TREES),
                      builder = below(suite, TABLE_BUILDERS, true);
    uint32_t count[COVERING_TABLES_MOST] = {[OF_ENGINE] = (uint32_t)engine.count,
                                            [OF_QUERY] = queries_of(&engine),
                                            [OF_TESTS] = test.count,
                                            [OF_LAYOUTS] = layout.count,
                                            [OF_BUILDERS] = builder.count};
    const uint32_t base = tree ? OF_TREE_COUNT : OF_LAYOUTS, tables = base + COMPOSED_AXES;
    struct covering covering;
    for (uint32_t a = 0; a < COMPOSED_AXES; a++)
        count[base + a] = composed_members((enum composed_axis)a);
    if (engine.count == 0)
        return STATUS_OK;
    enum status status = covering_make(count, tables, &covering, reason);
    for (uint32_t r = 0; r < covering.rows && !status; r++) {
        const uint16_t *m = covering.member + (size_t)r * tables;
        struct world_trial trial = {.query = (enum query)m[OF_QUERY],
                                    .engine = engines[engine.index[m[OF_ENGINE]]],
                                    .box = test.of[m[OF_TESTS]].first,
                                    .tri = test.of[m[OF_TESTS]].second,
                                    .seed = 1};
        if (tree) {
            trial.layout = layout.of[m[OF_LAYOUTS]].first;
            trial.top_layout = layout.of[m[OF_LAYOUTS]].second;
            trial.builder = builder.of[m[OF_BUILDERS]].first;
            trial.top_builder = builder.of[m[OF_BUILDERS]].second;
        }
        for (uint32_t a = 0; a < COMPOSED_AXES; a++)
            trial.of.member[a] = m[base + a];
        status = add(suite, &trial);
    }
    covering_free(&covering);
    return status;
}

/* By world, then by trees, then by engine. */
static int by_stage(const void *a, const void *b)
{
    static const enum world_field fields[] = {WORLD_FIELD_TRI,    WORLD_FIELD_BUILDER,
                                              WORLD_FIELD_LAYOUT, WORLD_FIELD_BOX,
                                              WORLD_FIELD_QUERY,  WORLD_FIELD_ENGINE};
    const struct world_trial *x = a, *y = b;
    int order = memcmp(&x->of, &y->of, sizeof x->of);
    for (size_t i = 0; i < ARRAY_COUNT(fields) && order == 0; i++) {
        char p[WORLD_FIELD_MOST], q[WORLD_FIELD_MOST];
        world_trial_field(x, fields[i], p);
        world_trial_field(y, fields[i], q);
        order = strcmp(p, q);
    }
    return order;
}

enum status world_suite_make(struct world_suite *suite, struct reason *reason)
{
    struct world_trial one;
    enum status status;
    if (suite->pattern && strpbrk(suite->pattern, "*?[") == NULL) {
        status = world_trial_parse(suite->pattern, &one, reason);
        if (!status)
            status = add(suite, &one);
    } else {
        status = STATUS_OK;
        for (int kind = 0; kind < WORLD_ENGINES && !status; kind++)
            status = add_covering(suite, (enum world_engines)kind, reason);
    }
    if (status == STATUS_MEMORY)
        return fail(reason, status, "no memory for the list of trials");
    if (status)
        return status;
    if (suite->count == 0)
        return fail(reason, STATUS_INPUT,
                    "no trial of worlds matches '%s'%s: raydiff conform --worlds --list prints "
                    "their names",
                    suite->pattern ? suite->pattern : "*",
                    suite->list[TABLE_ENGINES].count ? " and --engine" : "");
    qsort(suite->trial, suite->count, sizeof *suite->trial, by_stage);
    return STATUS_OK;
}

/* --- pairs ------------------------------------------------------------------------------------ */

struct world_pair {
    enum world_field a, b;
    char name[2][WORLD_FIELD_MOST];
    bool ran;
};

static int by_pair(const void *a, const void *b)
{
    const struct world_pair *x = a, *y = b;
    int order = order_numbers(x->a, y->a);
    order = order ? order : order_numbers(x->b, y->b);
    order = order ? order : strcmp(x->name[0], y->name[0]);
    order = order ? order : strcmp(x->name[1], y->name[1]);
    return order ? order : (int)y->ran - (int)x->ran; /* the first of equal pairs ran if any did */
}

static size_t put_pairs(const struct world_trial *trial, bool ran, struct world_pair *pair)
{
    char name[WORLD_FIELDS][WORLD_FIELD_MOST];
    size_t count = 0;
    for (int f = 0; f < WORLD_FIELDS; f++)
        world_trial_field(trial, (enum world_field)f, name[f]);
    for (int a = 0; a < WORLD_FIELDS; a++)
        for (int b = a + 1; b < WORLD_FIELDS; b++) {
            if (strcmp(name[a], "-") == 0 || strcmp(name[b], "-") == 0)
                continue;
            struct world_pair *one = &pair[count++];
            *one =
                (struct world_pair){.a = (enum world_field)a, .b = (enum world_field)b, .ran = ran};
            strcpy(one->name[0], name[a]);
            strcpy(one->name[1], name[b]);
        }
    return count;
}

static bool is_of_trees(enum world_field field)
{
    return field >= WORLD_FIELD_LAYOUT && field <= WORLD_FIELD_BOX;
}

/* The engine of a pair that names none: the first that takes part and has a tree, or none. */
static const struct engine *stand_in(const struct world_suite *suite, bool tree)
{
    for (int kind = tree ? ON_TREES : WITHOUT_TREES; kind < WORLD_ENGINES; kind++) {
        const struct list list = engines_of(suite, (enum world_engines)kind);
        if (list.count && (kind != WITHOUT_TREES || !tree))
            return engines[list.index[0]];
    }
    return engine_reference(tree);
}

/* A trial with the pair and the first member of all else. */
static enum status add_pair(const struct world_suite *suite, const struct world_pair *pair,
                            struct world_suite *more)
{
    struct world_trial trial = {.seed = 1};
    struct reason why;
    char name[WORLD_NAME_MOST] = "world", field[WORLD_FIELD_MOST];
    const bool tree =
        is_of_trees(pair->a) || is_of_trees(pair->b) ||
        engines_of(suite, ON_TREES).count + engines_of(suite, ON_TREES_IN_SHADERS).count > 0;
    trial.engine = pair->a == WORLD_FIELD_ENGINE   ? engine_find(pair->name[0])
                   : pair->b == WORLD_FIELD_ENGINE ? engine_find(pair->name[1])
                                                   : stand_in(suite, tree);
    const struct twos test = tests(suite, trial.engine->needs_packed);
    trial.tri = test.of[0].second;
    if (trial.engine->needs_packed) {
        trial.layout = below(suite, TABLE_LAYOUTS, false).of[0].first;
        trial.builder = below(suite, TABLE_BUILDERS, false).of[0].first;
        trial.box = test.of[0].first;
    }
    for (int f = 0; f < WORLD_FIELDS; f++) {
        const char *named = (int)pair->a == f   ? pair->name[0]
                            : (int)pair->b == f ? pair->name[1]
                                                : NULL;
        world_trial_field(&trial, (enum world_field)f, field);
        size_t used = strlen(name);
        snprintf(name + used, sizeof name - used, ".%s", named ? named : field);
    }
    size_t used = strlen(name);
    snprintf(name + used, sizeof name - used, ".1");
    enum status status = world_trial_parse(name, &trial, &why);
    return status == STATUS_OK ? add(more, &trial) : status;
}

enum status world_suite_pairs(const struct world_suite *suite, const bool *ran, size_t *pairs,
                              size_t *unmet, char *example, size_t example_bytes,
                              struct world_suite *more)
{
    const size_t each = WORLD_FIELDS * (WORLD_FIELDS - 1) / 2;
    struct world_pair *pair = alloc_zeroed(suite->count * each, sizeof *pair);
    enum status status = pair ? STATUS_OK : STATUS_MEMORY;
    size_t count = 0;
    *pairs = *unmet = 0;
    example[0] = '\0';
    for (size_t i = 0; i < suite->count && pair; i++)
        count += put_pairs(&suite->trial[i], ran[i], pair + count);
    if (pair)
        qsort(pair, count, sizeof *pair, by_pair);
    for (size_t i = 0; i < count && !status; i++) {
        const struct world_pair *one = &pair[i];
        const bool same = i > 0 && one->a == one[-1].a && one->b == one[-1].b &&
                          strcmp(one->name[0], one[-1].name[0]) == 0 &&
                          strcmp(one->name[1], one[-1].name[1]) == 0;
        *pairs += !same;
        if (same || one->ran)
            continue;
        if ((*unmet)++ == 0)
            snprintf(example, example_bytes, "%s with %s", one->name[0], one->name[1]);
        if (more)
            status = add_pair(suite, one, more);
    }
    free(pair);
    if (more && more->count > 0 && !status)
        qsort(more->trial, more->count, sizeof *more->trial, by_stage);
    return status;
}

enum status world_suite_append(struct world_suite *suite, bool **ran,
                               const struct world_suite *more)
{
    if (more->count == 0)
        return STATUS_OK;
    const size_t count = suite->count + more->count;
    bool *all = alloc_zeroed(count, sizeof *all);
    void *trials = suite->trial;
    enum status status =
        all ? array_reserve(&trials, &suite->capacity, count, sizeof *suite->trial) : STATUS_MEMORY;
    suite->trial = trials;
    if (status) {
        free(all);
        return status;
    }
    memcpy(all, *ran, suite->count * sizeof *all);
    memcpy(suite->trial + suite->count, more->trial, more->count * sizeof *more->trial);
    suite->count = count;
    free(*ran);
    *ran = all;
    return STATUS_OK;
}

void world_suite_free(struct world_suite *suite)
{
    free(suite->trial);
    suite->trial = NULL;
    suite->count = suite->capacity = 0;
}
