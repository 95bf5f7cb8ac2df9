/* The SPIR-V modules that the build embeds: one per shaders/NAME.comp, checked and decorated by
 * shaders/spirv_tool.c. */
#ifndef SHADERS_H
#define SHADERS_H

#include <stdbool.h>
#include <stdint.h>

struct shader {
    const char *name; /* of the file, without .comp */
    const uint32_t *word;
    uint32_t word_count;
    bool tracing; /* trace_<layout>: nothing in it may be rounded otherwise than in C */
};

/* The last one has the name NULL. */
extern const struct shader shaders[];

/* Returns the shader of that name, or NULL. */
const struct shader *shader_find(const char *name);

#endif
