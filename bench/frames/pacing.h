/* Frame pacing: when a frame is due, with one pass in flight. Has no clock: every call is given the
 * time, so that tests can choose it. After RTRS's two schedulers, whose rules are kept but for
 * its lost first frame (F29): a frame stays due until it is drawn. */
#ifndef PACING_H
#define PACING_H

#include "ref/base/base.h"

#define PACING_FPS_MOST 1000.0

/* More frames than these at once are taken as one: after a stall the program does not run behind
 * for ever (the "death spiral"). */
#define PACING_BEHIND_MOST 10

struct pacing {
    double period_ns; /* of a frame */
    double owed_ns;   /* time that no update was given yet */
    uint64_t last_ns; /* of the last tick */
    uint64_t frames;  /* begun */
    bool stale;       /* something changed since the last frame was begun */
    bool in_flight;   /* a pass was begun and has not ended */
};

/* Begins at `now_ns` with a frame to be drawn. fps is clamped to (0, PACING_FPS_MOST]; what is no
 * number or not above 0 becomes 60. */
struct pacing pacing_make(double fps, uint64_t now_ns);

/* The time that the scene is to be moved by, in ms: 0 until a whole frame's time has passed, then
 * all that has passed since the last update; one frame's where that was over PACING_BEHIND_MOST
 * frames. A clock that goes back counts as standing still. */
double pacing_tick(struct pacing *pacing, uint64_t now_ns);

/* The picture is out of date: the camera moved, or the size changed. */
void pacing_touch(struct pacing *pacing);

/* True if the caller has to begin a pass now: something changed and none is in flight. */
bool pacing_begin(struct pacing *pacing);

/* The pass has ended. */
void pacing_end(struct pacing *pacing);

/* How long nothing is due, in ns from `now_ns`, if no event comes. */
uint64_t pacing_idle_ns(const struct pacing *pacing, uint64_t now_ns);

#endif
