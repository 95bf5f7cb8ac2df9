/* Section 4: pictures beside their difference maps. */
#define _POSIX_C_SOURCE 200809L /* strdup */
#include "bench/report_inner.h"

#include "ref/mutant.h"
#include "scenes/file.h"
#include "scenes/image.h"

#include <stdlib.h>
#include <string.h>

/* Of the file, for pictures as base64; the rest is for tables and figures. */
#define PICTURE_BYTES_MOST (REPORT_BYTES_MOST / 5 * 4)

static size_t base64_size(size_t bytes)
{
    return (bytes + 2) / 3 * 4;
}

/* Every picture is decoded once, so that none can be broken in the page. */
static enum status look(const char *path, struct report_picture *picture, struct reason *reason)
{
    struct image image = {0};
    if (MUTANT == MUTANT_PICTURE_BELIEVED) {
        picture->width = picture->height = 1;
        return STATUS_OK;
    }
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
        free(picture.group);
        free(picture.title);
        free(picture.caption);
        free(picture.png);
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

void report_pictures(struct html *html, const struct report *report)
{
    section_begin(html, "pictures", "4 Pictures");
    section_reasons(html, report, REPORT_PICTURES,
                    "raydiff report SCENE... draws its first scenes; --picture TITLE=FILE.png "
                    "takes a picture that is there.");
    if (report->wanted[REPORT_PICTURES] && report->picture_count == 0)
        html_element(html, "p", "note bad", "There is no picture.");
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
