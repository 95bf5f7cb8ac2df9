/* Engines of the program's own shaders that a compiler has been at: "ENGINE:COMPILER", as in
 * "vulkan:opt" or "rayquery:passes:ccp+if-conversion:final" (gpu/shaders/compiler.h). */
#ifndef COMPILED_H
#define COMPILED_H

#include "gpu/shaders/compiler.h"
#include "ref/engine.h"

/* True for vulkan, vulkan_brute, vulkan_stackless and rayquery. */
bool compiled_takes(const struct engine *engine);

/* Returns the engine whose shaders a name means to compile, or NULL if it is no such name. */
const struct engine *compiled_base(const char *name);

/* Finds the engine of that name in the table of engines, or adds it once its tools are looked for
 * and its passes are known. "vulkan:raw" is vulkan itself. Errors: as compiler_parse and
 * compiler_check; STATUS_INPUT no such engine; STATUS_LIMIT more than ENGINES_COMPILED_MOST. */
enum status compiled_engine(const char *name, const struct engine **out,
                            struct reason *reason) MUST_USE;

/* The same of an engine that compiled_takes, and a compiler. Errors: as compiler_check;
 * STATUS_LIMIT. */
enum status compiled_make(const struct engine *raw, const struct compiler *compiler,
                          const struct engine **out, struct reason *reason) MUST_USE;

/* True if the engines differ in nothing but how their shaders read memory. False for one engine
 * twice, and for engines that have no shaders to compile. */
bool compiled_other_memory(const struct engine *a, const struct engine *b);

#endif
