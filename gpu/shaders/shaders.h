/* The SPIR-V modules that the build embeds: one for each shader and several for each layout,
 * checked and decorated by shaders/spirv_tool.c. Modules of plugin layouts are added at run time by
 * the same rules. */
#ifndef SHADERS_H
#define SHADERS_H

#include "gpu/shaders/glsl_text.h"

struct shader {
    const char *name; /* file name without .comp */
    const uint32_t *word;
    uint32_t word_count;
    bool tracing; /* trace_<layout>: all operations must round as in C */
};

/* The embedded shaders. The last one has the name NULL. */
extern const struct shader shaders[];

/* Returns the embedded or added shader of that name, or NULL. */
const struct shader *shader_find(const char *name);

#define SHADERS_ADDED_MOST 12

/* Checks and decorates a compiled module (gpu/shaders/spirv_fix.h) of the layout, and adds it as
 * "trace_LAYOUT", "render_LAYOUT" or "decode_LAYOUT". `file` is its source, for reasons. For
 * programs; not thread-safe.
 * Errors: STATUS_INPUT "FILE: rule"; STATUS_LIMIT over SHADERS_ADDED_MOST; STATUS_INTERNAL the
 * decorated module is wrong; STATUS_MEMORY. */
enum status shader_add(const char *layout, enum glsl_use use, const char *file,
                       const uint32_t *word, size_t count, struct reason *reason) MUST_USE;

/* Sets the reason why a layout has no shader. Text that is too long is cut. */
void shader_lacks(const char *layout, const char *why);
/* Writes the reason set by shader_lacks, or "there is no shader for layout LAYOUT". */
void shader_why_not(const char *layout, struct reason *reason);

#endif
