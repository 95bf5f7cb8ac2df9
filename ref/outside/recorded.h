/* Engines that replay recorded answers: those of a file, for raydiff judge, or a single one, for
 * raydiff explain. */
#ifndef FUZZ_RECORDED_H
#define FUZZ_RECORDED_H

#include "ref/engine.h"

#define RECORDED_PREFIX    "answer:"
#define RECORDED_NAME_MOST 160

/* Answers to `count` rays; all arrays are borrowed. */
struct recorded {
    const struct ray *ray;
    const struct ray_mode *mode; /* in a world; else NULL */
    const struct hit *hit;       /* in a world of placed triangles */
    const uint32_t *tag;         /* in a world; else NULL */
    size_t count;
    uint32_t formula, rounding, flags; /* as in ref/outside/pipe.h */
};

/* Makes the engine "answer:FORMULA:ROUNDING:FLAGS" that replays `answers`. There is one at a time,
 * and *answers must stay valid until the next call. It traces only the first rays of `ray`, in
 * order. Errors: STATUS_INPUT as pipe_model. */
enum status recorded_engine(const struct recorded *answers, const struct engine **out,
                            struct reason *reason) MUST_USE;

/* Finds the engine "answer:FORMULA:ROUNDING:FLAGS:T:U:V:TRIANGLE" or "...:miss" in the table of
 * engines, or adds it; a program can have one. It returns that answer for the first ray that it
 * traces, and for the same ray later. Errors: STATUS_INPUT the name is wrong; STATUS_LIMIT there is
 * one already. */
enum status recorded_find(const char *name, const struct engine **out,
                          struct reason *reason) MUST_USE;

/* Writes the name for recorded_find: the name of a recorded_engine and one of its answers. */
void recorded_name(const char *engine, const struct hit *hit, char text[RECORDED_NAME_MOST]);

#endif
