/* A measured run of frames. The contestants draw the same views in turn, frame by frame, so that
 * all of them run under the same conditions and ratios are from one run. Independent of engines and
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
#define FRAMES_REWRITE     10u /* frames between two updates of the files */

struct frames_settings {
    uint32_t frames;  /* to measure: 1 to FRAMES_MOST */
    uint32_t turns;   /* of the camera around its target; 0: the camera does not move */
    uint32_t warm_up; /* frames drawn first and dropped */
    const volatile sig_atomic_t *stop; /* NULL, or stops the run when not 0 */
};

/* The time of one frame. */
struct frames_sample {
    double ms;
    bool device_clock; /* measured by timestamps of the GPU, else by the host's clock */
};

struct frames_contestant {
    char handler[48];  /* the name in files */
    uint64_t bytes;    /* bytes of the handler besides the triangles; 0: none */
    bool device_clock; /* for every sample */
    bool rays_alone;   /* samples measure tracing without shading; set by the caller */
    double *ms;        /* settings.frames values; the first frames_run.done are measured */
};

/* Owns the samples: free with frames_free. */
struct frames_run {
    struct frames_settings settings;
    struct frames_contestant contestant[FRAMES_CONTESTANTS];
    size_t count;
    uint32_t done;    /* frames that every contestant has drawn */
    uint32_t dropped; /* warm-up frames drawn */
    bool stopped;     /* by settings.stop, before all frames */
    double *scratch;  /* settings.frames, for statistics */
};

/* Draws the frame after turning by `angle` radians. Errors: the caller's own. */
typedef enum status frames_draw(void *user, size_t contestant, double angle,
                                struct frames_sample *out, struct reason *reason);

/* Writes the measurements so far. Called every FRAMES_REWRITE frames and once at the end. */
typedef enum status frames_tell(void *user, const struct frames_run *run, struct reason *reason);

/* Makes an empty run. Errors: STATUS_INPUT a setting out of range; STATUS_MEMORY. */
enum status frames_make(const struct frames_settings *settings, struct frames_run *out,
                        struct reason *reason) MUST_USE;

/* Adds a contestant. Errors: STATUS_LIMIT more than FRAMES_CONTESTANTS; STATUS_MEMORY. */
enum status frames_enter(struct frames_run *run, const char *handler, uint64_t bytes,
                         struct reason *reason) MUST_USE;

/* The angle of a measured frame. Warm-up frames come before it and have negative numbers. */
double frames_angle(const struct frames_settings *settings, int64_t frame);

/* Draws warm-up and measured frames, each starting with the next contestant. `tell` may be NULL. A
 * frame not drawn by all, because the run was stopped or one failed, does not count. Errors: those
 * of draw and tell. Earlier measurements stay in the run; after an error of draw, tell was still
 * called. */
enum status frames_measure(struct frames_run *run, frames_draw *draw, frames_tell *tell, void *user,
                           struct reason *reason) MUST_USE;

void frames_free(struct frames_run *run); /* a zeroed run is fine */

/* Statistics of a contestant's measured frames, in ms; all 0 without frames. */
struct frames_stats {
    double average, least, most, median;
};
struct frames_stats frames_stats_of(const struct frames_run *run, size_t contestant);

/* The time of `a` relative to `b`: median, least and largest ratio over the frames. All 0 without
 * frames. */
struct spread frames_ratio(const struct frames_run *run, size_t a, size_t b);

#endif
