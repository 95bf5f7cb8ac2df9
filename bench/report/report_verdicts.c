/* The table below the matrix: every row of check with its rays, hits, verdicts, bits and speed. */
#include "bench/report/report_inner.h"

#include <math.h>
#include <string.h>

/* Classes in the judge's order. */
static const char *const classes[] = {"tie",      "near_tie", "boundary", "border",
                                      "in_plane", "slab",     "noise",    "out_of_contract"};

static void put_count(struct html *html, size_t count)
{
    html_element_format(html, "td", count ? "n" : "n z", "%zu", count);
}

void report_number(struct html *html, const char *format, double value)
{
    char text[48];
    snprintf(text, sizeof text, format, value);
    html_element(html, "td", "n", isfinite(value) ? text : "");
}

/* Prints kinds with their counts, such as "missed 3, phantom 1". */
static void put_kinds(struct html *html, const json_t *row)
{
    const char *name, *comma = "";
    const json_t *value;
    html_begin(html, "td", NULL);
    json_object_foreach(json_object_get(row, "wrong"), name, value)
    {
        if (json_integer_value(value) <= 0)
            continue;
        html_format(html, "%s%s %lld", comma, name, (long long)json_integer_value(value));
        comma = ", ";
    }
    html_end(html, "td");
}

static void put_row(struct html *html, const json_t *row)
{
    static const char *const names[] = {"layout", "engine", "builder", "tri", "box", "query"};
    enum row_look look = row_look(row);
    const json_t *counts = json_object_get(row, "counts");
    const json_t *speed = json_object_get(row, "mrays_per_s");
    html_begin(html, "tr", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        const char *name = value_text(row, names[i]);
        html_element(html, i < 2 ? "th" : "td", NULL, name[0] ? name : "\xE2\x80\x93");
    }
    put_count(html, value_count(row, "rays"));
    put_count(html, value_count(row, "hits"));
    for (size_t i = 0; i < ARRAY_COUNT(classes); i++)
        put_count(html, value_count(counts, classes[i]));
    report_number(html, "%.2f", value_number(row, "err_over_bound"));
    size_t wrong = value_count(counts, "wrong");
    if (wrong > 0)
        html_element_format(html, "td", look == LOOK_PUBLISHED ? "n pub" : "n bad", "%zu", wrong);
    else
        put_count(html, wrong);
    put_kinds(html, row);
    size_t bits = value_count(row, "bit_differences");
    html_element_format(html, "td", bits ? "n bad" : "n z", "%zu", bits);
    report_number(html, "%.3f", value_number(speed, "median"));
    report_number(html, "%.3f", value_number(speed, "min"));
    report_number(html, "%.3f", value_number(speed, "max"));
    report_number(html, "%.1f", value_number(row, "node_bytes") / 1e3);
    report_number(html, "%.1f", value_number(row, "item_bytes") / 1e3);
    html_end(html, "tr");
}

void report_verdicts(struct html *html, const struct check_rows *rows)
{
    html_begin(html, "details", NULL);
    html_element_format(html, "summary", NULL, "all %zu rows: rays, hits, verdicts, bits, speed",
                        rows->count);
    html_begin(html, "div", "class", "roll", NULL);
    html_table(html, "wide",
               "Answers in each allowed class; err/E: the largest error of t over its proven "
               "bound; bits: answers that differ from engine cpu's where they must not.");
    html_heads(html, "layout;engine;builder;triangle;box;query;#rays;#hits;#tie;#near tie;"
                     "#boundary;#border;#in plane;#slab;#noise;#out of contract;#err/E;#WRONG;"
                     "of kind;#bits;#Mrays/s;#least;#most;#nodes kB;#items kB");
    html_body(html);
    for (size_t i = 0; i < rows->count; i++) {
        enum row_look look = row_look(rows->row[i]);
        if (look != LOOK_NONE && look != LOOK_FAILED)
            put_row(html, rows->row[i]);
    }
    html_table_end(html);
    html_end(html, "div");
    html_end(html, "details");
}
