/* The engine "inside:FILE.so": a guest in this process, where nothing is between it and the clock.
 * Its crash is this process's. For races; "FILE.so" runs in a process of its own
 * (ref/outside/pipe.h). */
#ifndef GUEST_ENGINE_H
#define GUEST_ENGINE_H

#include "ref/engine.h"

/* Finds the engine "inside:FILE.so" in the table of engines, or adds it. The object is not loaded
 * before the engine is opened. Errors: STATUS_INPUT not such a name, or too long; STATUS_LIMIT as
 * engine_add. */
enum status guest_engine(const char *name, const struct engine **out,
                         struct reason *reason) MUST_USE;

#endif
