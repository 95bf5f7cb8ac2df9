#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes its identity into every field of every struct of ref/abi.h: struct * 10000 + element * 100
 * + field. tests/base/test_abi.c compares the bytes with C's structs. */
#include "ref/abi.h"

layout(local_size_x_id = ABI_SPEC_WORKGROUP) in;
layout(push_constant) uniform Push { push told; };
layout(std430, set = 0, binding = 0) writeonly buffer Rays { ray rays[2]; };
layout(std430, set = 0, binding = 1) writeonly buffer Hits { hit hits[2]; };
layout(std430, set = 0, binding = 2) writeonly buffer F32 { node_f32 node_f32s[2]; };
layout(std430, set = 0, binding = 3) writeonly buffer Rf { node_rf node_rfs[2]; };
layout(std430, set = 0, binding = 4) writeonly buffer Direct { node_rtrs_direct directs[2]; };
layout(std430, set = 0, binding = 5) writeonly buffer Pushes { push pushes[2]; };

void main()
{
    uint e = gl_GlobalInvocationID.x;
    if (e >= 2u)
        return;
    for (uint k = 0u; k < 3u; k++) {
        rays[e].org[k] = float(10000u + 100u * e + k);
        rays[e].dir[k] = float(10000u + 100u * e + 4u + k);
        node_f32s[e].lo[k] = float(30000u + 100u * e + k);
        node_f32s[e].hi[k] = float(30000u + 100u * e + 4u + k);
        node_rfs[e].bounds[k] = 40000u + 100u * e + k;
        directs[e].lo[k] = float(50000u + 100u * e + 4u + k);
        directs[e].hi[k] = float(50000u + 100u * e + 8u + k);
    }
    rays[e].tmin = float(10003u + 100u * e);
    rays[e].tmax = float(10007u + 100u * e);
    hits[e].t = float(20000u + 100u * e);
    hits[e].u = float(20001u + 100u * e);
    hits[e].v = float(20002u + 100u * e);
    hits[e].prim = 20003u + 100u * e;
    node_f32s[e].first = 30003u + 100u * e;
    node_f32s[e].count = 30007u + 100u * e;
    node_rfs[e].tag = 40003u + 100u * e;
    directs[e].fst = 50000u + 100u * e;
    directs[e].snd = 50001u + 100u * e;
    directs[e].item_first = 50002u + 100u * e;
    directs[e].item_count = 50003u + 100u * e;
    directs[e].pad0 = 50007u + 100u * e;
    directs[e].pad1 = 50011u + 100u * e;
    /* The push constants are written back, each plus the element. */
    pushes[e].ray_count = told.ray_count + e;
    pushes[e].root = told.root + e;
    pushes[e].node_count = told.node_count + e;
    pushes[e].item_count = told.item_count + e;
    pushes[e].tri_count = told.tri_count + e;
    pushes[e].capacity = told.capacity + e;
}
