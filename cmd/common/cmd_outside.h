/* Names on the command line that are no members of a table yet: engines and layouts from
 * outside. */
#ifndef CMD_OUTSIDE_H
#define CMD_OUTSIDE_H

#include "cmd/common/cmd_tables.h"

/* Length of the name at the start of the text. A command may contain commas, so its name extends to
 * the end or to the next command. */
size_t outside_name_length(enum table table, const char *text);

/* Adds what a name of *length characters names to its table: an engine "pipe:COMMAND", "FILE.so",
 * "inside:FILE.so", "shader:FILE", "ENGINE:COMPILER", "embree:MODE" or "answer:...", a layout
 * "FILE.so". The own name of a mode of Embree and of a layout replaces *text. A pattern or
 * "embree:all" adds all modes of Embree that it names. Does nothing for other names. Errors:
 * STATUS_INPUT no such thing; STATUS_DEVICE a shared object that crashes or hangs while it is
 * opened; STATUS_UNSUPPORTED GLSL without a compiler, no such mode of Embree here. */
enum status outside_add(enum table table, const char *flag, const char **text, size_t *length,
                        struct reason *reason) MUST_USE;

/* True for the names that outside_engine takes. */
bool outside_is_engine(const char *name);

/* True for those of them that need nothing else than their names, which findings keep:
 * "ENGINE:COMPILER" and "embree:MODE". */
bool outside_is_known(const char *name);

/* Finds the engine "pipe:COMMAND", "FILE.so", "inside:FILE.so", "shader:FILE", "ENGINE:COMPILER"
 * or "embree:MODE" in the table, or adds it, once its file or its tools are looked at. Errors: as
 * guest_try, pipe_engine, guest_engine, shader_tracer, compiled_engine, embree_named,
 * rayquery_named. */
enum status outside_engine(const char *name, const struct engine **out,
                           struct reason *reason) MUST_USE;

#endif
