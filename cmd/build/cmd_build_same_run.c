/* raydiff build --same over scenes. */
#include "cmd/build/cmd_build.h"
#include "cmd/build/cmd_build_same.h"

#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_progress.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "scenes/scenes.h"

#include <stdlib.h>

/* What was named, or all that build in C, and its tables. */
struct same_members {
    const struct builder *builder[LIST_MOST];
    const struct layout *layout[SAME_LAYOUTS_MOST];
    struct same_job job;
};

static void choose(const struct build_command *b, struct same_members *out)
{
    struct same_job *job = &out->job;
    *job = (struct same_job){
        .builder = out->builder, .layout = out->layout, .rounds = b->same, .seed = b->seed};
    for (size_t i = 0; i < b->builder.count; i++)
        out->builder[job->builder_count++] = builders_all[b->builder.index[i]];
    for (size_t i = 0; builders_all[i] && b->builder.count == 0; i++)
        if (!builders_all[i]->compare)
            out->builder[job->builder_count++] = builders_all[i];
    for (size_t i = 0; i < b->layout.count && i < SAME_LAYOUTS_MOST; i++)
        out->layout[job->layout_count++] = layouts_all[b->layout.index[i]];
}

int same_code(const struct same_row *row, size_t rows, const struct same_engine *engine,
              size_t count)
{
    int code = EXIT_AGREE;
    for (size_t i = 0; i < rows; i++)
        code = row[i].differing ? EXIT_MISMATCH : code;
    for (size_t i = 0; i < count; i++)
        code = engine[i].wrong ? EXIT_MISMATCH : code;
    return code;
}

static enum status play(const struct same_job *job, const char *spec, const struct screen *screen,
                        struct progress *progress, json_t *all, int *code, struct reason *reason)
{
    struct scene scene;
    struct same_engine engine[SAME_ENGINES_MOST];
    size_t engine_count = 0, rows = job->builder_count * (1 + job->layout_count);
    struct same_row *row = alloc_zeroed(rows, sizeof *row);
    if (!row)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rows", rows);
    progress_step(progress, "%s", spec);
    enum status status = scene_open(spec, job->seed, &scene, reason);
    if (status) {
        free(row);
        return status;
    }
    status = same_play(job, &scene, row, reason);
    if (!status)
        status = same_engines(job, &scene, engine, &engine_count, reason);
    progress_end(progress);
    if (!status) {
        screen_text(screen, "%s: %s; each built %u times with 1, 2, 8 and 16 threads\n", spec,
                    COUNTED(scene.tri_count, "triangle"), job->rounds);
        same_print(row, rows, screen);
        same_print_engines(engine, engine_count, screen);
        json_array_append_new(all, same_json(spec, row, rows, engine, engine_count));
        *code = exit_worse(*code, same_code(row, rows, engine, engine_count));
    }
    scene_free(&scene);
    free(row);
    return status;
}

int same_run(const struct build_command *b, char *const *spec, size_t count)
{
    struct same_members members;
    const struct screen screen = screen_make(&b->screen);
    struct progress progress = progress_make("build");
    struct reason reason = {""};
    json_t *all = json_array();
    int code = EXIT_AGREE;
    choose(b, &members);
    for (size_t i = 0; i < count; i++) {
        enum status status = play(&members.job, spec[i], &screen, &progress, all, &code, &reason);
        code = exit_worse(code, exit_with_reason("build", status, &reason));
    }
    json_t *root = json_record("raydiff=%s exit=%d same=%p", RAYDIFF_VERSION, code, all);
    if (!b->json) {
        json_decref(root);
        return code;
    }
    return exit_worse(code,
                      exit_with_reason("build", json_write(b->json, root, 9, &reason), &reason));
}
