/* Measured runs of frames as commands make them: bench frames, bench paper, bench special, and
 * render --benchmark. For commands only. */
#ifndef CMD_BENCH_FRAMES_H
#define CMD_BENCH_FRAMES_H

#include "bench/frames/frames_files.h"
#include "bench/frames/painter.h"
#include "cmd/common/cmd_tables.h"

#define FRAMES_VERSIONS 640

/* A run and its painters. Too large for a stack. */
struct frames_session {
    struct progress *progress;
    const char *label; /* of what is measured, for progress */
    struct frames_about about;
    const char *base; /* of the files; NULL: none */
    struct painter painter[FRAMES_CONTESTANTS];
    size_t count;
    struct frames_run run;
    char versions[FRAMES_VERSIONS];
};

/* Catches SIGINT and SIGTERM from now on: the run ends after the frame being drawn. The second one
 * kills. */
void frames_catch_signals(void);

/* For frames_settings.stop: set by a caught signal. */
const volatile sig_atomic_t *frames_stop_flag(void);

/* 0, or the exit code of a run that a signal ended: 128 + its number. */
int frames_signal_code(void);

/* Opens a painter. On error the session is unchanged. Errors: as painter_open; STATUS_LIMIT more
 * than FRAMES_CONTESTANTS. */
enum status frames_session_enter(struct frames_session *session, const struct painter_plan *plan,
                                 const struct scene *scene, const struct engine_options *options,
                                 struct reason *reason) MUST_USE;

/* Draws the frames and writes the files, if there is a base. settings->stop is set here. Errors: as
 * frames_make and frames_measure. */
enum status frames_session_measure(struct frames_session *session,
                                   const struct frames_settings *settings,
                                   struct reason *reason) MUST_USE;

/* The end of a command that measured: prints a line per handler (bytes, times, ratio to
 * about->base) and the files' names, or why it failed. Returns the exit code; 128 + the signal that
 * ended the run, the files holding what was measured. */
int frames_finish(const char *command, const struct frames_run *run,
                  const struct frames_about *about, const char *base, enum status status,
                  const struct reason *reason);

void frames_session_free(struct frames_session *session); /* what it owns, not itself */

/* Enters `count` plans, measures, prints, writes BASE.csv, .json, .svg and .png. Returns the exit
 * code of frames_finish. */
int frames_command(const char *command, const struct painter_plan *plan, size_t count,
                   const char *scene_name, const struct scene *scene,
                   const struct engine_options *options, const struct frames_settings *settings,
                   const char *base);

#endif
