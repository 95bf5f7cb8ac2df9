/* Section 6: the machine, its engines, and a card for each Vulkan driver. */
#include "bench/report/report_inner.h"
#include "ref/files/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#define LINES_MOST   64u /* per card; the program's own cards have 17 */
#define DRIVERS_MOST 16u

/* Reads a name such as "Intel(R) ...", or "unknown". If it cannot be read, the reason goes to
 * standard error. */
static void processor(char *text, size_t text_bytes)
{
    static const char key[] = "model name";
    char *bytes;
    size_t size;
    struct reason reason;
    snprintf(text, text_bytes, "unknown");
    if (file_read("/proc/cpuinfo", &bytes, &size, &reason)) {
        fprintf(stderr, "raydiff report: the processor's name is unknown: %s\n", reason.text);
        return;
    }
    const char *line = strstr(bytes, key), *colon = line ? strchr(line, ':') : NULL;
    if (colon)
        snprintf(text, text_bytes, "%.*s", (int)strcspn(colon + 1, "\n"), colon + 1);
    free(bytes);
}

static void put_fact(struct html *html, const char *name, const char *text)
{
    html_begin(html, "tr", NULL);
    html_element(html, "th", NULL, name);
    html_element(html, "td", "wrap", text);
    html_end(html, "tr");
}

static void put_host(struct html *html)
{
    char text[700];
    struct utsname host;
    html_begin(html, "table", NULL);
    html_element(html, "caption", NULL, "The machine that this file was written on");
    html_begin(html, "tbody", NULL);
    processor(text, sizeof text);
    put_fact(html, "processor", text + strspn(text, " "));
    if (uname(&host) == 0) {
        snprintf(text, sizeof text, "%s %s, %s", host.sysname, host.release, host.machine);
        put_fact(html, "system", text);
    }
    put_fact(html, "raydiff", RAYDIFF_VERSION);
    html_table_end(html);
}

static void put_engines(struct html *html, const json_t *engines)
{
    size_t i;
    const json_t *engine;
    html_table(html, NULL, NULL);
    html_heads(html, "engine;runs;what it is, or why not");
    html_body(html);
    json_array_foreach(engines, i, engine)
    {
        bool runs = value_bool(engine, "runs");
        html_begin(html, "tr", NULL);
        html_element(html, "th", NULL, value_text(engine, "name"));
        html_element(html, "td", runs ? "good" : "none", runs ? "yes" : "no");
        html_element(html, "td", "wrap", value_text(engine, runs ? "text" : "why"));
        html_end(html, "tr");
    }
    html_table_end(html);
}

/* --- drivers ------------------------------------------------------------------------------ */

static void put_scalar(struct html *html, const json_t *value)
{
    if (json_is_string(value))
        html_text(html, json_string_value(value));
    else if (json_is_integer(value))
        html_format(html, "%lld", (long long)json_integer_value(value));
    else if (json_is_real(value))
        html_format(html, "%.6g", json_real_value(value));
    else if (json_is_boolean(value))
        html_text(html, json_is_true(value) ? "yes" : "no");
}

/* Prints how an operation compares with C's: "as in C", or the differences. */
static void put_operation(struct html *html, const json_t *op)
{
    size_t ordinary = value_count(op, "ordinary_differs"),
           special = value_count(op, "special_differs"), flushed = value_count(op, "flushed");
    if (ordinary + special == 0)
        html_text(html, "as in C to the bit");
    if (ordinary > 0)
        html_format(html, "%zu of %zu differ, by at most %zu ulp ", ordinary,
                    value_count(op, "ordinary"), value_count(op, "worst_ulp"));
    if (special > 0)
        html_format(html, "%zu of %zu special values differ, %zu of them subnormals made 0",
                    special, value_count(op, "special"), flushed);
}

/* Prints a member's name with blanks instead of '_'. */
static void put_name(struct html *html, const char *name)
{
    for (const char *at = name; *at; at++)
        html_format(html, "%c", *at == '_' ? ' ' : *at);
}

/* Prints an object or list as "name value, name value", in parentheses if it is nested. */
static void put_card_value(struct html *html, const json_t *value, int depth)
{
    const char *name, *comma = "";
    const json_t *member;
    size_t i;
    if (depth > 3) /* cards have two levels */
        return;
    if (!json_is_object(value) && !json_is_array(value)) {
        put_scalar(html, value);
        return;
    }
    json_array_foreach(value, i, member)
    {
        html_text(html, comma);
        put_card_value(html, member, depth + 1);
        comma = ", ";
    }
    json_object_foreach((json_t *)(uintptr_t)value, name, member)
    {
        html_text(html, comma);
        put_name(html, name);
        html_text(html, json_is_object(member) ? " (" : " ");
        put_card_value(html, member, depth + 1);
        html_text(html, json_is_object(member) ? ")" : "");
        comma = ", ";
    }
}

static const json_t *find_operation(const json_t *card, const char *name)
{
    const json_t *ops = json_object_get(card, "ops");
    for (size_t i = 0; i < json_array_size(ops) && i < LINES_MOST; i++)
        if (strcmp(value_text(json_array_get(ops, i), "op"), name) == 0)
            return json_array_get(ops, i);
    return NULL;
}

/* Finds the first card. Its members are the lines of the table. */
static const json_t *first_card(const json_t *drivers)
{
    for (size_t i = 0; i < json_array_size(drivers); i++) {
        const json_t *card = json_object_get(json_array_get(drivers, i), "card");
        if (json_is_object(card))
            return card;
    }
    return NULL;
}

static void put_operations(struct html *html, const json_t *drivers, const json_t *first)
{
    size_t i, d;
    const json_t *op, *driver;
    json_array_foreach(json_object_get(first, "ops"), i, op)
    {
        if (i == LINES_MOST)
            break;
        html_begin(html, "tr", NULL);
        html_element(html, "th", NULL, value_text(op, "op"));
        json_array_foreach(drivers, d, driver)
        {
            const json_t *card = json_object_get(driver, "card");
            const json_t *mine = find_operation(card, value_text(op, "op"));
            html_begin(html, "td", NULL);
            if (mine)
                put_operation(html, mine);
            html_end(html, "td");
        }
        html_end(html, "tr");
    }
}

static void put_card_lines(struct html *html, const json_t *drivers)
{
    const json_t *first = first_card(drivers), *member, *driver;
    const char *name;
    size_t d, lines = 0;
    json_object_foreach((json_t *)(uintptr_t)first, name, member)
    {
        if (lines++ == LINES_MOST)
            break;
        if (strcmp(name, "ops") == 0) {
            put_operations(html, drivers, first);
            continue;
        }
        html_begin(html, "tr", NULL);
        html_begin(html, "th", NULL);
        put_name(html, name);
        html_end(html, "th");
        json_array_foreach(drivers, d, driver)
        {
            html_begin(html, "td", NULL);
            put_card_value(html, json_object_get(json_object_get(driver, "card"), name), 0);
            html_end(html, "td");
        }
        html_end(html, "tr");
    }
}

static void put_drivers(struct html *html, const json_t *drivers)
{
    size_t i;
    const json_t *driver;
    html_table(html, "wide",
               "Vulkan drivers: what their arithmetic, conversions and loops do, measured");
    html_heads(html, "driver");
    json_array_foreach(drivers, i, driver)
        html_element(html, "th", NULL, value_text(driver, "name"));
    html_body(html);
    put_card_lines(html, drivers);
    html_begin(html, "tr", NULL);
    html_element(html, "th", NULL, "packages");
    json_array_foreach(drivers, i, driver)
        html_element(html, "td", NULL, value_text(driver, "packages"));
    html_end(html, "tr");
    html_table_end(html);
}

/* Shows running drivers as columns of a table, and the others with a reason. */
static void put_all_drivers(struct html *html, const json_t *drivers)
{
    json_t *running = json_array();
    for (size_t i = 0; i < json_array_size(drivers) && i < DRIVERS_MOST; i++) {
        json_t *driver = json_array_get(drivers, i);
        if (json_is_object(json_object_get(driver, "card")))
            (void)json_array_append(running, driver);
        else
            html_element_format(html, "p", "note", "Driver %s does not run: %s",
                                value_text(driver, "name"), value_text(driver, "why"));
    }
    if (json_array_size(running) > 0)
        put_drivers(html, running);
    json_decref(running);
}

void report_machine(struct html *html, const struct report *report)
{
    section_begin(html, "machine", "6 Machine and drivers");
    put_host(html);
    section_reasons(html, report, REPORT_MACHINE,
                    "--doctor FILE takes what raydiff doctor --json wrote.");
    for (size_t p = 0; p < report->part_count; p++) {
        const json_t *json = report->part[p].json;
        if (report->part[p].kind != REPORT_MACHINE || !json)
            continue;
        put_engines(html, json_object_get(json, "engines"));
        put_all_drivers(html, json_object_get(json, "drivers"));
    }
    section_end(html);
}
