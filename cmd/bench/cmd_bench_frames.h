/* Measured runs of frames for bench frames, bench paper, bench special and render --benchmark. For
 * commands only. */
#ifndef CMD_BENCH_FRAMES_H
#define CMD_BENCH_FRAMES_H

#include "bench/frames/frames_files.h"
#include "bench/frames/painter.h"
#include "cmd/common/cmd_tables.h"
#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_screen.h"

#define FRAMES_VERSIONS 640

/* A run and its painters. Too large for the stack. */
struct frames_session {
    struct progress *progress;
    const char *label; /* what is measured, for progress lines */
    struct frames_about about;
    const char *base; /* base name of the files; NULL: no files */
    struct painter painter[FRAMES_CONTESTANTS];
    size_t count;
    struct frames_run run;
    char versions[FRAMES_VERSIONS];
};

/* Catches SIGINT and SIGTERM from now on. The first signal ends the run after the current frame.
 * The second signal kills the process. */
void frames_catch_signals(void);

/* The flag for frames_settings.stop. A caught signal sets it. */
const volatile sig_atomic_t *frames_stop_flag(void);

/* Returns 0, or the exit code of a run that a signal ended: 128 + its number. */
int frames_signal_code(void);

/* Opens a painter. On error the session is unchanged. Errors: as painter_open; STATUS_LIMIT if
 * there are more than FRAMES_CONTESTANTS. */
enum status frames_session_enter(struct frames_session *session, const struct painter_plan *plan,
                                 const struct scene *scene, const struct engine_options *options,
                                 struct reason *reason) MUST_USE;

/* Draws and measures the frames, and writes the files if session->base is not NULL. Uses
 * frames_stop_flag instead of settings->stop. Errors: as frames_make and frames_measure. */
enum status frames_session_measure(struct frames_session *session,
                                   const struct frames_settings *settings,
                                   struct reason *reason) MUST_USE;

/* Tries each file that frames_write writes, before anything is opened. Errors: as output_try. */
enum status frames_try(const char *base, struct reason *reason) MUST_USE;

/* Ends a measuring command: prints a line per handler (bytes, times, ratio to about->base) and the
 * names of the files, or why the run failed. Returns the exit code. If a signal ended the run, that
 * is 128 + the signal, and the files hold what was measured. */
int frames_finish(const char *command, const struct frames_run *run,
                  const struct frames_about *about, const char *base, const struct screen *screen,
                  enum status status, const struct reason *reason);

void frames_session_free(struct frames_session *session); /* frees what it owns, not itself */

/* Enters `count` plans, measures, prints, and writes BASE.csv, .json, .svg and .png. Returns the
 * exit code of frames_finish. */
int frames_command(const char *command, const struct painter_plan *plan, size_t count,
                   const char *scene_name, const struct scene *scene,
                   const struct engine_options *options, const struct frames_settings *settings,
                   const char *base, const struct screen *screen);

#endif
