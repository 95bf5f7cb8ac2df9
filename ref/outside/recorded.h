/* Answers that were written down as an engine: of a file, for raydiff judge; of one ray, so that
 * raydiff explain can look at it. */
#ifndef FUZZ_RECORDED_H
#define FUZZ_RECORDED_H

#include "ref/engine.h"

#define RECORDED_PREFIX    "answer:"
#define RECORDED_NAME_MOST 160

/* Answers to `count` rays; all borrowed. */
struct recorded {
    const struct ray *ray;
    const struct hit *hit;
    size_t count;
    uint32_t formula, rounding, flags; /* as in ref/outside/pipe.h */
};

/* Makes the engine "answer:FORMULA:ROUNDING:FLAGS" of them; one at a time, *answers is kept until
 * the next call. It answers the first rays of `ray` and no others. Errors: STATUS_INPUT as
 * pipe_model. */
enum status recorded_engine(const struct recorded *answers, const struct engine **out,
                            struct reason *reason) MUST_USE;

/* Gives the engine of the name "answer:FORMULA:ROUNDING:FLAGS:T:U:V:TRIANGLE" or "...:miss", from
 * the table of engines or new in it; one a program. It gives that answer to the first ray that it
 * traces, and to the same ray later. Errors: STATUS_INPUT the name is wrong; STATUS_LIMIT there is
 * one already. */
enum status recorded_find(const char *name, const struct engine **out,
                          struct reason *reason) MUST_USE;

/* Writes that name: the name of an engine of recorded_engine and an answer of it. */
void recorded_name(const char *engine, const struct hit *hit, char text[RECORDED_NAME_MOST]);

#endif
