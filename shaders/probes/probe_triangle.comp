#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i prepares ray i and runs the triangle tests on a triangle. Three quads of floats a
 * ray: the vertices, and beside them a threshold and a t. tests/base/test_vulkan_triangle.c
 * compares with C what is written: every member of the ray, in whose range that t lies, of each
 * test, of those of stored triangles and of woop's in any range whether it hits, and then t, u and
 * v; and the transform. */
#include "tri.glsl"

#define QUADS 15u

/* The numbers of a miss are undefined. */
uvec4 told(bool hit, vec3 tuv)
{
    return uvec4(pick(hit, 1u, 0u), floatBitsToUint(pick(hit, tuv, vec3(0.0))));
}

void main()
{
    uint i = gl_GlobalInvocationID.x, at = i * QUADS;
    if (i >= job.ray_count)
        return;
    vec4 org = ray_quad[2u * i], dir = ray_quad[2u * i + 1u];
    vec4 a = tri_quad[3u * i], b = tri_quad[3u * i + 1u], c = tri_quad[3u * i + 2u];
    vec3 v0 = a.xyz, v1 = b.xyz, v2 = c.xyz, tuv, u, w, h;
    tri_ray r = tri_ray_make(org.xyz, dir.xyz, org.w, dir.w);
    uint in_range = 0u;
    for (uint id = 0u; id < 5u; id++) {
        in_range |= pick(tri_in_range(id, r, b.w), 1u << id, 0u);
        bool hit = tri_test_run(id, r, v0, v1, v2, tuv);
        hit_quad[at + 4u + id] = told(hit, tuv);
    }
    hit_quad[at] = floatBitsToUint(vec4(r.o, 0.0));
    hit_quad[at + 1u] = floatBitsToUint(vec4(r.d, r.tmin));
    hit_quad[at + 2u] = floatBitsToUint(vec4(r.shear, r.tmax));
    hit_quad[at + 3u] = uvec4(r.axis, in_range);
    precise vec3 e1 = v1 - v0;
    precise vec3 e2 = v2 - v0;
    bool edges_hit = tri_moeller_trumbore_edges(r, v0, e1, e2, a.w, tuv);
    hit_quad[at + 9u] = told(edges_hit, tuv);
    uint axis = baldwin_webber_transform(v0, v1, v2, u, w, h);
    bool stored_hit = baldwin_webber_hit(r, u, w, h, axis, tuv);
    hit_quad[at + 10u] = told(stored_hit, tuv);
    hit_quad[at + 11u] = uvec4(floatBitsToUint(u), axis);
    hit_quad[at + 12u] = uvec4(floatBitsToUint(w), 0u);
    hit_quad[at + 13u] = uvec4(floatBitsToUint(h), 0u);
    bool woop_hit = tri_woop(r, v0, v1, v2, tuv);
    hit_quad[at + 14u] = told(woop_hit, tuv);
}
