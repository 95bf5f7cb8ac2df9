/* The SPIR-V modules that the build embeds: one per shader, and three or two per layout, checked and decorated by
 * shaders/spirv_tool.c; and those of layouts from outside, by the same rules at run time. */
#ifndef SHADERS_H
#define SHADERS_H

#include "gpu/shaders/glsl_text.h"

struct shader {
    const char *name; /* of the file, without .comp */
    const uint32_t *word;
    uint32_t word_count;
    bool tracing; /* trace_<layout>: nothing in it may be rounded otherwise than in C */
};

/* The last one has the name NULL. */
extern const struct shader shaders[];

/* Returns the shader of that name, of these or added, or NULL. */
const struct shader *shader_find(const char *name);

#define SHADERS_ADDED_MOST 12

/* Checks and decorates a compiled module (gpu/shaders/spirv_fix.h) of the layout and adds it as
 * "trace_LAYOUT", "render_LAYOUT" or "decode_LAYOUT". For programs; not thread-safe.
 *   file   of its source, for reasons
 * Errors: STATUS_INPUT "FILE: rule"; STATUS_LIMIT over SHADERS_ADDED_MOST; STATUS_INTERNAL what
 * came out is not as it must be; STATUS_MEMORY. */
enum status shader_add(const char *layout, enum glsl_use use, const char *file,
                       const uint32_t *word, size_t count, struct reason *reason) MUST_USE;

/* Sets the reason why a layout has no shader; a text that is too long is cut. */
void shader_lacks(const char *layout, const char *why);
/* Writes that reason, or "there is no shader for layout LAYOUT". */
void shader_why_not(const char *layout, struct reason *reason);

#endif
