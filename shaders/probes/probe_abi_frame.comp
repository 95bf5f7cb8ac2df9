#version 450
#extension GL_GOOGLE_include_directive : require
/* As probe_abi, for the structs of frames. Every field of two elements holds element * 100 + its
 * word. The push constants are written back word by word, in the order of ref/abi_frame.h. */
#include "ref/abi_frame.h"

layout(local_size_x_id = ABI_SPEC_WORKGROUP) in;
layout(push_constant) uniform Push { frame_push told; };
layout(std430, set = 0, binding = 0) writeonly buffer Tris { shade_tri tris[2]; };
layout(std430, set = 0, binding = 1) writeonly buffer Materials { shade_material materials[2]; };
layout(std430, set = 0, binding = 2) writeonly buffer Lights { shade_light lights[2]; };
layout(std430, set = 0, binding = 3) writeonly buffer Segments { segment segments[2]; };
layout(std430, set = 0, binding = 4) writeonly buffer Words { uint words[32]; };

void write_push()
{
    uint number[16] = uint[](told.root, told.node_count, told.item_count, told.tri_count,
                             told.width, told.height, told.first_row, told.first_tile,
                             told.serial, told.look, told.bounces, told.lights, told.ray,
                             told.part_first, told.part_last, floatBitsToUint(told.ambience));
    for (uint k = 0u; k < 16u; k++)
        words[k] = number[k];
    words[16] = floatBitsToUint(told.tmin);
    words[17] = floatBitsToUint(told.tmax);
    words[18] = floatBitsToUint(told.offset);
    words[19] = floatBitsToUint(told.centre);
    for (uint k = 0u; k < 3u; k++) {
        words[20u + k] = floatBitsToUint(told.pos[k]);
        words[23u + k] = floatBitsToUint(told.right[k]);
        words[26u + k] = floatBitsToUint(told.up[k]);
        words[29u + k] = floatBitsToUint(told.forward[k]);
    }
}

void main()
{
    uint e = gl_GlobalInvocationID.x, name = 100u * e;
    if (e >= 2u)
        return;
    for (uint k = 0u; k < 3u; k++) {
        tris[e].na[k] = float(name + k);
        tris[e].nb[k] = float(name + 4u + k);
        tris[e].nc[k] = float(name + 8u + k);
        tris[e].plane[k] = float(name + 12u + k);
        materials[e].color[k] = float(name + k);
        lights[e].pos[k] = float(name + k);
    }
    tris[e].material = name + 3u;
    tris[e].pad0 = name + 7u;
    tris[e].pad1 = name + 11u;
    tris[e].pad2 = name + 15u;
    materials[e].spec = float(name + 3u);
    materials[e].diffuse = float(name + 4u);
    materials[e].specular = float(name + 5u);
    materials[e].reflective = float(name + 6u);
    materials[e].pad = name + 7u;
    lights[e].strength = float(name + 3u);
    segments[e].t = float(name);
    segments[e].prim = name + 1u;
    segments[e].asked = name + 2u;
    segments[e].shadowed = name + 3u;
    if (e == 0u)
        write_push();
}
