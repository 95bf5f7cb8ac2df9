/* Inputs and outputs of the shaders that trace worlds, for job.glsl; see ref/abi_world.h. The nodes
 * and items of all trees are in one buffer each. `job` describes the tree that is being traversed,
 * so that layouts and storages read it as if it was alone. */
#ifndef WORLD_JOB_GLSL
#define WORLD_JOB_GLSL

#include "ref/abi_world.h"

layout(constant_id = ABI_SPEC_QUERY) const uint QUERY = ABI_QUERY_CLOSEST;

layout(push_constant) uniform Push { world_push world; };

layout(std430, set = 0, binding = ABI_BIND_RAYS) readonly buffer Rays { uvec4 ray_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_HITS) writeonly buffer Hits { uvec4 hit_quad[]; };
layout(std430, set = 0, binding = ABI_BIND_FLAGS) writeonly buffer Flags { uint flag_word[]; };
layout(std430, set = 0, binding = ABI_BIND_FOUND) writeonly buffer Found { uint found_word[]; };
layout(std430, set = 0, binding = ABI_BIND_WORLD) readonly buffer World { uvec4 world_quad[]; };

push job;
uint node_first = 0u, item_first = 0u, tri_first = 0u;
uint geometry_first = 0u, geometry_count = 0u;
uint stack_base = 0u; /* below it are the top's entries while a mesh is traversed */

#define NODE_QUAD(i)  node_quad[(node_first >> 2) + (i)]
#define NODE_WORD(i)  node_word[node_first + (i)]
#define ITEM_WORD(i)  item_word[item_first + (i)]
#define TRI_NUMBER(i) (tri_first + (i))
#define STACK_BASE    stack_base

/* Turns to tree `number`: 0 is the top, mesh m has 1 + m, parts of meshes have those behind. */
void tree_use(uint number)
{
    uint at = ABI_WORLD_TREE * number;
    uvec4 places = world_quad[at], counts = world_quad[at + 1u];
    node_first = places.x;
    item_first = places.y;
    tri_first = places.z;
    job.root = places.w;
    job.node_count = counts.x;
    job.item_count = counts.y;
    job.tri_count = counts.z;
    geometry_first = counts.w;
    geometry_count = world_quad[at + 2u].x;
}

#endif
