/* Checks SPIR-V and decorates its float arithmetic: all embedded shaders at build time
 * (shaders/spirv_tool.c), those of plugins at run time. glslang loses `precise` inside helper
 * functions and struct returns and never decorates dot or cross products. So every float operation
 * is decorated with NoContraction here, and tracing and rendering shaders are rejected if they
 * contain an operation that cannot be decorated. Rendering shaders may also use a square root (as
 * an estimate) and a power (of colours). */
#ifndef SPIRV_FIX_H
#define SPIRV_FIX_H

#include "ref/base/base.h"

struct spirv_rules {
    bool tracing;
    bool render;
    bool query; /* may use ray queries, but nothing else beyond the baseline */
    bool free;  /* not decorated: it measures the driver's freedom */
};

/* Checks a module of `count` words and makes a decorated copy, which the caller frees. Of what a
 * compiler adds for people it keeps the names of functions alone.
 * Errors: STATUS_INPUT "word N: what: rule"; STATUS_MEMORY. On error *out is NULL. */
enum status spirv_fix(const uint32_t *word, size_t count, const struct spirv_rules *rules,
                      uint32_t **out, size_t *out_count, struct reason *reason) MUST_USE;

/* Makes a copy without any NoContraction, which the caller frees. Errors: as spirv_fix, but for its
 * rules. */
enum status spirv_strip(const uint32_t *word, size_t count, uint32_t **out, size_t *out_count,
                        struct reason *reason) MUST_USE;

#endif
