/* Compilers that stand between the shaders of the build and a driver (docs/drivers.md). A compiler
 * makes another module of a module, by the tools that people use:
 *   raw               the module as it is
 *   opt, size         spirv-opt -O and -Os
 *   passes:A+B+...    passes of spirv-opt by name, in this order; one with a '/' is a program that
 *                     reads SPIR-V from its standard input and writes it to its standard output
 *   cross             SPIRV-Cross to GLSL, and glslang back
 *   hlsl              SPIRV-Cross to HLSL, and glslang's front end for that back; specialization
 *                     constants have their values by then
 *   shaderc           SPIRV-Cross to GLSL, and glslc -O back
 * A name may end in :source, :final or :none, see enum decorate, and begin with texel: or
 * reference: (texel alone is texel:raw), see enum memory. */
#ifndef COMPILER_H
#define COMPILER_H

#include "gpu/vk/vk.h"

#define COMPILER_NAME_MOST   160
#define COMPILER_PASSES_MOST 64

/* When NoContraction is put on every float operation: before the compiler, whose work it is to keep
 * it; after it; or never. */
enum decorate { DECORATE_SOURCE, DECORATE_FINAL, DECORATE_NONE, DECORATE_COUNT };
extern const char *const decorate_names[DECORATE_COUNT + 1]; /* NULL-terminated */

/* How a shader reads its rays, nodes, items, triangles and instances: as storage buffers, as
 * uniform texel buffers, or by addresses (buffer references), see gpu/shaders/spirv_memory.h. */
enum memory { MEMORY_STORAGE, MEMORY_TEXEL, MEMORY_REFERENCE, MEMORY_COUNT };
extern const char *const memory_names[MEMORY_COUNT + 1]; /* NULL-terminated */

enum compiler_kind {
    COMPILER_RAW,
    COMPILER_OPT,
    COMPILER_SIZE,
    COMPILER_PASSES,
    COMPILER_CROSS,
    COMPILER_HLSL,
    COMPILER_SHADERC,
    COMPILER_KINDS
};

struct compiler {
    enum compiler_kind kind;
    enum memory memory;
    enum decorate decorate;
    bool decorated;                  /* its name says so */
    char passes[COMPILER_NAME_MOST]; /* of passes: "A+B" */
};

/* What a compiler made of a module. */
struct compiled {
    const uint32_t *word; /* lives until the program ends */
    uint32_t count;
    uint32_t words_of; /* of MEMORY_TEXEL: bindings that are read as words, see vk_shader.words */
    uint32_t source, ops, kept, signs, foreign; /* as in struct engine_compiled (ref/engine.h) */
};

/* Reads a name. Errors: STATUS_INPUT it is none, with the rule. */
enum status compiler_parse(const char *text, struct compiler *out, struct reason *reason) MUST_USE;

/* Writes the name: what compiler_parse reads; :source is left out. */
void compiler_name(const struct compiler *compiler, char text[COMPILER_NAME_MOST + 32]);

/* The bindings that its modules read otherwise than those of the build. */
struct vk_ways compiler_ways(const struct compiler *compiler);

/* Whether its modules are those of the build. */
bool compiler_changes_nothing(const struct compiler *compiler);

/* Whether its way leads through another language. */
bool compiler_translates(const struct compiler *compiler);

/* Checks that its tools are here and that spirv-opt knows its passes. Errors: STATUS_UNSUPPORTED no
 * such tool (the reason names it and its package); STATUS_INPUT no such pass or program; as
 * compiler_run. */
enum status compiler_check(const struct compiler *compiler, struct reason *reason) MUST_USE;

/* Compiles a module and validates the result with spirv-val. Keeps what it made: the same module
 * gives the same words again. Not thread-safe.
 * Errors: STATUS_UNSUPPORTED no such tool, or the language of a translator lacks something;
 * STATUS_DEVICE a tool fails, or its module is not valid; STATUS_MEMORY. */
enum status compiler_run(const struct compiler *compiler, const struct vk_shader *shader,
                         struct compiled *out, struct reason *reason) MUST_USE;

#endif
