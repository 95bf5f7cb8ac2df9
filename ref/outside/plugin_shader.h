/* Binds shaders to plugin layouts: --shader FILE belongs to the --layout FILE.so before it, or to
 * the one after it if that has none. A layout and its file may be named again. For programs. */
#ifndef PLUGIN_SHADER_H
#define PLUGIN_SHADER_H

#include "ref/layout.h"

/* Compiles the file for the layout's engines. Errors: the compiler's. */
typedef enum status plugin_compile_fn(const struct layout *layout, const char *file,
                                      struct reason *reason);

/* Sets the compiler. Without one, --shader is STATUS_INPUT. */
void plugin_compile_with(plugin_compile_fn *compile);

/* Handles --shader FILE. `file` is borrowed. Errors: STATUS_INPUT a second, different file for a
 * layout; as the compiler. */
enum status plugin_shader_take(const char *file, struct reason *reason) MUST_USE;

/* Handles --layout of a plugin. Errors: as the compiler for a file that waited for it. */
enum status plugin_shader_layout(const struct layout *layout, struct reason *reason) MUST_USE;

/* Call after all options. Errors: STATUS_INPUT a file still waits for a layout. */
enum status plugin_shader_settle(struct reason *reason) MUST_USE;

/* Returns the file of the layout's shader; NULL: none. */
const char *plugin_shader_path(const struct layout *layout);

/* Returns the shader file of the layout that was opened from `path`; NULL: none. */
const char *plugin_shader_of(const char *path);

/* Appends the options that name the layout to a command line: " --layout NAME", or of a plugin "
 * --layout FILE.so --shader FILE"; as much as fits. */
void plugin_command(char *text, size_t text_bytes, const struct layout *layout);

/* The compiler of raydiff, glslang (cmd/doctor/cmd_glsl.c). Errors: STATUS_INPUT "FILE:LINE:
 * message"; as shader_add. In a program built without glslang it returns STATUS_OK, and engine
 * vulkan reports that it has no shader. */
enum status cmd_glsl_compile(const struct layout *layout, const char *file,
                             struct reason *reason) MUST_USE;

#endif
