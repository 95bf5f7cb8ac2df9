/* Reads gathered triangles. */
#ifndef TRI_LOAD_GLSL
#define TRI_LOAD_GLSL

#include "job.glsl"

/* Reads a triangle. Its nine floats lie in three quads and begin at any word of the first. */
void tri_load(uint prim, out vec3 v0, out vec3 v1, out vec3 v2)
{
    uint at = ABI_TRI_FLOATS * TRI_NUMBER(prim);
    vec4 a = tri_quad[at >> 2], b = tri_quad[(at >> 2) + 1u], c = tri_quad[(at >> 2) + 2u];
    bool two = (at & 2u) != 0u, one = (at & 1u) != 0u;
    vec4 d = pick(two, vec4(a.zw, b.xy), a);
    vec4 e = pick(two, vec4(b.zw, c.xy), b);
    vec2 f = pick(two, c.zw, c.xy);
    v0 = pick(one, d.yzw, d.xyz);
    v1 = pick(one, e.xyz, vec3(d.w, e.xy));
    v2 = pick(one, vec3(e.w, f), vec3(e.zw, f.x));
}

#endif
