/* Section 2: agreement of engines, scene by scene. */
#include "bench/report/report_inner.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

#define ROWS_MOST   2048u /* per scene */
#define SCENES_MOST 64u

enum row_look row_look(const json_t *row)
{
    const char *status = value_text(row, "status");
    if (strcmp(status, "refused") == 0 || strcmp(status, "skipped") == 0)
        return LOOK_NONE;
    if (strcmp(status, "ok") != 0 && strcmp(status, "vacuous") != 0)
        return LOOK_FAILED;
    bool wrong = value_count(row, "differences") > 0 || strcmp(status, "ok") != 0;
    if (wrong)
        return LOOK_WRONG;
    return value_count(json_object_get(row, "counts"), "wrong") > 0 ? LOOK_PUBLISHED : LOOK_GOOD;
}

const char *look_class(enum row_look look)
{
    static const char *const css[] = {"good", "pub", "bad", "bad", "none"};
    return css[look];
}

size_t row_allowed(const json_t *row)
{
    size_t sum = 0;
    const char *name;
    const json_t *value;
    json_object_foreach(json_object_get(row, "counts"), name, value)
    {
        json_int_t count = json_integer_value(value);
        if (strcmp(name, "right") != 0 && strcmp(name, "wrong") != 0 && count > 0)
            sum += (size_t)count;
    }
    return sum;
}

static void put_key(struct html *html)
{
    static const char *const key[][2] = {
        {"key good", "agrees: every answer is right or in an allowed class"},
        {"key pub",
         "a member as published, with its faults: wrong answers are counted, not judged"},
        {"key bad", "WRONG, other bits than engine cpu's, or failed"},
        {"key none", "refused or skipped; the reason is below"}};
    html_begin(html, "p", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(key); i++) {
        html_element(html, "span", key[i][0], "");
        html_text(html, key[i][1]);
    }
    html_end(html, "p");
}

static void put_facts(struct html *html, const json_t *scene, const struct check_rows *rows)
{
    html_begin(html, "p", "class", "dim", NULL);
    html_format(html, "%s, %s; %s of set %s", COUNTED(value_count(scene, "triangles"), "triangle"),
                COUNTED(value_count(scene, "vertices"), "vertex"),
                COUNTED(value_count(scene, "count"), "ray"), value_text(scene, "rays"));
    for (size_t i = 0; i < rows->count; i++) {
        const json_t *tree = json_object_get(rows->row[i], "tree");
        if (!value_text(rows->row[i], "layout")[0] || value_count(tree, "nodes") == 0)
            continue;
        html_format(html, "; tree by builder %s: %s, %s, depth %zu",
                    value_text(rows->row[i], "builder"),
                    COUNTED(value_count(tree, "nodes"), "node"),
                    COUNTED(value_count(tree, "leaves"), "leaf"), value_count(tree, "depth"));
        break;
    }
    html_end(html, "p");
}

/* Prints each reason once. */
static void put_reasons(struct html *html, const struct check_rows *rows)
{
    for (size_t i = 0; i < rows->count; i++) {
        const char *reason = value_text(rows->row[i], "reason");
        bool seen = !reason[0];
        for (size_t k = 0; k < i && !seen; k++)
            seen = strcmp(value_text(rows->row[k], "reason"), reason) == 0;
        if (seen)
            continue;
        const char *engine = value_text(rows->row[i], "engine");
        html_element_format(html, "p", "note", "%s %s: %s",
                            engine[0] ? engine : value_text(rows->row[i], "layout"),
                            value_text(rows->row[i], "status"), reason);
    }
}

static void put_scene(struct html *html, const json_t *scene, const json_t *all)
{
    const char *name = value_text(scene, "scene");
    struct check_rows rows = {.scene = name};
    const json_t **row = alloc_zeroed(json_array_size(all), sizeof *row);
    for (size_t i = 0; i < json_array_size(all) && row && rows.count < ROWS_MOST; i++)
        if (strcmp(value_text(json_array_get(all, i), "scene"), name) == 0)
            row[rows.count++] = json_array_get(all, i);
    rows.row = row;
    html_begin(html, "div", "class", "scene", NULL);
    html_element(html, "h3", NULL, name);
    if (rows.count == 0) {
        html_element(html, "p", "note bad",
                     "Nothing was played on this scene; what raydiff check said stands at its part "
                     "in the verdict.");
    } else {
        put_facts(html, scene, &rows);
        report_matrix(html, &rows);
        put_reasons(html, &rows);
        report_verdicts(html, &rows);
    }
    html_end(html, "div");
    free(row);
}

/* True if the scene was listed before. A repeated scene shows all its rows at the first place. */
static bool is_repeated(const json_t *scenes, size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (value_same(json_array_get(scenes, k), json_array_get(scenes, i), "scene"))
            return true;
    return false;
}

void report_agreement(struct html *html, const struct report *report)
{
    section_begin(html, "agreement", "2 Agreement");
    bool any = section_reasons(html, report, REPORT_CHECK,
                               "raydiff report SCENE... plays engines and layouts on scenes; "
                               "--check FILE takes what raydiff check --json wrote.");
    if (any) {
        html_element(html, "p", NULL,
                     "Every answer is judged alone against the exact truth and the proven error of "
                     "that engine's own formula; engines that compute as cpu does are compared "
                     "with it to the bit, too.");
        put_key(html);
    }
    html_begin(html, "div", "class", "scenes", NULL);
    for (size_t p = 0; p < report->part_count; p++) {
        const json_t *json = report->part[p].json, *scenes = json_object_get(json, "scenes");
        size_t count = report->part[p].kind == REPORT_CHECK ? json_array_size(scenes) : 0;
        for (size_t i = 0; i < count && i < SCENES_MOST; i++)
            if (!is_repeated(scenes, i))
                put_scene(html, json_array_get(scenes, i), json_object_get(json, "rows"));
        if (count > SCENES_MOST)
            html_element_format(html, "p", "note", "Only the first %u scenes are shown.",
                                SCENES_MOST);
    }
    html_end(html, "div");
    section_end(html);
}
