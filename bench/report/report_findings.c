/* Section 5: faults. Findings of the fuzzer, replayed and explained, and the mismatches found by
 * check. */
#include "bench/report/report_inner.h"
#include "ref/base/text.h"

#include <string.h>

#define MISMATCHES_MOST 60u /* limit of those shown */

/* --- findings of a folder ----------------------------------------------------------------- */

/* Copies the explanation's line that begins with "cause", without that word; "" if there is
 * none. */
static void cause_of(const char *text, char *cause, size_t cause_bytes)
{
    cause[0] = '\0';
    for (const char *at = text; at && *at;) {
        size_t length = strcspn(at, "\n");
        if (strncmp(at, "cause ", 6) == 0) {
            size_t skip = 5 + strspn(at + 5, " ");
            int left = length > skip ? (int)(length - skip) : 0;
            snprintf(cause, cause_bytes, "%.*s", left, at + skip);
        }
        at += length + (at[length] == '\n');
    }
}

static void put_facts(struct html *html, const struct report_part *part)
{
    const json_t *file = json_array_get(json_object_get(part->json, "files"), 0);
    html_begin(html, "p", "class", "dim", NULL);
    if (part->times > 0)
        html_format(html, "found %s; ", COUNTED(part->times, "time"));
    html_format(html, "smallest: %s, %s; played again: ",
                COUNTED(value_count(file, "triangles"), "triangle"),
                COUNTED(value_count(file, "rays"), "ray"));
    html_element(html, "b", NULL, value_bool(file, "fails") ? "still fails" : "does not fail");
    if (report_part_known(part))
        html_format(html, "; known: %s", part->known);
    html_end(html, "p");
}

static void put_drawing(struct html *html, const struct report_part *part)
{
    html_begin(html, "figure", NULL);
    fputs(part->drawing, html->out);
    html_element(html, "figcaption", NULL,
                 "What raydiff explain --html shows in a page where it can be turned.");
    html_end(html, "figure");
}

static void put_finding(struct html *html, const struct report *report, size_t p, bool open)
{
    const struct report_part *part = &report->part[p];
    char cause[320], id[REPORT_ID];
    cause_of(part->text, cause, sizeof cause);
    report_finding_id(p, id);
    html_begin(html, "h3", "id", id, NULL);
    html_text(html, part->name);
    html_end(html, "h3");
    if (part->json)
        put_facts(html, part);
    else
        html_element(html, "p", "note bad", part->why[0] ? part->why : "it could not be played");
    if (cause[0])
        html_element(html, "p", NULL, cause);
    if (part->drawing)
        put_drawing(html, part);
    if (part->page[0]) {
        html_begin(html, "p", NULL);
        html_begin(html, "a", "class", "page", "href", part->page, NULL);
        html_text(html, "In three dimensions, and by your own graphics card");
        html_end(html, "a");
        html_end(html, "p");
    }
    html_element(html, "pre", "line", part->command);
    if (part->text && part->text[0]) {
        html_begin(html, "details", "open", open ? "open" : NULL, NULL);
        html_element(html, "summary", NULL, "explanation");
        html_element(html, "pre", NULL, part->text);
        html_end(html, "details");
    }
}

static size_t put_findings(struct html *html, const struct report *report)
{
    size_t count = 0;
    for (size_t p = 0; p < report->part_count; p++) {
        if (report->part[p].kind != REPORT_FINDING || !report->part[p].name[0])
            continue;
        put_finding(html, report, p, count == 0);
        count++;
    }
    if (report->findings_left_out > 0)
        html_element_format(html, "p", "note", "%zu more findings are not shown.",
                            report->findings_left_out);
    return count;
}

/* --- mismatches of check ------------------------------------------------------------------ */

static void put_answer(struct html *html, const char *what, const json_t *hit)
{
    if (json_is_object(hit))
        html_format(html, "%s triangle %zu at t = %.9g", what, value_count(hit, "prim"),
                    value_number(hit, "t"));
    else
        html_format(html, "%s a miss", what);
}

static void put_right(struct html *html, const json_t *finding)
{
    const json_t *judgement = json_object_get(finding, "judgement");
    if (!json_is_object(judgement)) {
        put_answer(html, "; engine cpu:", json_object_get(finding, "expected"));
        return;
    }
    if (json_is_integer(json_object_get(judgement, "expected")))
        html_format(html, "; %s, right is triangle %zu at t from %.17g to %.17g",
                    value_text(judgement, "wrong"), value_count(judgement, "expected"),
                    value_number(judgement, "t_lo"), value_number(judgement, "t_hi"));
    else
        html_format(html, "; %s, right is a miss", value_text(judgement, "wrong"));
    if (json_is_integer(json_object_get(judgement, "lost")))
        html_format(html, ", and triangle %zu behind it was lost", value_count(judgement, "lost"));
}

static void put_mismatch(struct html *html, const json_t *row, const json_t *finding)
{
    static const char *const names[] = {"engine", "layout", "builder", "box", "tri", "query"};
    html_begin(html, "p", NULL);
    html_format(html, "%s:", value_text(row, "scene"));
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        if (value_text(row, names[i])[0])
            html_format(html, " %s", value_text(row, names[i]));
    html_format(html, ", ray %zu", value_count(finding, "ray"));
    put_answer(html, ":", json_object_get(finding, "got"));
    put_right(html, finding);
    html_end(html, "p");
    if (value_text(finding, "explain")[0])
        html_element(html, "pre", "line", value_text(finding, "explain"));
}

/* Prints the mismatches of one part of check. `count` is the number before it; returns the new
 * number. */
static size_t put_mismatches_of(struct html *html, const json_t *rows, size_t count)
{
    for (size_t r = 0; r < json_array_size(rows); r++) {
        const json_t *row = json_array_get(rows, r), *findings = json_object_get(row, "findings");
        for (size_t f = 0; f < json_array_size(findings); f++) {
            if (count == 0)
                html_element(html, "h3", NULL, "Mismatches of the agreement part");
            if (count < MISMATCHES_MOST)
                put_mismatch(html, row, json_array_get(findings, f));
            count++;
        }
    }
    return count;
}

static size_t put_mismatches(struct html *html, const struct report *report)
{
    size_t count = 0;
    for (size_t p = 0; p < report->part_count; p++)
        if (report->part[p].kind == REPORT_CHECK)
            count = put_mismatches_of(html, json_object_get(report->part[p].json, "rows"), count);
    if (count > MISMATCHES_MOST)
        html_element_format(html, "p", "note", "%zu more are not shown.", count - MISMATCHES_MOST);
    return count;
}

void report_findings(struct html *html, const struct report *report)
{
    section_begin(html, "findings", "5 Findings");
    section_reasons(html, report, REPORT_FINDING,
                    "raydiff fuzz --dir DIR looks for them; raydiff report --findings DIR plays "
                    "them again and explains each.");
    size_t mismatches = put_mismatches(html, report);
    if (mismatches == 0 && report->wanted[REPORT_CHECK])
        html_element(html, "p", NULL, "The agreement part met no mismatch.");
    if (put_findings(html, report) == 0 && report->wanted[REPORT_FINDING])
        html_element(html, "p", NULL, "The folder of findings holds none.");
    section_end(html);
}
