/* Section 4: pictures beside their difference maps. */
#define _POSIX_C_SOURCE 200809L /* strdup */
#include "bench/report/report_inner.h"

#include "ref/files/file.h"
#include "scenes/picture/image.h"

#include <stdlib.h>
#include <string.h>

/* Part of the file for pictures in base64; the rest is for tables and figures. */
#define PICTURE_BYTES_MOST (REPORT_BYTES_MOST / 5 * 4)

#define PAIRS_MOST 64u /* per part */

static size_t base64_size(size_t bytes)
{
    return (bytes + 2) / 3 * 4;
}

/* Reads a picture and decodes it once, so that the page contains no broken picture. */
static enum status look(const char *path, struct report_picture *picture, struct reason *reason)
{
    struct image image = {0};
    enum status status = image_read(path, &image, reason);
    picture->width = image.width;
    picture->height = image.height;
    image_free(&image);
    return status;
}

enum status report_add_picture(struct report *report, const char *group, const char *title,
                               const char *caption, const char *path, struct reason *reason)
{
    struct report_picture picture = {0};
    void *array = report->picture;
    char *bytes = NULL;
    size_t used = 0;
    for (size_t i = 0; i < report->picture_count; i++)
        used += base64_size(report->picture[i].size);
    report->wanted[REPORT_PICTURES] = true;
    enum status status = look(path, &picture, reason);
    if (status == STATUS_OK)
        status = file_read(path, &bytes, &picture.size, reason);
    if (status == STATUS_OK && used + base64_size(picture.size) > PICTURE_BYTES_MOST)
        status = fail(reason, STATUS_INPUT,
                      "%s: with it the report's pictures would be larger than %u bytes",
                      file_label(path), PICTURE_BYTES_MOST);
    picture.png = (unsigned char *)bytes;
    if (status == STATUS_OK) {
        picture.group = strdup(group);
        picture.title = strdup(title);
        picture.caption = strdup(caption);
        if (!picture.group || !picture.title || !picture.caption ||
            array_reserve(&array, &report->picture_capacity, report->picture_count + 1,
                          sizeof picture))
            status = fail(reason, STATUS_MEMORY, "no memory for %s", file_label(path));
    }
    if (status) {
        report_picture_free(&picture);
        return status;
    }
    report->picture = array;
    report->picture[report->picture_count++] = picture;
    return STATUS_OK;
}

static void put_picture(struct html *html, const struct report_picture *picture)
{
    html_begin(html, "figure", NULL);
    html_png(html, picture->title, picture->width, picture->height, picture->png, picture->size);
    html_begin(html, "figcaption", NULL);
    html_element(html, "b", NULL, picture->title);
    if (picture->caption[0]) {
        html_void(html, "br", NULL);
        html_text(html, picture->caption);
    }
    html_end(html, "figcaption");
    html_end(html, "figure");
}

/* Prints why pixels of one engine differ from another's. */
static void put_pair(struct html *html, const char *scene, const json_t *pair)
{
    static const char *const whys[] = {"rounding", "allowed", "drift", "published"};
    static const char *const faults[] = {"wrong", "renderer", "unexplained"};
    const json_t *why = json_object_get(pair, "why");
    bool agrees = value_bool(pair, "agrees");
    size_t bad = 0;
    html_begin(html, "tr", NULL);
    html_element(html, "th", NULL, scene);
    html_element_format(html, "td", NULL, "%s against %s", value_text(pair, "engine"),
                        value_text(pair, "reference"));
    html_element(html, "td", NULL,
                 value_bool(pair, "same_bits_demanded") ? "the same bits" : "an explanation");
    html_element_format(html, "td", "n", "%zu", value_count(pair, "paths_different"));
    html_element_format(html, "td", "n", "%zu", value_count(pair, "values_different"));
    for (size_t i = 0; i < ARRAY_COUNT(whys); i++)
        html_element_format(html, "td", "n", "%zu", value_count(why, whys[i]));
    for (size_t i = 0; i < ARRAY_COUNT(faults); i++)
        bad += value_count(why, faults[i]);
    bad += value_count(pair, "beyond_the_bound");
    html_element_format(html, "td", bad ? "n bad" : "n z", "%zu", bad);
    html_element(html, "td", agrees ? "good" : "bad", agrees ? "as it should be" : "NOT so");
    html_end(html, "tr");
}

static void put_pairs_head(struct html *html)
{
    html_table(html, NULL,
               "Each path compared, each difference explained by the exact truth; drift: both "
               "answers are right for their own, differing rays.");
    html_heads(html, "scene;engines;demanded;#paths differ;#pixels;#rounding;#allowed;#drift;"
                     "#as published;#faults;verdict");
    html_body(html);
}

static void put_pairs(struct html *html, const struct report *report)
{
    bool begun = false;
    for (size_t p = 0; p < report->part_count; p++) {
        const json_t *json = report->part[p].json, *pairs = json_object_get(json, "pairs");
        size_t count = report->part[p].kind == REPORT_PICTURES ? json_array_size(pairs) : 0;
        for (size_t i = 0; i < count && i < PAIRS_MOST; i++) {
            if (!begun)
                put_pairs_head(html);
            begun = true;
            put_pair(html, value_text(json, "scene"), json_array_get(pairs, i));
        }
    }
    if (begun)
        html_table_end(html);
}

void report_pictures(struct html *html, const struct report *report)
{
    section_begin(html, "pictures", "4 Pictures");
    section_reasons(html, report, REPORT_PICTURES,
                    "raydiff report SCENE... draws its first scenes; --picture TITLE=FILE.png "
                    "takes an existing picture.");
    if (report->wanted[REPORT_PICTURES] && report->picture_count == 0)
        html_element(html, "p", "note bad", "There is no picture.");
    put_pairs(html, report);
    const char *group = NULL;
    for (size_t i = 0; i < report->picture_count; i++) {
        const struct report_picture *picture = &report->picture[i];
        if (!group || strcmp(group, picture->group) != 0) {
            if (group)
                html_end(html, "div");
            group = picture->group;
            if (group[0])
                html_element(html, "h3", NULL, group);
            html_begin(html, "div", "class", "pictures", NULL);
        }
        put_picture(html, picture);
    }
    if (group)
        html_end(html, "div");
    section_end(html);
}
