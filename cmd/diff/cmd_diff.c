/* raydiff diff: compares two pictures, or engines that draw the same one. */
#include "cmd/diff/cmd_diff.h"

#include "cmd/common/cmd_use.h"
#include "cmd/common/cmd_progress.h"
#include "ref/base/command.h"
#include "scenes/picture/image_diff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool ends_in_png(const char *text)
{
    size_t length = strlen(text);
    return length > 4 && strcmp(text + length - 4, ".png") == 0;
}

/* True if an argument is a picture, and not an option's value. */
static bool is_of_pictures(int argc, char **argv)
{
    bool behind = false; /* "--", behind which nothing is an option */
    for (int i = 1; i < argc; i++) {
        if (ends_in_png(argv[i]) && (behind || (argv[i][0] != '-' && argv[i - 1][0] != '-')))
            return true;
        behind = behind || strcmp(argv[i], "--") == 0;
    }
    return false;
}

static enum status take_pixel(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct diff_options *o = options;
    const char *text = given->text;
    char x[16];
    const char *comma = strchr(text, ',');
    uint64_t value[2] = {0, 0};
    if (!comma || (size_t)(comma - text) >= sizeof x)
        return fail(reason, STATUS_INPUT, "--pixel: '%s' is not X,Y", text);
    snprintf(x, sizeof x, "%.*s", (int)(comma - text), text);
    enum status status = parse_count("--pixel", x, 0, FRAME_SIDE_MOST - 1, &value[0], reason);
    if (!status)
        status = parse_count("--pixel", comma + 1, 0, FRAME_SIDE_MOST - 1, &value[1], reason);
    o->has_pixel = true;
    o->x = (uint32_t)value[0];
    o->y = (uint32_t)value[1];
    return status;
}

#define ROWS_OF struct diff_options

static const struct option_row rows[] = {
    {"engine", "A,B,..", "compared with the first", OF_LIST(engine, TABLE_ENGINES),
     .shown = "cpu,vulkan,embree: those that run here"},
    {"pixel", "X,Y", "the path of one pixel on every engine, to the first bit that differs",
     OF_OWN(take_pixel)},
    {"angle", "DEG", "of the camera around its target", OF_REAL(angle, -INFINITY, INFINITY),
     .value = "0"},
    {"list", "N", "pixels listed of each kind", OF_COUNT(list, 0, PAIR_KEPT), .value = "4"},
    {"out", "HEAT.png", "a heat map of the values; of several engines HEAT-ENGINE.png",
     OF_OUTPUT(out)},
    {"json", "FILE", "everything, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "diff",
    .usage = "diff [SCENE] [--engine A,B,..] [OPTIONS]\n"
             "diff A.png B.png [OPTIONS]            (raydiff diff A.png --help)",
    .about = "Draws a scene by several engines and compares every path: what each segment hits, t "
             "to the bit, which lights are in a shadow, and the 8-bit values. Engines that compute "
             "the same bits must have the same paths. Where others differ each pixel is "
             "explained: its path is followed to the first hit or shadow that differs, and each "
             "engine's own answer to its own ray is judged against the exact truth.",
    .group = {GROUP(rows), GROUP_AT(render_rows, settings), GROUP_AT(build_rows, settings.build),
              GROUP_AT(engine_rows, settings.engine_options),
              GROUP_AT(outside_rows, settings.engine_options)},
    .codes = "0 as it should be, 1 a difference that is not, or no path hits, 2 bad input, 3 an "
             "engine did not finish, 4 no memory, 77 a named engine cannot run here",
    .example = "diff rtrs --engine cpu,vulkan,embree -w 96 -h 72\n"
               "diff rtrs --engine cpu,embree -w 96 -h 72 --pixel 40,24",
};

void diff_explain(const struct diff_run *run, const struct diff_member *member, bool shadow,
                  const struct ray *ray, char text[EXPLAIN_COMMAND_MOST])
{
    const struct render_settings *settings = &run->options->settings;
    bool packed = member->engine->needs_packed;
    bool any = shadow && settings->look.profile == PROFILE_REPAIRED;
    const struct explain_of of = {.spec = settings->scene,
                                  .seed = settings->seed,
                                  .engine = member->engine,
                                  .layout = packed ? run->stage.packed.layout : NULL,
                                  .builder = packed ? settings->builder : NULL,
                                  .build = settings->build,
                                  .tree = packed ? settings->bvh : NULL,
                                  .box = settings->box,
                                  .tri = settings->tri,
                                  .query = any ? QUERY_ANY : QUERY_CLOSEST,
                                  .driver = settings->engine_options.driver};
    explain_command(&of, ray, text);
}

/* Fills in defaults and checks the options. If any engine of the list needs a tree, it becomes
 * settings.engine, so that a tree is made. */
static enum status finish(struct diff_options *o, struct reason *reason)
{
    static char standard[] = "cpu,vulkan,embree";
    enum status status = STATUS_OK;
    if (!option_was_given("engine"))
        status = table_parse(TABLE_ENGINES, "--engine", standard, &o->engine, reason);
    if (!status)
        status = render_settings_finish("diff", &o->settings, reason);
    for (size_t i = 0; i < o->engine.count && !status; i++) {
        const struct engine *engine = engines[o->engine.index[i]];
        if (!status && engine->needs_packed)
            o->settings.engine = engine;
    }
    if (!status && o->settings.versus)
        status = fail(reason, STATUS_INPUT, "--layout: one, the same for all engines");
    if (!status && o->engine.count < 2 && !o->has_pixel)
        status = fail(reason, STATUS_INPUT, "--engine: two engines are compared, and more");
    if (!status && o->has_pixel && (o->x >= o->settings.width || o->y >= o->settings.height))
        status = fail(reason, STATUS_INPUT, "--pixel: %u,%u is not in a picture of %u x %u", o->x,
                      o->y, o->settings.width, o->settings.height);
    const struct option_use pixel = {.by = "--pixel", .never = o->has_pixel ? "out list" : ""};
    const struct option_use still = {.by = "diff, in which nothing orbits",
                                     .never = "camera-fixed camera-orbit"};
    if (!status)
        status = options_check(&pixel, reason);
    if (!status)
        status = options_check(&still, reason);
    return status ? status : render_options_check(&o->settings, &o->engine, reason);
}

static enum status open_member(struct diff_run *run, struct diff_member *member, size_t index,
                               struct reason *reason)
{
    const struct diff_options *o = run->options;
    struct frame_job job = run->stage.job;
    enum status status =
        render_engine(&o->settings, engines[o->engine.index[index]], &member->engine, reason);
    if (status)
        return status;
    job.job.packed = member->engine->needs_packed ? &run->stage.packed : NULL;
    member->status = side_open(member->engine, &o->settings.engine_options, &job, o->settings.waves,
                               &member->side, &member->reason);
    member->side.published = member->engine->needs_packed &&
                             (run->stage.packed.layout->faithful || o->settings.box->faithful ||
                              (!o->settings.bvh && o->settings.builder->faithful));
    if (member->status && member->status != STATUS_UNSUPPORTED)
        return fail(reason, member->status, "%s: %s", member->engine->name, member->reason.text);
    return STATUS_OK;
}

static enum status open_members(struct diff_run *run, struct reason *reason)
{
    size_t running = 0;
    for (size_t i = 0; i < run->options->engine.count; i++) {
        struct diff_member *member = &run->member[run->count++];
        enum status status = open_member(run, member, i, reason);
        if (status)
            return status;
        for (size_t k = 0; k + 1 < run->count; k++)
            if (run->member[k].engine == member->engine)
                return fail(reason, STATUS_INPUT, "--engine: %s is selected by two names",
                            member->engine->name);
        if (member->status == STATUS_OK && running++ == 0)
            run->reference = i;
    }
    for (size_t i = 0; i < run->count && running < 2 && !run->options->has_pixel; i++)
        if (run->member[i].status)
            return fail(reason, STATUS_UNSUPPORTED,
                        "fewer than two of the engines can run here: %s",
                        run->member[i].reason.text);
    return running ? STATUS_OK
                   : fail(reason, STATUS_UNSUPPORTED, "none of the engines can run here: %s",
                          run->member[0].reason.text);
}

static enum status compare_member(struct diff_run *run, struct diff_member *member,
                                  struct progress *progress, struct reason *reason)
{
    struct side *reference = &run->member[run->reference].side;
    size_t *pixel, count, batch = pair_batch(&run->stage.job);
    enum status status =
        pair_compare(reference, &member->side, &member->pair, &pixel, &count, reason);
    if (!status && count > 0 && !run->oracle)
        status = oracle_make(&run->stage.scene, &run->oracle, reason);
    for (size_t first = 0; first < count && !status; first += batch) {
        size_t part = count - first < batch ? count - first : batch;
        progress_step(progress, "%s: %zu of %zu pixels explained", member->engine->name, first,
                      count);
        status = pair_explain(reference, &member->side, &run->view, run->oracle, pixel + first,
                              part, &member->pair, reason);
    }
    free(pixel);
    return status;
}

static enum status draw_and_compare(struct diff_run *run, struct reason *reason)
{
    struct progress progress = progress_make("diff");
    enum status status = STATUS_OK;
    for (size_t i = run->reference; i < run->count && !status; i++) {
        struct diff_member *member = &run->member[i];
        struct reason why = {""};
        if (member->status)
            continue;
        progress_step(&progress, "%s draws", member->engine->name);
        status = side_draw(&member->side, &run->view, &why);
        if (!status && i != run->reference)
            status = compare_member(run, member, &progress, &why);
        if (status)
            fail(reason, status, "%s: %s", member->engine->name, why.text);
    }
    progress_end(&progress);
    return status;
}

/* Writes "HEAT.png", or "HEAT-ENGINE.png" if several pairs are compared. */
static void heat_path(const struct diff_run *run, const struct engine *engine, char *path,
                      size_t path_bytes)
{
    const char *out = run->options->out, *dot = strrchr(out, '.');
    size_t stem = dot && !strchr(dot, '/') ? (size_t)(dot - out) : strlen(out);
    size_t pairs = 0;
    for (size_t i = 0; i < run->count; i++)
        pairs += run->member[i].status == STATUS_OK;
    if (pairs <= 2)
        snprintf(path, path_bytes, "%s", out);
    else
        snprintf(path, path_bytes, "%.*s-%s%s", (int)stem, out, engine->name, out + stem);
}

static enum status write_heat(const struct diff_run *run, const struct diff_member *member,
                              struct reason *reason)
{
    const struct frame_job *job = &run->stage.job;
    const struct diff_member *reference = &run->member[run->reference];
    const struct image a = {job->width, job->height, reference->side.frame.pixel};
    const struct image b = {job->width, job->height, member->side.frame.pixel};
    char title[200], path[1024];
    struct image_diff diff;
    struct image heat = {0};
    struct colour_place place;
    heat_path(run, member->engine, path, sizeof path);
    snprintf(title, sizeof title, "%.90s: %s against %s", file_label(run->options->settings.scene),
             reference->engine->name, member->engine->name);
    enum status status = image_diff(&a, &b, &diff, reason);
    if (!status)
        status = image_diff_heat(&a, &b, &diff, title, &heat, &place, reason);
    if (!status)
        status = image_write(path, &heat, reason);
    if (!status)
        printf("heat map %s: pixel (x, y) is at (%u + %u x, %u + %u y)\n", path, place.x,
               place.zoom, place.y, place.zoom);
    image_free(&heat);
    return status;
}

/* The exit code of the findings. It is an error if a named engine does not run. */
static int exit_of(const struct diff_run *run)
{
    int code = EXIT_AGREE;
    for (size_t i = 0; i < run->count; i++) {
        const struct diff_member *member = &run->member[i];
        if (member->status && option_was_given("engine"))
            code = exit_worse(code, EXIT_SKIPPED);
        if (!member->status && i != run->reference && !run->options->has_pixel &&
            (!pair_agrees(&member->pair) || diff_is_vacuous(&member->pair)))
            code = exit_worse(code, EXIT_MISMATCH);
    }
    return code;
}

static enum status report(const struct diff_run *run, int *code, struct reason *reason)
{
    enum status status = STATUS_OK;
    *code = exit_worse(*code, exit_of(run));
    diff_print(run);
    for (size_t i = run->reference + 1; i < run->count && !status && run->options->out; i++)
        if (!run->member[i].status)
            status = write_heat(run, &run->member[i], reason);
    if (!status)
        diff_print_conclusion(run);
    if (!status && run->options->json)
        status = diff_write_json(run, *code, reason);
    return status;
}

static enum status play(struct diff_run *run, int *code, struct reason *reason)
{
    const struct diff_options *o = run->options;
    enum status status = output_try(o->out, reason);
    if (!status)
        status = render_stage_open("diff", &o->settings, &run->stage, reason);
    if (status)
        return status;
    run->view = render_stage_view(&run->stage, (double)o->angle * (acos(-1.0) / 180));
    status = open_members(run, reason);
    if (status)
        return status;
    if (o->has_pixel) {
        status = oracle_make(&run->stage.scene, &run->oracle, reason);
        if (!status)
            status = diff_pixel(run, code, reason);
        *code = exit_worse(*code, exit_of(run));
        return status;
    }
    status = draw_and_compare(run, reason);
    return status ? status : report(run, code, reason);
}

/* Writes the command line so that it can be typed again, without its outputs and --list. */
static void keep_command(int argc, char **argv, char *text, size_t text_bytes)
{
    static const char *const left_out[] = {"--out", "--json", "--list"};
    snprintf(text, text_bytes, "raydiff diff");
    for (int i = 1; i < argc; i++) {
        bool keep = true;
        for (size_t k = 0; k < ARRAY_COUNT(left_out) && keep; k++) {
            size_t length = strlen(left_out[k]);
            keep = strncmp(argv[i], left_out[k], length) != 0 ||
                   (argv[i][length] != '\0' && argv[i][length] != '=');
            i += !keep && argv[i][length] == '\0'; /* skip its value */
        }
        if (keep)
            command_word(text, text_bytes, argv[i]);
    }
}

static int diff_engines(int argc, char **argv)
{
    struct diff_options options = {.settings = render_settings_default()};
    struct diff_run *run = alloc_zeroed(1, sizeof *run);
    struct reason reason = {""};
    if (run)
        keep_command(argc, argv, run->command, sizeof run->command);
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code < 0 && first + 1 < argc)
        code = usage_error("diff", "unexpected argument '%s'", argv[first + 1]);
    if (code < 0 && first < argc && options.settings.scene)
        code = usage_error("diff", "'%s' and --path %s: one scene", argv[first],
                           options.settings.scene);
    if (code < 0 && first < argc)
        options.settings.scene = argv[first];
    if (code < 0 && finish(&options, &reason))
        code = usage_error("diff", "%s", reason.text);
    if (code >= 0 || !run) {
        free(run);
        return code >= 0 ? code : EXIT_INTERNAL;
    }
    run->options = &options;
    code = EXIT_AGREE;
    enum status status = play(run, &code, &reason);
    code = exit_worse(code, exit_with_reason("diff", status, &reason));
    for (size_t i = 0; i < run->count; i++) {
        walk_free(&run->member[i].walk);
        side_close(&run->member[i].side);
    }
    oracle_free(run->oracle);
    render_stage_close(&run->stage);
    free(run);
    return code;
}

int cmd_diff(int argc, char **argv)
{
    return is_of_pictures(argc, argv) ? cmd_diff_images(argc, argv) : diff_engines(argc, argv);
}
