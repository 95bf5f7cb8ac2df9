/* Which shader goes with which layout from outside: --shader FILE goes with the --layout FILE.so
 * before it, or with the one after it if that has none. A layout that is named again may have its
 * file named again. For programs. */
#ifndef PLUGIN_SHADER_H
#define PLUGIN_SHADER_H

#include "ref/layout.h"

/* Compiles the file for the layout's engines; errors as the compiler's. */
typedef enum status plugin_compile_fn(const struct layout *layout, const char *file,
                                      struct reason *reason);

/* Who compiles; without, --shader is STATUS_INPUT. */
void plugin_compile_with(plugin_compile_fn *compile);

/* --shader FILE. `file` is borrowed. Errors: STATUS_INPUT a second one for one layout, unless it is
 * the same; as the compiler. */
enum status plugin_shader_take(const char *file, struct reason *reason) MUST_USE;

/* A layout from outside was named. Errors: as the compiler of a file that waited for it. */
enum status plugin_shader_layout(const struct layout *layout, struct reason *reason) MUST_USE;

/* After all options. Errors: STATUS_INPUT a file still waits for a layout. */
enum status plugin_shader_settle(struct reason *reason) MUST_USE;

/* The file that the layout's shader is from; NULL: none. */
const char *plugin_shader_path(const struct layout *layout);

/* The same of the layout that was opened from this path; NULL: none. */
const char *plugin_shader_of(const char *path);

/* Appends the options that name the layout to a command line: " --layout NAME", of one from outside
 * " --layout FILE.so --shader FILE"; as much as fits. */
void plugin_command(char *text, size_t text_bytes, const struct layout *layout);

/* Of raydiff: glslang (cmd/doctor/cmd_glsl.c). Errors: STATUS_INPUT "FILE:LINE: what"; as shader_add. Of a
 * program that was built without glslang: STATUS_OK, and engine vulkan says why it has no shader.
 */
enum status cmd_glsl_compile(const struct layout *layout, const char *file,
                             struct reason *reason) MUST_USE;

#endif
