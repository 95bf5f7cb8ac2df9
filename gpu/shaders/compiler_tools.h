/* The tools of compilers, as processes; for gpu/shaders/compiler.c. */
#ifndef COMPILER_TOOLS_H
#define COMPILER_TOOLS_H

#include "gpu/shaders/compiler.h"

/* Errors: STATUS_UNSUPPORTED a tool is missing: its name and its Debian package. */
enum status compiler_tools_are_here(const struct compiler *compiler,
                                    struct reason *reason) MUST_USE;

/* Runs the compiler's tools on the shader's module; the caller frees *out. Errors: as
 * compiler_run. */
enum status compiler_tools(const struct compiler *compiler, const struct vk_shader *shader,
                           uint32_t **out, size_t *out_count, struct reason *reason) MUST_USE;

/* Runs spirv-val. Errors: STATUS_DEVICE what it says; STATUS_UNSUPPORTED as above. */
enum status compiler_validate(const uint32_t *word, size_t count, struct reason *reason) MUST_USE;

#endif
