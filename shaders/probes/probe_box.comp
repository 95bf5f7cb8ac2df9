#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i prepares ray i, widens it, places it before the bounds of a scene and runs the box
 * tests on a box. Four quads of floats a ray: lower bound and width; upper bound; bounds of the
 * scene. tmax of the ray is the best t. tests/base/test_vulkan_box.c compares with C what is
 * written: every member of the ray, the ordered bounds, and of each test its entry and its hit. */
#include "slab.glsl"

#define QUADS 10u

uint mask_of(bool a, bool b, bool c, bool d)
{
    return pick(a, 1u, 0u) | pick(b, 2u, 0u) | pick(c, 4u, 0u) | pick(d, 8u, 0u);
}

void main()
{
    uint i = gl_GlobalInvocationID.x, at = i * QUADS;
    if (i >= job.ray_count)
        return;
    vec4 org = ray_quad[2u * i], dir = ray_quad[2u * i + 1u];
    vec4 lo = tri_quad[4u * i];
    vec3 hi = tri_quad[4u * i + 1u].xyz, nearer, farther;
    slab_ray r = slab_ray_make(org.xyz, dir.xyz, org.w);
    float unplaced = r.behind;
    slab_ray_widen(r, lo.w);
    slab_order(r, tri_quad[4u * i + 2u].xyz, tri_quad[4u * i + 3u].xyz, nearer, farther);
    slab_ray_place(r, nearer);
    slab_order(r, lo.xyz, hi, nearer, farther);
    float chosen, robust, watertight, rtrs;
    bool chosen_hit = slab_test(r, nearer, farther, dir.w, chosen);
    bool robust_hit = slab_robust(r, nearer, farther, dir.w, robust);
    bool watertight_hit = slab_watertight(r, nearer, farther, dir.w, watertight);
    bool rtrs_hit = slab_rtrs(r, lo.xyz, hi, rtrs);
    uint hits = mask_of(chosen_hit, robust_hit, watertight_hit, rtrs_hit);
    uint swapped = mask_of(r.swapped.x, r.swapped.y, r.swapped.z, false);
    hit_quad[at] = uvec4(floatBitsToUint(r.o), r.main);
    hit_quad[at + 1u] = floatBitsToUint(vec4(r.d, r.behind));
    hit_quad[at + 2u] = floatBitsToUint(vec4(r.inv, r.tmin));
    hit_quad[at + 3u] = uvec4(floatBitsToUint(r.o_near), swapped);
    hit_quad[at + 4u] = uvec4(floatBitsToUint(r.o_far), hits);
    hit_quad[at + 5u] = floatBitsToUint(vec4(r.pad, chosen));
    hit_quad[at + 6u] = floatBitsToUint(vec4(r.at_most, robust));
    hit_quad[at + 7u] = floatBitsToUint(vec4(r.at_least, watertight));
    hit_quad[at + 8u] = floatBitsToUint(vec4(nearer, rtrs));
    hit_quad[at + 9u] = floatBitsToUint(vec4(farther, unplaced));
}
