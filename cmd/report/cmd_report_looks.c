/* The pictures of a report in false colours: boxes tested, inflation, verdicts. */
#include "cmd/report/cmd_report_gallery.h"

#include "bench/chart/json_value.h"
#include "ref/base/command.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

/* The values shown, of one layout or as the difference of the second to the first. */
static const struct {
    const char *what, *title;
    bool both;
} looks[] = {{"boxes", "boxes tested", false},
             {"boxes", "boxes tested", true},
             {"triangles", "triangles tested", false},
             {"inflation", "inflation of boxes by their quantisation", true},
             {"error", "error of t over its proven bound", false},
             {"class", "verdict of the judge", false}};

/* Writes a caption such as "mean 13.5, most 23", or the counts of verdicts. */
static void show_caption(const json_t *json, char *caption, size_t caption_bytes)
{
    const json_t *layer = json_array_get(json_object_get(json, "layers"), 0);
    const json_t *difference = json_object_get(json, "difference");
    const json_t *values = json_object_get(difference ? difference : layer, "values");
    const char *name, *comma = "";
    json_t *value;
    caption[0] = '\0';
    if (json_is_object(values))
        snprintf(caption, caption_bytes, "least %.4g, mean %.4g, 99 %% %.4g, most %.4g",
                 value_number(values, "least"), value_number(values, "mean"),
                 value_number(values, "p99"), value_number(values, "most"));
    json_object_foreach(json_object_get(layer, "verdicts"), name, value)
    {
        size_t used = strlen(caption);
        if (json_integer_value(value) <= 0)
            continue;
        snprintf(caption + used, caption_bytes - used, "%s%s %lld", comma, name,
                 (long long)json_integer_value(value));
        comma = ", ";
    }
}

/* Reads the JSON file written by our own child. */
static enum status read_statistics(const char *path, json_t **json, struct reason *reason)
{
    char *bytes;
    size_t size;
    *json = NULL;
    enum status status = file_read(path, &bytes, &size, reason);
    if (status)
        return status;
    *json = json_loadb(bytes, size, 0, NULL);
    free(bytes);
    return *json ? STATUS_OK : fail(reason, STATUS_INPUT, "%s: is no JSON", file_label(path));
}

/* Draws look `i` of "A" or a pair "A,B". A refusal by a layout that the user did not name is not
 * counted as a failure. */
static enum status look_at(struct gallery *gallery, size_t i, const char *pair,
                           struct reason *reason)
{
    char name[NAME_BYTES], title[2 * NAME_BYTES], caption[240], path[4096];
    struct run how;
    struct line line;
    const char *comma = strchr(pair, ',');
    snprintf(title, sizeof title, "show-%s-%.30s", looks[i].what, pair);
    gallery_file_name(gallery, title, name);
    gallery_line(gallery, "render", &line);
    report_option(&line, "--show", looks[i].what);
    report_option(&line, "--layout", pair);
    enum status status =
        gallery_run(gallery, cmd_render, &line, false, name, "show.json", &how, reason);
    if (status || gallery->stopped)
        return status;
    if (comma)
        snprintf(title, sizeof title, "%s, %.30s less %.*s", looks[i].title, comma + 1,
                 (int)(comma - pair), pair);
    else
        snprintf(title, sizeof title, "%s, %.30s", looks[i].title, pair);
    struct reason why;
    json_t *json;
    runner_path(gallery->runner, "show.json", path, sizeof path);
    status = read_statistics(path, &json, &why);
    if (json) {
        show_caption(json, caption, sizeof caption);
        gallery_show(gallery, title, caption, name, how.said);
    } else if (how.code == EXIT_AGREE) {
        gallery_unread(gallery, title, how.said, status, &why);
    } else {
        gallery_complain(gallery, title, how.said);
    }
    if (!(how.code == EXIT_USAGE && !report_passed(gallery->options, TO_ALL, "--layout")))
        gallery->code = exit_worse(gallery->code, how.code);
    json_decref(json);
    return STATUS_OK;
}

/* Chooses the first two layouts that the user named, by default f32 and rf16. */
static void choose_layouts(const struct report_options *options, char first[LAYOUT_BYTES],
                           char second[LAYOUT_BYTES])
{
    const char *named = gallery_named(options, "--layout", "f32,rf16");
    size_t length = strcspn(named, ",");
    snprintf(first, LAYOUT_BYTES, "%.*s", (int)length, named);
    named += length + (named[length] == ',');
    snprintf(second, LAYOUT_BYTES, "%.*s", (int)strcspn(named, ","), named);
}

enum status gallery_look_at_tree(struct gallery *gallery, struct reason *reason)
{
    char first[LAYOUT_BYTES], second[LAYOUT_BYTES], both[2 * LAYOUT_BYTES];
    enum status status = STATUS_OK;
    choose_layouts(gallery->options, first, second);
    snprintf(both, sizeof both, "%s,%s", first, second);
    snprintf(gallery->group, sizeof gallery->group, "%.150s, in false colours",
             gallery_scene(gallery));
    for (size_t i = 0; i < ARRAY_COUNT(looks) && !status && !gallery->stopped; i++)
        if (!looks[i].both || second[0])
            status = look_at(gallery, i, looks[i].both ? both : first, reason);
    return status;
}
