#include "cmd/common/cmd_tables.h"

#include "cmd/common/cmd_outside.h"
#include "cmd/common/cmd_screen.h"

#include "ref/base/nearest_name.h"
#include "ref/base/text.h"
#include "ref/outside/pipe.h"
#include "ref/engine.h"
#include "ref/match/turnout.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/store.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

bool list_has(const struct list *list, size_t index)
{
    for (size_t i = 0; i < list->count; i++)
        if (list->index[i] == index)
            return true;
    return false;
}

bool list_names(const struct list *list, const struct engine *engine)
{
    for (size_t i = 0; i < list->count; i++)
        if (engines[list->index[i]] == engine)
            return true;
    return false;
}

const char *table_name(enum table table)
{
    static const char *const names[TABLE_COUNT] = {"builders",       "layouts",  "box tests",
                                                   "triangle tests", "queries",  "engines",
                                                   "scenes",         "ray sets", "storages"};
    return names[table];
}

/* The name of a table's members in turnouts. */
static const char *kind_of(enum table table)
{
    static const char *const names[TABLE_COUNT] = {"builder", "layout", "box",  "tri",  "query",
                                                   "engine",  "scene",  "rays", "store"};
    return names[table];
}

/* Returns the name of member i of a NULL-terminated table of pointers; sets *text to its summary
 * and *at to the member. */
#define MEMBER(table)                                                                              \
    do {                                                                                           \
        if (!(table)[i])                                                                           \
            return NULL;                                                                           \
        *text = (table)[i]->summary;                                                               \
        *at = (table)[i];                                                                          \
        return (table)[i]->name;                                                                   \
    } while (0)

static const char *member(enum table table, size_t i, const char **text, const void **at)
{
    switch (table) {
    case TABLE_BUILDERS:
        MEMBER(builders_all);
    case TABLE_LAYOUTS:
        MEMBER(layouts_all);
    case TABLE_BOX_TESTS:
        MEMBER(box_tests);
    case TABLE_TRI_TESTS:
        MEMBER(tri_tests);
    case TABLE_ENGINES:
        MEMBER(engines);
    case TABLE_GENERATORS:
        MEMBER(generators);
    case TABLE_RAY_SETS:
        MEMBER(ray_sets);
    case TABLE_STORES:
        MEMBER(tri_stores);
    case TABLE_QUERIES:
        *text = i == QUERY_ALL   ? "every triangle along the ray, sorted"
                : i == QUERY_ANY ? "the first accepted hit ends the ray"
                                 : "the nearest hit";
        return i < QUERY_COUNT ? query_name((enum query)i) : NULL;
    case TABLE_COUNT:
        break;
    }
    return NULL;
}

const char *table_member(enum table table, size_t i, const char **summary)
{
    const char *text = NULL;
    const void *at = NULL;
    const char *name = member(table, i, &text, &at);
    if (summary)
        *summary = text;
    return name;
}

const void *table_pointer(enum table table, size_t i)
{
    const char *text = NULL;
    const void *at = NULL;
    return member(table, i, &text, &at) ? at : NULL;
}

struct list table_all(enum table table)
{
    struct list list = {.count = 0};
    for (size_t i = 0; table_member(table, i, NULL); i++)
        if (table != TABLE_LAYOUTS || layouts[list.count])
            list.index[list.count++] = i;
    return list;
}

void list_add(struct list *list, enum table table, const void *member)
{
    size_t i = 0;
    const void *at;
    while ((at = table_pointer(table, i)) && at != member)
        i++;
    if (at)
        list->index[list->count++] = i;
}

struct list list_of_one(enum table table, const void *member)
{
    struct list list = {.count = 0};
    list_add(&list, table, member);
    return list;
}

void list_engines(const struct list *list, const struct engine *out[LIST_MOST])
{
    for (size_t i = 0; i < list->count; i++)
        out[i] = engines[list->index[i]];
}

void list_layouts(const struct list *list, const struct layout *out[LIST_MOST])
{
    for (size_t i = 0; i < list->count; i++)
        out[i] = layouts_all[list->index[i]];
}

/* Explains why "auto", "all" or "every" is no name in this list; NULL: the name is none of
 * these. */
static const char *stands_alone(enum table table, const char *name, size_t length)
{
    if (length == 4 && memcmp(name, "auto", 4) == 0 && table == TABLE_LAYOUTS)
        return "is for check and render, and stands alone";
    if (table == TABLE_QUERIES || !((length == 3 && memcmp(name, "all", 3) == 0) ||
                                    (length == 5 && memcmp(name, "every", 5) == 0)))
        return NULL;
    return "stands alone, not in a list";
}

static enum status unknown(enum table table, const char *flag, const char *name, size_t length,
                           struct reason *reason)
{
    char known[200] = "";
    size_t i = 0;
    const char *one;
    const char *alone = stands_alone(table, name, length);
    if (alone)
        return fail(reason, STATUS_INPUT, "%s: '%.*s' %s", flag, (int)length, name, alone);
    for (; (one = table_member(table, i, NULL)) &&
           strlen(known) + strlen(one) + 2 < sizeof known - 40;
         i++)
        text_append(known, sizeof known, "%s%s", i ? ", " : "", one);
    if (one)
        text_append(known, sizeof known, ", ... (raydiff list %s)", table_name(table));
    struct nearest_name nearest = nearest_make(name, length);
    for (i = 0; (one = table_member(table, i, NULL)); i++)
        nearest_try(&nearest, one);
    return fail(reason, STATUS_INPUT, "%s: unknown name '%.*s'; %s are: %s%s%s%s%s", flag,
                (int)(length > 60 ? 60 : length), name, table_name(table), known,
                table == TABLE_ENGINES   ? ", pipe:COMMAND, ./FILE.so"
                : table == TABLE_LAYOUTS ? ", ./FILE.so"
                                         : "",
                nearest.name ? "; did you mean " : "", nearest.name ? nearest.name : "",
                nearest.name ? "?" : "");
}

void list_expect(enum table table, const struct list *list, struct turnout *turnout)
{
    for (size_t i = 0; i < list->count; i++)
        turnout_name(turnout, kind_of(table), table_member(table, list->index[i], NULL));
}

bool list_needs_trees(const struct list *list)
{
    for (size_t i = 0; i < list->count; i++)
        if (engines[list->index[i]]->needs_packed)
            return true;
    return false;
}

size_t list_rows(const struct list_rows *rows)
{
    size_t packed = 0;
    for (size_t e = 0; e < rows->engine->count; e++)
        packed += engines[rows->engine->index[e]]->needs_packed;
    return rows->tri->count * (packed * rows->trees * rows->storages * rows->box->count +
                               rows->engine->count - packed);
}

void turnout_expect(struct turnout *turnout, const struct list *engine, const struct list *playing,
                    const struct list *layout)
{
    if (engine)
        list_expect(TABLE_ENGINES, engine, turnout);
    if (layout && list_needs_trees(playing))
        list_expect(TABLE_LAYOUTS, layout, turnout);
}

void turnout_print(const struct turnout *turnout, const struct screen *screen)
{
    char line[512];
    for (size_t i = 0; i < turnout->count; i++) {
        const struct turnout_one *one = &turnout->one[i];
        if (!one->declines && !turnout_tells(one)) /* engines are always printed */
            continue;
        turnout_line(one, line, sizeof line);
        screen_record(screen, PAINT_PLAIN, "%s %s %s\n", one->kind, one->name, line);
    }
}

/* For queries, "all" is a member's name. */
static bool is_everything(enum table table, const char *text)
{
    return table != TABLE_QUERIES && strcmp(text, "all") == 0;
}

static bool begins_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

/* Adds the members that the name of `length` characters names or matches. Errors: STATUS_INPUT
 * none, or one was added before. */
static enum status add_members(enum table table, const char *flag, const char *text, size_t length,
                               struct list *out, struct reason *reason)
{
    char name[PIPE_NAME_MOST + 1];
    const char *one;
    size_t before = out->count;
    bool pattern = false;
    if (length < sizeof name) {
        memcpy(name, text, length);
        name[length] = '\0';
        pattern = !begins_with(text, PIPE_PREFIX) && strpbrk(name, "*?") != NULL;
    }
    for (size_t i = 0; (one = table_member(table, i, NULL)); i++) {
        bool is_one = strlen(one) == length && memcmp(one, text, length) == 0;
        if (!is_one && !(pattern && fnmatch(name, one, 0) == 0))
            continue;
        if (list_has(out, i))
            return fail(reason, STATUS_INPUT, "%s: '%s' is named twice", flag, one);
        out->index[out->count++] = i;
    }
    return out->count > before ? STATUS_OK : unknown(table, flag, text, length, reason);
}

enum status table_parse(enum table table, const char *flag, const char *text, struct list *out,
                        struct reason *reason)
{
    *out = (struct list){.count = 0};
    if (is_everything(table, text)) {
        *out = table_all(table);
        out->all = true;
        return STATUS_OK;
    }
    out->every = table != TABLE_QUERIES && strcmp(text, "every") == 0;
    if (out->every)
        text = "*";
    for (const char *at = text;; at++) {
        size_t length = outside_name_length(table, at);
        const char *name = at;
        size_t name_is = length;
        enum status status = outside_add(table, flag, &name, &name_is, reason);
        if (!status)
            status = add_members(table, flag, name, name_is, out, reason);
        if (status)
            return status;
        at += length;
        if (*at == '\0')
            return STATUS_OK;
    }
}

enum status list_bring_layouts(struct list *list, const char *text, struct reason *reason)
{
    struct list named;
    enum status status = table_parse(TABLE_LAYOUTS, "--layout", text, &named, reason);
    for (size_t i = 0; i < named.count && !status; i++) {
        const struct layout *layout = layouts_all[named.index[i]];
        if (!layout->outside)
            return fail(
                reason, STATUS_INPUT,
                "--layout: takes only FILE.so, since a finding names its layout; '%s' is built in",
                layout->name);
        if (list_has(list, named.index[i]))
            return fail(reason, STATUS_INPUT, "--layout: %s is named twice", layout->name);
        list->index[list->count++] = named.index[i]; /* fits: no duplicates */
    }
    return status;
}

enum status table_parse_one(enum table table, const char *flag, const char *text, size_t *index,
                            struct reason *reason)
{
    struct list list;
    enum status status = table_parse(table, flag, text, &list, reason);
    if (status == STATUS_OK && (list.count != 1 || is_everything(table, text)))
        status = fail(reason, STATUS_INPUT, "%s: '%s' is not one name", flag, text);
    *index = status ? 0 : list.index[0];
    return status;
}

const char *stored_name(const struct layout *layout, const struct tri_store *store,
                        char text[STORED_NAME_MOST])
{
    if (!layout)
        return "-";
    if (!store || store == tri_stores[0])
        return layout->name;
    snprintf(text, STORED_NAME_MOST, "%s:%s", layout->name, store->name);
    return text;
}
