/* Frame pacing: when a frame is due, with one pass in flight. It has no clock; every call takes the
 * time, so that tests can choose it. Follows the rules of RTRS's two schedulers except for the lost
 * first frame (F29): here a frame stays due until it is drawn. */
#ifndef PACING_H
#define PACING_H

#include "ref/base/base.h"

#define PACING_FPS_MOST 1000.0

/* More frames than this at once count as one, so that the program catches up after a stall instead
 * of lagging behind forever (the "death spiral"). */
#define PACING_BEHIND_MOST 10

struct pacing {
    double period_ns; /* duration of a frame */
    double owed_ns;   /* time not used by an update yet */
    uint64_t last_ns; /* time of the last tick */
    uint64_t frames;  /* frames started */
    bool stale;       /* something changed since the last frame was started */
    bool in_flight;   /* a pass was started and has not ended */
};

/* Starts at `now_ns` with a frame due. fps is clamped to (0, PACING_FPS_MOST]; NaN and values not
 * above 0 become 60. */
struct pacing pacing_make(double fps, uint64_t now_ns);

/* The time by which to move the scene, in ms. It is 0 until a whole frame's time has passed, then
 * all the time since the last update, but only one frame's time if that was over PACING_BEHIND_MOST
 * frames. A clock that goes back counts as standing still. */
double pacing_tick(struct pacing *pacing, uint64_t now_ns);

/* Marks the picture as out of date: the camera moved, or the size changed. */
void pacing_touch(struct pacing *pacing);

/* True if the caller must start a pass now: something changed and none is in flight. */
bool pacing_begin(struct pacing *pacing);

/* Marks the pass as ended. */
void pacing_end(struct pacing *pacing);

/* Time from `now_ns` until something is due if no event comes, in ns. */
uint64_t pacing_idle_ns(const struct pacing *pacing, uint64_t now_ns);

#endif
