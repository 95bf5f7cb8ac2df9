/* Compiling a tracer that is one compute shader (gpu/engines/shader_tracer.h), by glslang. */
#ifndef CMD_GLSL_H
#define CMD_GLSL_H

#include "ref/base/base.h"

/* Compiles the file, which includes none; the caller frees *word. Errors: STATUS_INPUT it cannot be
 * read; "FILE:LINE: message"; STATUS_UNSUPPORTED built without glslang; STATUS_MEMORY. */
enum status cmd_glsl_tracer(const char *path, uint32_t **word, size_t *count,
                            struct reason *reason) MUST_USE;

#endif
