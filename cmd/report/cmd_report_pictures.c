/* The pictures of a report: a scene drawn by several engines, and the differences of each to the
 * first. */
#define _POSIX_C_SOURCE 200809L /* strtok_r */
#include "cmd/report/cmd_report_gallery.h"

#include "bench/chart/json_value.h"
#include "ref/base/command.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

#define ENGINES_MOST 8

const char *gallery_scene(const struct gallery *gallery)
{
    return gallery->options->scene[gallery->scene];
}

const char *gallery_named(const struct report_options *options, const char *flag, const char *own)
{
    const char *named = report_passed(options, TO_ALL, flag);
    return named && strcmp(named, "all") != 0 ? named : own;
}

static void add_line(char *text, size_t text_bytes, const char *line)
{
    size_t used = strlen(text);
    snprintf(text + used, text_bytes - used, "%s%s", used ? "\n" : "", line);
}

void gallery_complain(struct gallery *gallery, const char *who, const char *what)
{
    char line[RUN_SAID_MOST + NAME_BYTES];
    const char *last = strrchr(what, '\n'); /* notes stand before what ended it */
    snprintf(line, sizeof line, "%s: %s", who, last ? last + 1 : what);
    add_line(gallery->why, sizeof gallery->why, line);
}

void gallery_file_name(const struct gallery *gallery, const char *what, char name[NAME_BYTES])
{
    snprintf(name, NAME_BYTES, "%zu-%.40s.png", gallery->scene, what);
    for (char *at = name; *at; at++)
        if (*at == '/' || *at == ' ' || *at == ':')
            *at = '-';
}

void gallery_unread(struct gallery *gallery, const char *who, const char *said, enum status status,
                    const struct reason *why)
{
    gallery_complain(gallery, who, said[0] ? said : why->text);
    gallery->code = exit_worse(gallery->code, exit_of_status(status));
}

void gallery_show(struct gallery *gallery, const char *title, const char *caption, const char *name,
                  const char *said)
{
    char path[4096];
    struct reason why;
    runner_path(gallery->runner, name, path, sizeof path);
    enum status status =
        report_add_picture(gallery->report, gallery->group, title, caption, path, &why);
    if (status == STATUS_OK)
        gallery->drawn = true;
    else
        gallery_unread(gallery, title, said, status, &why);
}

/* Passes the first of each kind of member that the user named, for commands that take one. */
static void pass_members(struct line *line, const struct report_options *options, bool layout)
{
    for (size_t i = 0; i < options->passed_count; i++) {
        const struct passed *passed = &options->passed[i];
        char name[LAYOUT_BYTES];
        bool test = strcmp(passed->flag, "--box") == 0 || strcmp(passed->flag, "--tri") == 0;
        snprintf(name, sizeof name, "%.*s", (int)strcspn(passed->value, ","), passed->value);
        if (strcmp(name, "all") == 0 ||
            !report_line_uses(line, options, TO_OTHERS | TO_PICTURES, passed->flag))
            continue;
        if (test)
            report_option(line, passed->flag, name);
        else if (layout && strcmp(passed->flag, "--layout") == 0)
            report_layout(line, name);
    }
    report_pass_on(line, options, TO_OTHERS | TO_PICTURES);
}

void gallery_line(const struct gallery *gallery, const char *command, struct line *line)
{
    line_begin(line, command);
    line_word(line, gallery_scene(gallery));
}

enum status gallery_run(struct gallery *gallery, command_fn *command, struct line *line,
                        bool layout, const char *name, const char *json, struct run *run,
                        struct reason *reason)
{
    report_option(line, "-w", "256");
    report_option(line, "-h", "192");
    pass_members(line, gallery->options, layout);
    line_word(line, "--out");
    line_file(line, gallery->runner, name);
    if (json) {
        char path[4096];
        line_word(line, "--json");
        line_file(line, gallery->runner, json);
        runner_path(gallery->runner, json, path, sizeof path);
        remove(path);
    }
    enum status status = runner_run(gallery->runner, command, line, run, reason);
    gallery->seconds += run->seconds;
    gallery->stopped = gallery->stopped || run->stopped;
    add_line(gallery->commands, sizeof gallery->commands, line->text);
    line_free(line);
    return status;
}

/* Draws the scene. *there is set if there is a picture. */
static enum status draw(struct gallery *gallery, const char *engine, bool *there,
                        struct reason *reason)
{
    char name[NAME_BYTES], title[NAME_BYTES];
    struct run how;
    struct line line;
    gallery_file_name(gallery, engine, name);
    snprintf(title, sizeof title, "%.60s", engine);
    gallery_line(gallery, "render", &line);
    report_option(&line, "--engine", engine);
    *there = false;
    enum status status = gallery_run(gallery, cmd_render, &line, true, name, NULL, &how, reason);
    if (status || gallery->stopped)
        return status;
    if (how.code == EXIT_SKIPPED && !gallery->named) {
        gallery_complain(gallery, engine, how.said); /* unnamed engines may be missing */
        return STATUS_OK;
    }
    gallery->code = exit_worse(gallery->code, how.code);
    *there = how.code == EXIT_AGREE;
    if (*there)
        gallery_show(gallery, title, "", name, how.said);
    else
        gallery_complain(gallery, engine, how.said);
    return STATUS_OK;
}

/* Writes a caption such as "126 of 49152 pixels differ, at most by 255; every difference is
 * explained". */
static void caption_of(const json_t *pair, char *caption, size_t caption_bytes)
{
    size_t different = value_count(pair, "values_different");
    if (value_count(pair, "paths_different") + different == 0)
        snprintf(caption, caption_bytes, "all %zu paths and pixels are the same",
                 value_count(pair, "paths"));
    else
        snprintf(caption, caption_bytes, "%zu of %zu pixels differ, at most by %zu of 255; %s",
                 different, value_count(pair, "paths"), value_count(pair, "largest"),
                 value_bool(pair, "agrees") ? "every difference is explained"
                                            : "NOT every difference is allowed");
}

/* Adds the heat maps of raydiff diff, one for each engine except the first. */
static void show_maps(struct gallery *gallery, const json_t *pairs, const char *said)
{
    char name[NAME_BYTES], title[2 * NAME_BYTES], caption[200];
    for (size_t i = 0; i < json_array_size(pairs); i++) {
        const json_t *pair = json_array_get(pairs, i);
        const char *engine = value_text(pair, "engine");
        snprintf(name, sizeof name, "%zu-diff%s%.60s.png", gallery->scene,
                 json_array_size(pairs) > 1 ? "-" : "", json_array_size(pairs) > 1 ? engine : "");
        snprintf(title, sizeof title, "%.60s against %.60s", engine, value_text(pair, "reference"));
        caption_of(pair, caption, sizeof caption);
        gallery_show(gallery, title, caption, name, said);
    }
}

/* Compares the engines' pictures path by path. */
static enum status compare(struct gallery *gallery, const char *const *engine, size_t count,
                           struct reason *reason)
{
    char names[ENGINES_MOST * NAME_BYTES] = "", name[NAME_BYTES], path[4096];
    struct run how;
    struct line line;
    for (size_t i = 0; i < count; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", i ? "," : "", engine[i]);
    }
    snprintf(name, sizeof name, "%zu-diff.png", gallery->scene);
    gallery_line(gallery, "diff", &line);
    report_option(&line, "--engine", names);
    enum status status =
        gallery_run(gallery, cmd_diff, &line, true, name, "diff.json", &how, reason);
    if (status || gallery->stopped)
        return status;
    gallery->code = exit_worse(gallery->code, how.code);
    struct reason why;
    runner_path(gallery->runner, "diff.json", path, sizeof path);
    status = report_read(path, REPORT_PICTURES, &gallery->pairs, &why);
    if (status == STATUS_OK)
        show_maps(gallery, json_object_get(gallery->pairs, "pairs"), how.said);
    else
        gallery_unread(gallery, "diff", how.said, status, &why);
    return STATUS_OK;
}

/* --- all ---------------------------------------------------------------------------------- */

/* Chooses the engines that draw: those of --engine, or the reference and engines independent of
 * it. */
static size_t choose_engines(const struct report_options *options, char *text, size_t text_bytes,
                             const char *engine[ENGINES_MOST])
{
    char *rest = NULL;
    size_t count = 0;
    snprintf(text, text_bytes, "%s",
             gallery_named(options, "--engine", "cpu,vulkan,embree_robust,embree"));
    for (char *at = strtok_r(text, ",", &rest); at && count < ENGINES_MOST;
         at = strtok_r(NULL, ",", &rest))
        engine[count++] = at;
    return count;
}

/* Adds the picture of each engine, then the differences of each to the first one that could
 * draw. */
static enum status make_scene(struct gallery *gallery, const char *const *engine, size_t count,
                              struct reason *reason)
{
    const char *there[ENGINES_MOST];
    size_t drawn = 0;
    enum status status = STATUS_OK;
    snprintf(gallery->group, sizeof gallery->group, "%.150s, drawn by each engine",
             gallery_scene(gallery));
    for (size_t i = 0; i < count && !status && !gallery->stopped; i++) {
        bool is_there;
        status = draw(gallery, engine[i], &is_there, reason);
        if (is_there)
            there[drawn++] = engine[i];
    }
    snprintf(gallery->group, sizeof gallery->group, "%.150s, differences", gallery_scene(gallery));
    if (drawn > 1 && !status && !gallery->stopped)
        status = compare(gallery, there, drawn, reason);
    if (!status && !gallery->stopped)
        status = gallery_look_at_tree(gallery, reason);
    return status;
}

enum status report_make_pictures(const struct report_options *options, struct runner *runner,
                                 struct report *report, struct reason *reason)
{
    char text[512], name[300];
    const char *engine[ENGINES_MOST];
    size_t count = choose_engines(options, text, sizeof text, engine);
    size_t scenes = options->quick ? 1 : PICTURE_SCENES;
    enum status status = STATUS_OK;
    for (size_t s = 0; s < options->scene_count && s < scenes && !status; s++) {
        struct gallery gallery = {.options = options,
                                  .runner = runner,
                                  .report = report,
                                  .scene = s,
                                  .named = report_passed(options, TO_ALL, "--engine") != NULL};
        status = make_scene(&gallery, engine, count, reason);
        if (status || gallery.stopped) {
            json_decref(gallery.pairs);
            break;
        }
        snprintf(name, sizeof name, "pictures of %.200s", options->scene[s]);
        struct report_part part = {.kind = REPORT_PICTURES,
                                   .state = gallery.drawn ? REPORT_RAN : REPORT_FAILED,
                                   .name = name,
                                   .command = gallery.commands,
                                   .why = gallery.why,
                                   .json = gallery.pairs,
                                   .code = gallery.code,
                                   .seconds = gallery.seconds};
        if (!gallery.drawn && gallery.code == EXIT_SKIPPED)
            part.state = REPORT_SKIPPED;
        status = report_add(report, &part, reason);
    }
    return status;
}
