/* The engine "shader:FILE": a tracer from outside that is one compute shader, of GLSL or, if the
 * name ends in .spv, of SPIR-V. It runs once per ray, in one dimension, entry point `main`, and
 * needs the capability Shader alone. Of set 0 it may use
 *
 *   binding 0  rays: ox oy oz tmin dx dy dz tmax, floats
 *   binding 1  hits, which it writes: t u v, floats, and the triangle, uint; a miss is triangle
 *              0xFFFFFFFF, whatever t u v
 *   binding 2  vertices: x y z, floats
 *   binding 3  triangles: three vertex numbers each, uint
 *   push constants, uint: rays, vertices, triangles, query (0 closest, 1 any)
 *
 * all std430, without padding. An invocation whose number is not below `rays` does nothing. The
 * workgroup has the size of the shader (local_size_x), or is ours, if that is specialization
 * constant 0 (local_size_x_id = 0). */
#ifndef SHADER_TRACER_H
#define SHADER_TRACER_H

#include "ref/engine.h"

/* Compiles a file of GLSL; the caller frees *word. Errors: STATUS_INPUT "FILE:LINE: message";
 * STATUS_UNSUPPORTED built without a compiler. */
typedef enum status shader_tracer_compile_fn(const char *path, uint32_t **word, size_t *count,
                                             struct reason *reason);

/* Sets the compiler. Without one only SPIR-V is taken. */
void shader_tracer_compile_with(shader_tracer_compile_fn *compile);

/* Finds the engine in the table of engines, or reads, compiles and checks the file, and adds it.
 * Errors: STATUS_INPUT not such a name; "FILE: rule": cannot be read, as spirv_interface; as the
 * compiler; STATUS_LIMIT as engine_add; STATUS_MEMORY. */
enum status shader_tracer(const char *name, const struct engine **out,
                          struct reason *reason) MUST_USE;

#endif
