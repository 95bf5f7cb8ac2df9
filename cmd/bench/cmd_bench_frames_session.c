#include "cmd/bench/cmd_bench_frames.h"

#include "fuzz/findings/versions.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_grid.h"
#include "cmd/common/cmd_process.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

static volatile sig_atomic_t signalled;

void frames_catch_signals(void)
{
    process_signals_caught(&signalled);
}

const volatile sig_atomic_t *frames_stop_flag(void)
{
    return &signalled;
}

int frames_signal_code(void)
{
    return signalled ? 128 + signalled : 0;
}

enum status frames_session_enter(struct frames_session *session, const struct painter_plan *plan,
                                 const struct scene *scene, const struct engine_options *options,
                                 struct reason *reason)
{
    if (session->count == FRAMES_CONTESTANTS)
        return fail(reason, STATUS_LIMIT, "more than %d handlers", FRAMES_CONTESTANTS);
    enum status status =
        painter_open(plan, scene, options, &session->painter[session->count], reason);
    session->count += status == STATUS_OK;
    return status;
}

static enum status draw(void *user, size_t contestant, double angle, struct frames_sample *out,
                        struct reason *reason)
{
    struct frames_session *session = user;
    struct painter *painter = &session->painter[contestant];
    struct reason why = {""};
    if (contestant == 0)
        progress_done(session->progress, session->run.done, session->run.settings.frames,
                      "these frames");
    progress_step(session->progress, "%s: frame %u of %u, %s", session->label,
                  session->run.done + 1, session->run.settings.frames, painter->plan.handler);
    enum status status = painter_draw(painter, angle, out, &why);
    if (status)
        return fail(reason, status, "%s: %.250s", painter->plan.handler, why.text);
    return STATUS_OK;
}

static enum status tell(void *user, const struct frames_run *run, struct reason *reason)
{
    struct frames_session *session = user;
    return frames_write(run, &session->about, session->base, reason);
}

enum status frames_session_measure(struct frames_session *session,
                                   const struct frames_settings *settings, struct reason *reason)
{
    struct frames_settings stoppable = *settings;
    stoppable.stop = frames_stop_flag();
    enum status status = frames_make(&stoppable, &session->run, reason);
    for (size_t i = 0; i < session->count && !status; i++) {
        const struct painter *painter = &session->painter[i];
        status = frames_enter(&session->run, painter->plan.handler, painter_bytes(painter), reason);
        if (!status)
            session->run.contestant[i].rays_alone = painter->by_waves;
    }
    if (!status && session->base) /* fail now if a file cannot be written */
        status = tell(session, &session->run, reason);
    if (!status)
        status = frames_measure(&session->run, draw, session->base ? tell : NULL, session, reason);
    progress_end(session->progress);
    process_signal_taken();
    return status;
}

static void add_line(struct row_grid *grid, const struct frames_run *run, size_t i, size_t base)
{
    const struct frames_contestant *c = &run->contestant[i];
    struct frames_stats stats = frames_stats_of(run, i);
    char ratio[64] = "-\t-";
    if (base < run->count) {
        struct spread spread = frames_ratio(run, i, base);
        snprintf(ratio, sizeof ratio, "%.3f\t%.3f-%.3f", spread.median, spread.least, spread.most);
    }
    grid_add(grid, PAINT_PLAIN, "%s\t%llu\t%.3f\t%.3f\t%.3f\t%.3f\t%s\t%s", c->handler,
             (unsigned long long)c->bytes, stats.average, stats.least, stats.most, stats.median,
             ratio, frames_clock(c));
}

static void print_run(const struct frames_run *run, const struct frames_about *about,
                      const char *base, const struct screen *screen)
{
    static const struct column columns[] = {{"handler", .left = true},
                                            {"bytes", .rank = 2},
                                            {.title = "average", .least = TIME_WIDTH},
                                            {"least", .rank = 3, .least = TIME_WIDTH},
                                            {"most", .rank = 4, .least = TIME_WIDTH},
                                            {"median", .rank = 5, .least = TIME_WIDTH},
                                            {.title = "ratio", .least = 6},
                                            {"least-most", .rank = 1, .least = SPAN_WIDTH},
                                            {"clock", .left = true}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    screen_text(screen, "%s\n", about->title);
    screen_text(screen, "%s over %s%s; %s to warm up, dropped%s\n", COUNTED(run->done, "frame"),
                COUNTED(run->settings.turns, "turn"), run->count > 1 ? ", handlers by turns" : "",
                COUNTED(run->dropped, "frame"), run->stopped ? "; stopped by a signal" : "");
    printf("ms per frame%s\n", about->base < run->count
                                   ? "; ratios: of a frame's time to that of the first handler"
                                   : "");
    for (size_t i = 0; i < run->count; i++)
        add_line(&grid, run, i, about->base);
    grid_print(&grid, screen);
    if (base)
        screen_record(screen, PAINT_PLAIN, "written: %s.csv, %s.json, %s.svg, %s.png\n", base, base,
                      base, base);
}

enum status frames_try(const char *base, struct reason *reason)
{
    char path[FRAMES_PATH_MOST];
    enum status status = STATUS_OK;
    for (size_t i = 0; i < FRAMES_FILES && !status; i++) {
        status = frames_file(base, i, path, reason);
        if (!status)
            status = output_try(path, reason);
    }
    return status;
}

int frames_finish(const char *command, const struct frames_run *run,
                  const struct frames_about *about, const char *base, const struct screen *screen,
                  enum status status, const struct reason *reason)
{
    if (run->done > 0 || run->stopped)
        print_run(run, about, status ? NULL : base, screen);
    if (status)
        fprintf(stderr, "raydiff %s: %s\n", command, reason->text);
    return !status && run->stopped ? frames_signal_code() : exit_of_status(status);
}

void frames_session_free(struct frames_session *session)
{
    for (size_t i = 0; i < session->count; i++)
        painter_close(&session->painter[i]);
    session->count = 0;
    frames_free(&session->run);
}

/* Fills in the notes of the files: the scene and the versions. */
static void note_all(struct frames_session *session, const char *scene_name,
                     const struct engine_options *options)
{
    const struct engine *engine[FRAMES_CONTESTANTS];
    for (size_t i = 0; i < session->count; i++)
        engine[i] = session->painter[i].plan.engine;
    fuzz_versions(engine, session->count, options, session->versions, sizeof session->versions);
    session->about.note[0].name = "scene";
    session->about.note[0].value = scene_name;
    session->about.note[1].name = "versions";
    session->about.note[1].value = session->versions;
}

static enum status measure_plans(struct frames_session *session, const struct painter_plan *plan,
                                 size_t count, const char *scene_name, const struct scene *scene,
                                 const struct engine_options *options,
                                 const struct frames_settings *settings, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        struct reason why = {""};
        status = frames_session_enter(session, &plan[i], scene, options, &why);
        if (status)
            return fail(reason, status, "%s: %.250s", plan[i].handler, why.text);
    }
    note_all(session, scene_name, options);
    frames_catch_signals();
    return frames_session_measure(session, settings, reason);
}

int frames_command(const char *command, const struct painter_plan *plan, size_t count,
                   const char *scene_name, const struct scene *scene,
                   const struct engine_options *options, const struct frames_settings *settings,
                   const char *base, const struct screen *screen)
{
    struct frames_session *session = calloc(1, sizeof *session);
    struct progress progress = progress_make(command);
    struct reason reason = {""};
    char title[160];
    if (!session)
        return EXIT_INTERNAL;
    snprintf(title, sizeof title, "%.60s: %s, %u x %u pixels, %s", scene_name,
             COUNTED(scene->tri_count, "triangle"), plan->width, plan->height,
             COUNTED(plan->look.bounces, "bounce"));
    session->progress = &progress;
    session->label = scene_name;
    session->base = base;
    session->about.title = title;
    session->about.base = count > 1 ? 0 : SIZE_MAX;
    enum status status =
        measure_plans(session, plan, count, scene_name, scene, options, settings, &reason);
    int code =
        frames_finish(command, &session->run, &session->about, base, screen, status, &reason);
    frames_session_free(session);
    free(session);
    return code;
}
