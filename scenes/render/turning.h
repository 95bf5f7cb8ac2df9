/* A window's arrow keys as in RTRS: the camera turns one way while the left key is held, else the
 * other way while the right key is held. The angle depends on time, not on frames. */
#ifndef TURNING_H
#define TURNING_H

#include <stdbool.h>
#include <stdint.h>

/* Radians per millisecond: RTRS's 0.0314 * 0.1. A full turn takes 2.001 s. */
#define TURNING_SPEED 0.00314
/* Least time a key counts as held, even if it was pressed and released during one frame. */
#define TURNING_TAP_MS 10u

/* Zero: no key is held. Times are milliseconds of one clock, which may wrap around. */
struct turning {
    bool left, right;
    uint32_t since;   /* time of the last count */
    uint32_t pressed; /* time of the last key press */
    double ms;        /* time held since turning_take: left adds, right subtracts */
};

static inline void turning_count(struct turning *turning, uint32_t now)
{
    double ms = (double)(uint32_t)(now - turning->since);
    turning->since = now;
    if (turning->left) /* has priority over right */
        turning->ms += ms;
    else if (turning->right)
        turning->ms -= ms;
}

/* Processes a key press or release. Repeats of a held key change nothing. */
static inline void turning_key(struct turning *turning, bool left, bool down, uint32_t now)
{
    bool *key = left ? &turning->left : &turning->right;
    if (*key == down)
        return;
    turning_count(turning, now);
    uint32_t held = now - turning->pressed;
    if (down)
        turning->pressed = now;
    else if (held < TURNING_TAP_MS && !(turning->left && turning->right))
        turning->ms += (left ? 1.0 : -1.0) * (double)(TURNING_TAP_MS - held);
    *key = down;
}

/* Returns the turning time since the last call, in ms; negative to the right. */
static inline double turning_take(struct turning *turning, uint32_t now)
{
    turning_count(turning, now);
    double ms = turning->ms;
    turning->ms = 0.0;
    return ms;
}

#endif
