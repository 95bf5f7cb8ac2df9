/* Reproduces the paper's tables, and adds fair comparisons. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/bench/cmd_bench_paper.h"

#include "ref/base/command.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char about[] =
    "Figure 8 (bytes, and the trees that give them; exit code 1 if those of the default "
    "scene are not the published 680, 2,448 and 656) and the performance table: direct "
    "against RF, 384 x 288, 4 bounces, workgroups of 16 x 16, on the default scene and "
    "on a teapot of as many triangles as the paper's. The published shader is drawn "
    "with its own look, builder, box test and triangle test, one ray of each path per "
    "invocation and dispatch and its arithmetic unchanged; the repaired one with "
    "layouts f32 and rf16. 200 frames over 5 turns; 9 over one turn where a frame of "
    "any line takes over 0.1 s. --driver hardware for a GPU. --out BASE: rows in "
    "BASE.csv and BASE.json, bytes against ms in BASE.svg, direct and RF over the "
    "frames in BASE-default and BASE-teapot .svg and .png.\n"
    "";

/* Adds two lights and the default red with some reflection; the default camera shows the whole
 * mesh. The paper's teapot scene has as many lights, but the paper does not give their places. */
static enum status furnish(struct scene *scene)
{
    struct box bounds = scene_bounds(scene);
    float size = 0;
    for (int k = 0; k < 3; k++)
        size = bounds.hi[k] - bounds.lo[k] > size ? bounds.hi[k] - bounds.lo[k] : size;
    scene->light = alloc_zeroed(2, sizeof *scene->light);
    scene->material = alloc_zeroed(1, sizeof *scene->material);
    if (!scene->light || !scene->material)
        return STATUS_MEMORY;
    scene->light_count = 2;
    scene->material_count = 1;
    scene->material[0] = (struct material){{0.5f, 0.1f, 0.1f}, {0.9f, 0.1f, 0.1f}, 10};
    scene->light[0].strength = 0.75f;
    scene->light[1].strength = 0.5f;
    for (int k = 0; k < 3; k++) {
        scene->light[0].pos[k] = bounds.hi[k] + (k == 1 ? 2 * size : size);
        scene->light[1].pos[k] = k == 1 ? bounds.hi[k] + size : bounds.lo[k] - size;
    }
    return STATUS_OK;
}

static const char *const paper_specs[PAPER_FIGURES] = {
    [PAPER_DEFAULT] = "rtrs", [PAPER_TEAPOT] = "scenes/fetched/utah-teapot.obj"};

enum status paper_scene_open(unsigned which, struct paper_scene *out, struct reason *reason)
{
    *out = (struct paper_scene){.spec = paper_specs[which],
                                .figure = &paper_figures[which],
                                .same = which == PAPER_DEFAULT};
    if (which == PAPER_TEAPOT && access(paper_specs[which], R_OK) != 0)
        return fail(reason, STATUS_UNSUPPORTED, "%s: left out, not fetched (make scenes)",
                    paper_specs[which]);
    enum status status = scene_open(paper_specs[which], 1, &out->scene, reason);
    if (!status && out->scene.light_count == 0) {
        out->furnished = true;
        status = furnish(&out->scene);
        if (status) {
            scene_free(&out->scene);
            return fail(reason, status, "%s: no memory for lights", paper_specs[which]);
        }
    }
    return status;
}

/* True for all scenes if the user named none, else for those named. */
static bool is_wanted(const struct bench *bench, unsigned which)
{
    for (size_t i = 0; i < bench->scene_count; i++)
        if (strcmp(bench->scene[i], paper_specs[which]) == 0)
            return true;
    return bench->scene_count == 0;
}

static size_t open_scenes(struct bench *bench, struct paper_scene scene[PAPER_FIGURES])
{
    size_t count = 0;
    for (unsigned i = 0; i < PAPER_FIGURES; i++) {
        struct reason reason = {""};
        if (!is_wanted(bench, i))
            continue;
        enum status status = paper_scene_open(i, &scene[count], &reason);
        if (status == STATUS_UNSUPPORTED)
            screen_text(&bench->screen_is, "%s\n", reason.text);
        else
            bench_failed(bench, NULL, status, &reason);
        count += status == STATUS_OK;
    }
    return count;
}

/* Measures and prints the performance table of a scene. *out is for the text and the plot at the
 * end; NULL without memory. */
static void measure_scene(struct bench *bench, const struct paper_scene *scene,
                          struct paper_table **out)
{
    struct reason reason = {""};
    struct paper_table *table = *out = calloc(1, sizeof *table);
    if (!table) {
        bench_worse(bench, EXIT_INTERNAL);
        return;
    }
    table->bench = bench;
    table->scene = scene;
    table->width = (uint32_t)bench->picture.width;
    table->height = (uint32_t)bench->picture.height;
    enum status status = paper_measure(table, &reason);
    progress_end(&bench->progress);
    paper_print_table(table);
    bench_failed(bench, scene->spec, status, &reason);
}

static int run(struct bench *bench)
{
    struct paper_scene scene[PAPER_FIGURES];
    struct paper_table *table[PAPER_FIGURES] = {NULL};
    size_t tables = 0;
    unsigned known = 0;
    for (unsigned i = 0; i < PAPER_FIGURES; i++)
        known += bench->scene_count > 0 && is_wanted(bench, i);
    if (known != bench->scene_count)
        return usage_error("bench", "--scene: the paper's are %s and %s",
                           paper_specs[PAPER_DEFAULT], paper_specs[PAPER_TEAPOT]);
    size_t count = open_scenes(bench, scene);
    paper_print_bytes(bench, scene, count);
    frames_catch_signals();
    for (size_t i = 0; i < count && !frames_signal_code(); i++)
        measure_scene(bench, &scene[i], &table[tables++]);
    struct reason reason = {""};
    enum status status = STATUS_OK;
    paper_print_words(table, tables);
    if (bench->svg_path)
        status = paper_write_plot(table, tables, bench->svg_path, &reason);
    for (size_t i = 0; i < tables && bench->picture.out && !status; i++)
        if (table[i])
            status = paper_write_chart(table[i], bench->picture.out, &reason);
    bench_failed(bench, NULL, status, &reason);
    for (size_t i = 0; i < tables; i++) {
        if (table[i])
            frames_session_free(&table[i]->session);
        free(table[i]);
    }
    for (size_t i = 0; i < count; i++)
        scene_free(&scene[i].scene);
    return frames_signal_code();
}

const struct benchmark bench_paper = {
    .name = "paper",
    .shown = "the bits of engine cpu, and the paper's bytes",
    .refuted = "other bits than engine cpu, or other bytes than the paper's",
    .summary = "the paper's tables: bytes of Figure 8, direct against RF; published and repaired",
    .takes = "scene csv json svg frames size out quick" BENCH_MACHINE BENCH_SCREEN,
    .about = about,
    .run = run,
    .alone = true,
    .rows_out = true,
};
