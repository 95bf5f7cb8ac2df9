/* The agreement matrix of a scene, with a line for each engine, layout, storage and builder, and a
 * column for each query, triangle test and box test. */
#include "bench/report/report_inner.h"

#include <stdlib.h>
#include <string.h>

/* Lines and groups of columns are named by their first row; a group's columns are its box tests.
 * Engines without a tree have no box test, so their cell is as wide as the group. */
#define BOXES_MOST 8

#define CELLS_MOST 5000u /* limit of a readable matrix */

struct group {
    const json_t *first;
    const char *box[BOXES_MOST];
    size_t box_count;
};

/* The rows of one line in one group. */
struct cells {
    const json_t *plain; /* for an engine without a tree, or a layout given to no engine */
    const json_t *box[BOXES_MOST];
};

struct matrix_plan {
    const json_t **line;
    struct group *group;
    size_t line_count, group_count;
    struct cells *cells; /* line by line */
    bool builders;       /* more than one builder: show them */
    const char *store;   /* the first that is named: an engine without a tree has none */
    bool stores;         /* more than one */
};

static bool same_line(const json_t *a, const json_t *b)
{
    return value_same(a, b, "engine") && value_same(a, b, "layout") &&
           value_same(a, b, "builder") && value_same(a, b, "store");
}

static bool same_group(const json_t *a, const json_t *b)
{
    return value_same(a, b, "tri") && value_same(a, b, "query");
}

static size_t line_of(const struct matrix_plan *plan, const json_t *row)
{
    size_t l = 0;
    while (l < plan->line_count && !same_line(plan->line[l], row))
        l++;
    return l;
}

static size_t group_of(const struct matrix_plan *plan, const json_t *row)
{
    size_t g = 0;
    while (g < plan->group_count && !same_group(plan->group[g].first, row))
        g++;
    return g;
}

static size_t box_of(const struct group *group, const json_t *row)
{
    size_t b = 0;
    while (b < group->box_count && strcmp(group->box[b], value_text(row, "box")) != 0)
        b++;
    return b;
}

static bool is_plain(const json_t *row)
{
    return !value_text(row, "box")[0] || !value_text(row, "engine")[0];
}

static void plan_row(struct matrix_plan *plan, const json_t *row)
{
    size_t l = line_of(plan, row), g = group_of(plan, row);
    if (l == plan->line_count)
        plan->line[plan->line_count++] = row;
    struct group *group = &plan->group[g];
    if (g == plan->group_count) {
        *group = (struct group){.first = row};
        plan->group_count++;
    }
    size_t b = box_of(group, row);
    if (!is_plain(row) && b == group->box_count && b < BOXES_MOST)
        group->box[group->box_count++] = value_text(row, "box");
    plan->builders = plan->builders || !value_same(row, plan->line[0], "builder");
    const char *store = value_text(row, "store");
    plan->store = plan->store || !store[0] ? plan->store : store;
    plan->stores = plan->stores || (store[0] && strcmp(store, plan->store) != 0);
}

/* Stores the row in its cell, if it has one. The first row for a cell wins. */
static void fill_cell(struct matrix_plan *plan, const json_t *row)
{
    size_t g = group_of(plan, row);
    const struct group *group = &plan->group[g];
    struct cells *cells = &plan->cells[line_of(plan, row) * plan->group_count + g];
    size_t b = box_of(group, row);
    const json_t **cell = is_plain(row)          ? &cells->plain
                          : b < group->box_count ? &cells->box[b]
                                                 : NULL;
    if (cell && !*cell)
        *cell = row;
}

static const char *span_text(size_t span, char text[24])
{
    snprintf(text, 24, "%zu", span);
    return span > 1 ? text : NULL;
}

static size_t group_span(const struct group *group)
{
    return group->box_count ? group->box_count : 1;
}

static void put_head(struct html *html, const struct matrix_plan *plan)
{
    html_heads(html, "layout;engine");
    if (plan->builders)
        html_heads(html, "builder");
    if (plan->stores)
        html_heads(html, "storage");
    for (size_t g = 0; g < plan->group_count; g++) {
        const struct group *group = &plan->group[g];
        for (size_t b = 0; b < group_span(group); b++) {
            html_begin(html, "th", NULL);
            html_format(html, "%s hit", value_text(group->first, "query"));
            html_void(html, "br", NULL);
            html_format(html, "triangle %s", value_text(group->first, "tri"));
            html_void(html, "br", NULL);
            html_format(html, "box %s", group->box_count ? group->box[b] : "-");
            html_end(html, "th");
        }
    }
}

/* Prints the word of a cell, and below it the differences from the exact truth. */
static void put_result(struct html *html, const json_t *row, enum row_look look)
{
    size_t wrong = value_count(json_object_get(row, "counts"), "wrong");
    size_t bits = value_count(row, "bit_differences");
    if (look == LOOK_NONE || look == LOOK_FAILED) {
        html_text(html, value_text(row, "status"));
        return;
    }
    if (look == LOOK_GOOD)
        html_text(html, "agrees");
    else if (look == LOOK_PUBLISHED)
        html_format(html, "%zu wrong", wrong);
    else if (wrong > 0)
        html_format(html, "%zu WRONG", wrong);
    else if (bits > 0)
        html_format(html, "%zu other bits", bits);
    else
        html_text(html, "proves nothing");
    html_begin(html, "small", NULL);
    html_format(html, "%zu allowed", row_allowed(row));
    if (bits > 0 && wrong > 0)
        html_format(html, ", %zu bits", bits);
    html_end(html, "small");
}

static void put_cell(struct html *html, const json_t *row, size_t wide)
{
    char span[24];
    if (!row) {
        for (size_t i = 0; i < wide; i++)
            html_element(html, "td", "none", "");
        return;
    }
    enum row_look look = row_look(row);
    const char *reason = value_text(row, "reason");
    html_begin(html, "td", "class", look_class(look), "colspan", span_text(wide, span), "title",
               reason[0] ? reason : NULL, NULL);
    put_result(html, row, look);
    html_end(html, "td");
}

static void put_line(struct html *html, const struct matrix_plan *plan, size_t l)
{
    const json_t *line = plan->line[l];
    const char *layout = value_text(line, "layout"), *engine = value_text(line, "engine");
    html_begin(html, "tr", NULL);
    html_element(html, "th", NULL, layout[0] ? layout : "\xE2\x80\x93");
    html_element(html, "th", NULL, engine[0] ? engine : "every engine");
    if (plan->builders)
        html_element(html, "th", NULL, value_text(line, "builder"));
    if (plan->stores)
        html_element(html, "th", NULL, value_text(line, "store"));
    for (size_t g = 0; g < plan->group_count; g++) {
        const struct group *group = &plan->group[g];
        const struct cells *cells = &plan->cells[l * plan->group_count + g];
        if (cells->plain || group->box_count == 0) {
            put_cell(html, cells->plain, group_span(group));
            continue;
        }
        for (size_t b = 0; b < group->box_count; b++)
            put_cell(html, cells->box[b], 1);
    }
    html_end(html, "tr");
}

static void put_matrix(struct html *html, const struct matrix_plan *plan)
{
    html_table(html, "matrix", NULL);
    put_head(html, plan);
    html_body(html);
    for (size_t l = 0; l < plan->line_count; l++)
        put_line(html, plan, l);
    html_table_end(html);
}

void report_matrix(struct html *html, const struct check_rows *rows)
{
    struct matrix_plan plan = {.line = alloc_zeroed(rows->count, sizeof *plan.line),
                               .group = alloc_zeroed(rows->count, sizeof *plan.group)};
    for (size_t i = 0; i < rows->count && plan.line && plan.group; i++)
        plan_row(&plan, rows->row[i]);
    size_t cells = plan.line_count * plan.group_count;
    if (cells <= CELLS_MOST)
        plan.cells = alloc_zeroed(cells, sizeof *plan.cells);
    if (plan.cells && cells > 0) {
        for (size_t i = 0; i < rows->count; i++)
            fill_cell(&plan, rows->row[i]);
        put_matrix(html, &plan);
    } else {
        html_element(html, "p", "note bad", "The matrix is left out: it is too large.");
    }
    free(plan.line);
    free(plan.group);
    free(plan.cells);
}
