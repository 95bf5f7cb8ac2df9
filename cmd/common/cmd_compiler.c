#include "cmd/common/cmd_compiler_inner.h"

#include "gpu/engines/compiled.h"
#include "gpu/shaders/compiler.h"
#include "ref/base/command.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS_OF struct compiler_options

const struct option_row compiler_rows[] = {
    {"compiler", "C,..",
     "engines vulkan* and rayquery: compilers of their shaders, compared with raw bit for bit: raw "
     "(as built), opt and size (spirv-opt -O, -Os), passes:A+B (its passes; ./PROGRAM is one of "
     "your "
     "own), cross (SPIRV-Cross and glslang), hlsl, shaderc",
     OF_TEXT(list), .shown = "raw"},
    {"decorate", "WHEN",
     "NoContraction is put on every float operation before the compilers (source), after them "
     "(final) or never (none)",
     OF_CHOICE(decorate, decorate_names), .value = "source"},
    {"buffers", "W,..",
     "the same engines: how shaders read rays, nodes and triangles, compared with storage bit for "
     "bit: storage (storage buffers), texel (texel buffers), reference (buffer references)",
     OF_TEXT(memory), .shown = "storage"},
    {0},
};

/* A word of a list that is separated by commas. */
struct word {
    const char *text;
    size_t length;
};

/* Takes the next word off *at; returns false at the end. */
static bool next_word(const char **at, struct word *out)
{
    if (!*at)
        return false;
    *out = (struct word){*at, strcspn(*at, ",")};
    *at = (*at)[out->length] ? *at + out->length + 1 : NULL;
    return true;
}

static enum status find_memory(const struct word *word, enum memory *out, struct reason *reason)
{
    for (enum memory m = 0; m < MEMORY_COUNT; m++)
        if (strlen(memory_names[m]) == word->length &&
            memcmp(memory_names[m], word->text, word->length) == 0) {
            *out = m;
            return STATUS_OK;
        }
    return fail(reason, STATUS_INPUT, "--buffers: '%.*s' is no way: storage, texel or reference",
                (int)(word->length < 60 ? word->length : 60), word->text);
}

/* Adds an engine under the compiler of that name, its inputs read in that way. */
static enum status add(const struct compiler_options *options, const struct engine *engine,
                       const struct word *word, enum memory memory, struct list *out,
                       struct reason *reason)
{
    const char *text = word->text;
    const size_t length = word->length;
    const char *option = options->list ? "compiler" : "buffers";
    char name[COMPILER_NAME_MOST + 32];
    struct compiler compiler;
    const struct engine *made;
    struct reason why = {""};
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    enum status status = length < sizeof name
                             ? compiler_parse(name, &compiler, &why)
                             : fail(&why, STATUS_INPUT, "'%.60s...' is too long", name);
    if (!status && compiler.decorated && option_was_given("decorate"))
        return fail(reason, STATUS_INPUT, "--decorate: '%.60s' has its own", name);
    if (!status && compiler.memory != MEMORY_STORAGE && options->memory)
        return fail(reason, STATUS_INPUT, "--buffers: '%.60s' has its own", name);
    if (!status && !compiler.decorated)
        compiler.decorate = (enum decorate)options->decorate;
    if (!status && memory != MEMORY_STORAGE)
        compiler.memory = memory;
    if (!status)
        status = compiled_make(engine, &compiler, &made, &why);
    if (status)
        return fail(reason, status, "--%s: %s", option, why.text);
    if (list_names(out, made))
        return fail(reason, STATUS_INPUT, "--%s: %s is named twice", option, made->name);
    if (out->count == LIST_MOST)
        return fail(reason, STATUS_INPUT, "--%s: more than %d engines", option, LIST_MOST);
    list_add(out, TABLE_ENGINES, made);
    return STATUS_OK;
}

/* Adds the engine in each way under each compiler. */
static enum status add_all(const struct compiler_options *options, const struct engine *engine,
                           struct list *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct word way, compiler;
    for (const char *m = options->memory ? options->memory : memory_names[MEMORY_STORAGE];
         !status && next_word(&m, &way);) {
        enum memory memory = MEMORY_STORAGE;
        status = find_memory(&way, &memory, reason);
        for (const char *c = options->list ? options->list : "raw";
             !status && next_word(&c, &compiler);)
            status = add(options, engine, &compiler, memory, out, reason);
    }
    return status;
}

static enum status replace(const struct compiler_options *options, bool named, struct list *list,
                           struct reason *reason)
{
    struct list out = {.every = list->every, .all = list->all};
    enum status status = STATUS_OK;
    bool any = false;
    for (size_t i = 0; i < list->count && !status; i++) {
        const struct engine *engine = engines[list->index[i]];
        if (!compiled_takes(engine)) {
            if (named)
                list_add(&out, TABLE_ENGINES, engine);
            continue;
        }
        any = true;
        status = add_all(options, engine, &out, reason);
    }
    if (!status && !any)
        return fail(reason, STATUS_INPUT,
                    "--%s: not used here: it needs an engine vulkan, vulkan_brute, "
                    "vulkan_stackless or rayquery",
                    options->list ? "compiler" : "buffers");
    if (!status)
        *list = out;
    return status;
}

int compilers_apply(const char *command, const struct compiler_options *options, bool named,
                    struct list *engines_of)
{
    struct reason reason = {""};
    struct list list = engines_of->count > 0 ? *engines_of : table_all(TABLE_ENGINES);
    if (!options->list && option_was_given("decorate"))
        return usage_error(command, "--decorate: not used here: it needs --compiler");
    if (!options->list && !options->memory)
        return -1;
    enum status status = replace(options, named, &list, &reason);
    if (!status) {
        *engines_of = list;
        return -1;
    }
    return status == STATUS_INPUT ? usage_error(command, "%s", reason.text)
                                  : exit_with_reason(command, status, &reason);
}

/* --- what became of them ---------------------------------------------------------------------- */

enum {
    COL_COMPILER,
    COL_ENGINE,
    COL_LAYOUT,
    COL_BUILDER,
    COL_BOX,
    COL_TRI,
    COL_QUERY,
    COL_SOURCE,
    COL_KEPT,
    COL_OPEN,
    COL_BITS,
    COL_WRONG,
    COL_RATIO
};

static const struct column columns[] = {
    [COL_COMPILER] = {"compiler", .left = true},
    [COL_ENGINE] = {"engine", .left = true},
    [COL_LAYOUT] = {"layout", .left = true},
    [COL_BUILDER] = {"builder", .left = true, .varies = true, .rank = 4},
    [COL_BOX] = {"box", .left = true, .varies = true, .rank = 3},
    [COL_TRI] = {"tri", .left = true, .varies = true, .rank = 2},
    [COL_QUERY] = {"query", .left = true, .varies = true, .rank = 1},
    [COL_SOURCE] = {"source", .rank = 5},
    [COL_KEPT] = {"NoContraction"},
    [COL_OPEN] = {"open"},
    [COL_BITS] = {"bits"},
    [COL_WRONG] = {"WRONG"},
    [COL_RATIO] = {"speed", .least = 6},
};

/* The row of the same members with the shaders of the build, or NULL. */
static const struct row *raw_of(const struct compiled_rows *rows, const struct row *row)
{
    for (size_t i = 0; i < rows->all_count; i++) {
        const struct row *raw = &rows->all[i];
        const struct match_options *a = &raw->options, *b = &row->options;
        if (raw->engine == row->compiled.raw && raw->layout == row->layout &&
            raw->status == ROW_OK && a->store == b->store && a->builder == b->builder &&
            a->box == b->box && a->tri == b->tri && a->query == b->query)
            return raw;
    }
    return NULL;
}

double compiled_speed(const struct compiled_rows *rows, size_t i)
{
    const struct row *row = rows->row[i], *raw = raw_of(rows, row);
    return raw && raw->mrays[0] > 0 ? row->mrays[0] / raw->mrays[0] : 0;
}

bool compiled_equal(const struct row *row)
{
    return row->bits && row->bit_differences == 0;
}

static void write_number(const struct compiled_rows *rows, size_t i, size_t column, char *text)
{
    const struct row *row = rows->row[i];
    const double speed = compiled_speed(rows, i);
    const struct engine_compiled *compiled = &row->compiled;
    switch (column) {
    case COL_SOURCE:
        snprintf(text, CELL_MOST, "%u", row->compiled.source);
        break;
    case COL_KEPT:
        if (compiled->free)
            snprintf(text, CELL_MOST, "free, %u", compiled->ops);
        else
            snprintf(text, CELL_MOST, "%u of %u", compiled->kept, compiled->ops);
        break;
    case COL_OPEN:
        snprintf(text, CELL_MOST, "%u", row->compiled.foreign);
        break;
    case COL_BITS:
        if (compiled_equal(row))
            cell_put(text, "equal");
        else
            snprintf(text, CELL_MOST, "%zu%s", row->bits ? row->bit_differences : row->moved,
                     row->bits ? "" : " free");
        break;
    case COL_WRONG:
        snprintf(text, CELL_MOST, "%zu", row->count[VERDICT_WRONG]);
        break;
    default:
        if (speed > 0)
            snprintf(text, CELL_MOST, "%.2f", speed);
        else
            cell_put(text, "-");
        break;
    }
}

static void write_cell(const void *data, size_t i, size_t column, char *text)
{
    const struct compiled_rows *rows = data;
    const struct row *row = rows->row[i];
    char name[STORED_NAME_MOST];
    switch (column) {
    case COL_COMPILER:
        cell_put(text, row->compiled.compiler);
        break;
    case COL_ENGINE:
        cell_put(text, row->compiled.raw->name);
        break;
    case COL_LAYOUT:
        cell_put(text, stored_name(row->layout, row->options.store, name));
        break;
    case COL_BUILDER:
        cell_put(text, row->layout ? row->options.builder->name : "-");
        break;
    case COL_BOX:
        cell_put(text, row_box_name(row));
        break;
    case COL_TRI:
        cell_put(text, row_tri_name(row));
        break;
    case COL_QUERY:
        cell_put(text, query_name(row->options.query));
        break;
    default:
        write_number(rows, i, column, text);
        break;
    }
}

static enum paint paint_of(const void *data, size_t i)
{
    const struct row *row = ((const struct compiled_rows *)data)->row[i];
    return row_failed(row) ? PAINT_BAD : PAINT_GOOD;
}

void compilers_print(const struct row *row, size_t count, const char *title, const char *driver,
                     const struct screen *screen)
{
    struct compiled_rows rows = {
        .all = row, .all_count = count, .row = alloc_zeroed(count + 1, sizeof *rows.row)};
    for (size_t i = 0; i < count && rows.row; i++)
        if (row[i].compiled.words > 0 && row[i].status == ROW_OK)
            rows.row[rows.count++] = &row[i];
    const struct table_text table = {
        columns, ARRAY_COUNT(columns), rows.count, &rows, write_cell, NULL, paint_of};
    enum status status = rows.row ? STATUS_OK : STATUS_MEMORY;
    if (rows.count > 0) {
        screen_text(screen, "compilers, %s, driver %s: speed beside the shaders as built\n", title,
                    driver ? driver : "any");
        table_text_print(&table, screen);
        status = compiled_sums_print(&rows, screen);
    }
    if (status)
        screen_text(screen, "compilers: no memory for their table\n");
    free(rows.row);
}
