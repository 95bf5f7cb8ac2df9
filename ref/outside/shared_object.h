/* Opening shared objects from outside. */
#ifndef SHARED_OBJECT_H
#define SHARED_OBJECT_H

#include "ref/base/base.h"

#define OBJECT_SUFFIX ".so"
#define GUEST_PREFIX  "inside:"
#define SHADER_PREFIX "shader:"

/* Returns the path in the name of an engine that is a shared object (ref/raydiff_engine.h): of
 * "FILE.so", which runs in a process of its own (ref/outside/pipe.h), and of "inside:FILE.so",
 * which runs in this one (ref/guest/guest_engine.h). NULL: any other name. */
const char *object_of_engine(const char *name);

/* The same, also of "shader:FILE" (gpu/engines/shader_tracer.h). */
const char *file_of_engine(const char *name);

/* Whether a name of so many characters ends in ".so" behind something. */
bool object_is_named(const char *name, size_t length);

/* Errors: STATUS_INPUT the file is there, and no regular one: the loader would wait for a writer to
 * a FIFO, and would read a device. */
enum status object_check_file(const char *path, struct reason *reason) MUST_USE;

/* Opens it and returns the handle for dlclose, NULL with a reason on error. A path without a slash
 * is one of the working folder, not of the system's. */
void *object_open(const char *path, struct reason *reason) MUST_USE;

/* Whether what an object calls itself is a letter, then letters, digits and _, `most` in all. */
bool object_name_is_fine(const char *name, size_t most);

/* Limits the address space of this process to so many MB more than it has now; UINT32_MAX: does
 * not. */
void object_limit_memory(uint32_t megabytes);

#endif
