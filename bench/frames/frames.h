/* A measured run of frames: contestants draw the same views by turns, frame by frame, so that all
 * of them meet the same machine and ratios are of one run. Independent of engines and
 * pictures: the caller draws. */
#ifndef FRAMES_H
#define FRAMES_H

#include "bench/chart/spread.h"
#include "ref/base/base.h"

#include <signal.h>

#define FRAMES_CONTESTANTS 32
#define FRAMES_MOST        100000u
#define FRAMES_DEFAULT     200u
#define FRAMES_TURNS       5u
#define FRAMES_WARM_UP     3u
#define FRAMES_REWRITE     10u /* frames between two writings of the files */

struct frames_settings {
    uint32_t frames;  /* measured: 1 to FRAMES_MOST */
    uint32_t turns;   /* around the camera's target during them; 0: the camera does not move */
    uint32_t warm_up; /* frames before them, which are dropped */
    const volatile sig_atomic_t *stop; /* NULL, or ends the run once it is not 0 */
};

/* What one frame took. */
struct frames_sample {
    double ms;
    bool device_clock; /* from timestamps of the GPU, else from the host's clock */
};

struct frames_contestant {
    char handler[48];  /* the name in files */
    uint64_t bytes;    /* that the handler needs besides the triangles; 0: none */
    bool device_clock; /* of every sample */
    bool rays_alone;   /* samples are of tracing, without shading; set by the caller */
    double *ms;        /* settings.frames; the first frames_run.done are measured */
};

/* Owns the samples (see frames_free). */
struct frames_run {
    struct frames_settings settings;
    struct frames_contestant contestant[FRAMES_CONTESTANTS];
    size_t count;
    uint32_t done;    /* frames that every contestant has drawn */
    uint32_t dropped; /* warm-up frames drawn */
    bool stopped;     /* by settings.stop, before all frames */
    double *scratch;  /* settings.frames, for statistics */
};

/* Draws the frame seen after turning by `angle` radians. Errors: the caller's own. */
typedef enum status frames_draw(void *user, size_t contestant, double angle,
                                struct frames_sample *out, struct reason *reason);

/* Writes what was measured so far; called every FRAMES_REWRITE frames and once at the end. */
typedef enum status frames_tell(void *user, const struct frames_run *run, struct reason *reason);

/* An empty run. Errors: STATUS_INPUT a setting out of range; STATUS_MEMORY. */
enum status frames_make(const struct frames_settings *settings, struct frames_run *out,
                        struct reason *reason) MUST_USE;

/* Adds a contestant. Errors: STATUS_LIMIT more than FRAMES_CONTESTANTS; STATUS_MEMORY. */
enum status frames_enter(struct frames_run *run, const char *handler, uint64_t bytes,
                         struct reason *reason) MUST_USE;

/* The angle of a measured frame; warm-up frames have those before it: negative numbers. */
double frames_angle(const struct frames_settings *settings, int64_t frame);

/* Draws warm-up and frames, each frame beginning with the next contestant; `tell` may be NULL. A
 * frame that not all have drawn, because the run was stopped or one failed, does not count. Errors:
 * those of draw and tell; what was measured before stays in the run, and after an error of draw it
 * has been told. */
enum status frames_measure(struct frames_run *run, frames_draw *draw, frames_tell *tell, void *user,
                           struct reason *reason) MUST_USE;

void frames_free(struct frames_run *run); /* a zero run is fine */

/* Of one contestant's measured frames, in ms; all 0 without any. */
struct frames_stats {
    double average, least, most, median;
};
struct frames_stats frames_stats_of(const struct frames_run *run, size_t contestant);

/* How many times as long `a` takes as `b`: median, least and most of the ratios frame by frame. All
 * 0 without frames. */
struct spread frames_ratio(const struct frames_run *run, size_t a, size_t b);

#endif
