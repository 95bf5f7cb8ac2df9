/* Inputs and outputs of every tracing shader; see ref/abi.h. Rays and hits are read and written as
 * whole quads: on lavapipe loading four words costs little more than loading one. If RENDERING is
 * defined before, the inputs are those of the rendering shaders; if WORLDS is, those of the shaders
 * that trace worlds. Layouts and storages read the buffers by NODE_QUAD and its like. */
#ifndef JOB_GLSL
#define JOB_GLSL

#include "ref/abi.h"

#include "pick.glsl"

layout(local_size_x_id = ABI_SPEC_WORKGROUP) in;
layout(constant_id = ABI_SPEC_BOX) const uint BOX_TEST = ABI_BOX_ROBUST;
layout(constant_id = ABI_SPEC_TRI) const uint TRI_TEST = ABI_TRI_MT;
layout(constant_id = ABI_SPEC_STACK) const uint STACK = 16u;

layout(std430, set = 0, binding = ABI_BIND_NODES) readonly buffer Nodes { uvec4 node_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_ITEMS) readonly buffer Items { uint item_word[]; };
layout(std430, set = 0, binding = ABI_BIND_TRIS) readonly buffer Tris { vec4 tri_quad[]; };

#if defined(RENDERING)
#include "render_job.glsl"
#elif defined(WORLDS)
#include "world_job.glsl"
#else
layout(constant_id = ABI_SPEC_QUERY) const uint QUERY = ABI_QUERY_CLOSEST;

layout(push_constant) uniform Push { push job; };

layout(std430, set = 0, binding = ABI_BIND_RAYS) readonly buffer Rays { vec4 ray_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_HITS) writeonly buffer Hits { uvec4 hit_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_FLAGS) writeonly buffer Flags { uint flag_word[]; };
layout(std430, set = 0, binding = ABI_BIND_FOUND) writeonly buffer Found { uint found_word[]; };
#endif

/* A buffer holds one tree, but in a world. */
#ifndef WORLDS
#define NODE_QUAD(i)  node_quad[i]
#define NODE_WORD(i)  node_word[i]
#define ITEM_WORD(i)  item_word[i]
#define TRI_NUMBER(i) (i)
#define STACK_BASE    0u
#endif

#define NODE_LEAF 0x80000000u /* in node.a of a leaf */

#endif
