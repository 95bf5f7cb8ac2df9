/* The arrow keys of a window as RTRS has them: while the left one is held the camera turns one
 * way, else while the right one is, the other; by time, whatever the frames take. */
#ifndef TURNING_H
#define TURNING_H

#include <stdbool.h>
#include <stdint.h>

/* Radians a millisecond: RTRS's 0.0314 * 0.1. A whole turn takes 2.001 s. */
#define TURNING_SPEED 0.00314
/* A key pressed and let go while a frame was drawn was held so many milliseconds at least. */
#define TURNING_TAP_MS 10u

/* Zero: nothing is held. Times are milliseconds of one clock that may wrap around. */
struct turning {
    bool left, right;
    uint32_t since;   /* the last time that was counted */
    uint32_t pressed; /* when the last key went down */
    double ms;        /* held and not yet taken: left counts up, right down */
};

static inline void turning_count(struct turning *turning, uint32_t now)
{
    double ms = (double)(uint32_t)(now - turning->since);
    turning->since = now;
    if (turning->left) /* wins over right */
        turning->ms += ms;
    else if (turning->right)
        turning->ms -= ms;
}

/* A key went down or up; a key that repeats goes down again, which changes nothing. */
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

/* Turning time since the last call, in ms; negative to the right. */
static inline double turning_take(struct turning *turning, uint32_t now)
{
    turning_count(turning, now);
    double ms = turning->ms;
    turning->ms = 0.0;
    return ms;
}

#endif
