/* Rules for SPIR-V and the decoration of its float arithmetic: what every shader of ours goes
 * through at build time (shaders/spirv_tool.c), and one that comes from outside at run time.
 * glslang loses `precise` inside helper functions and struct returns and never decorates dot or
 * cross products, so every float operation gets its NoContraction here, and what cannot be
 * decorated is refused in tracing shaders and in those that render; the latter may take a square
 * root (as an estimate) and a power (of colours). */
#ifndef SPIRV_FIX_H
#define SPIRV_FIX_H

#include "ref/base/base.h"

struct spirv_rules {
    bool tracing;
    bool render;
    bool query; /* may use ray queries, and nothing else beyond the baseline */
    bool free;  /* its arithmetic stays as it is: the driver's freedom is what it measures */
};

/* Checks a module of `count` words, and makes one with its decorations, to be freed.
 * Errors: STATUS_INPUT "word N: what: rule"; STATUS_MEMORY. On error *out is NULL. */
enum status spirv_fix(const uint32_t *word, size_t count, const struct spirv_rules *rules,
                      uint32_t **out, size_t *out_count, struct reason *reason) MUST_USE;

#endif
