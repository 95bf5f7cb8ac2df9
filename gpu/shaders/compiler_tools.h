/* The tools of compilers, as processes; for gpu/shaders/compiler.c and what takes a compiler apart
 * (gpu/bisect/). */
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

/* Parts "A+B" into its passes, which point into `text`. Returns their number. */
size_t compiler_split(const char *passes, char text[COMPILER_NAME_MOST],
                      const char *pass[COMPILER_PASSES_MOST]);

#define COMPILER_LIST_MOST  256
#define COMPILER_LIST_BYTES 16384

/* Runs a list of passes on a module, as passes: does; the caller frees *out. Errors: STATUS_LIMIT
 * more of them than the above, or longer names than half of the above; as compiler_run. */
enum status compiler_list(const char *const *pass, size_t count, const uint32_t *word,
                          size_t word_count, uint32_t **out, size_t *out_count,
                          struct reason *reason) MUST_USE;

/* The passes that spirv-opt says opt or size stand for, a line each; the caller frees *text.
 * Errors: STATUS_DEVICE it does not say; STATUS_UNSUPPORTED it is not here; STATUS_MEMORY. */
enum status compiler_level_passes(const struct compiler *compiler, char **text,
                                  struct reason *reason) MUST_USE;

/* The steps before and after the tools: a module of the shader's, without decorations unless they
 * come first; then in place of *word, which is freed, the module with those that come last. Errors:
 * as compiler_run. */
enum status compiler_begin(const struct compiler *compiler, const struct vk_shader *shader,
                           uint32_t **word, size_t *count, struct reason *reason) MUST_USE;
enum status compiler_finish(const struct compiler *compiler, uint32_t **word, size_t *count,
                            struct reason *reason) MUST_USE;

/* What became of a shader in a module, whose words stay the caller's. Errors: as spirv_look. */
enum status compiler_look(const struct vk_shader *shader, const uint32_t *word, size_t count,
                          struct compiled *out, struct reason *reason) MUST_USE;

/* Runs spirv-val. Errors: STATUS_DEVICE what it says; STATUS_UNSUPPORTED as above. */
enum status compiler_validate(const uint32_t *word, size_t count, struct reason *reason) MUST_USE;

#endif
