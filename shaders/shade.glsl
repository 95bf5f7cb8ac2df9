/* Points, lights and colours of a path: the operations of ref/frame.h in the same order, each
 * rounded. */
#ifndef SHADE_GLSL
#define SHADE_GLSL

#include "sqrt.glsl"
#include "tri.glsl"
#include "tri_load.glsl"

/* Dot products are computed by tri_sum. */

vec3 unit(vec3 v)
{
    float square = tri_sum(v, v);
    uint bits = floatBitsToUint(square);
    precise vec3 u = v / sqrt_nearest(square);
    return pick(both(bits > 0u, bits < 0x7F800000u), u, vec3(0.0)); /* square is in (0, infinity) */
}

bool is_zero(vec3 v)
{
    return all(equal(v, vec3(0.0)));
}

/* Moves a point off its surface along n, or against n if `back`. */
vec3 moved(vec3 p, vec3 n, bool back)
{
    precise vec3 by = n * job.offset;
    precise vec3 there = p + by;
    precise vec3 behind = p - by;
    return pick(back, behind, there);
}

/* Returns the direction of pixel (x, y); the ray starts at job.pos. */
vec3 pixel_direction(uint x, uint y)
{
    precise float nx = (float(x) + job.centre) / float(job.width) - 0.5;
    precise float ny = (float(job.height - 1u - y) + job.centre) / float(job.height) - 0.5;
    vec3 right = vec3(job.right[0], job.right[1], job.right[2]);
    vec3 up = vec3(job.up[0], job.up[1], job.up[2]);
    vec3 forward = vec3(job.forward[0], job.forward[1], job.forward[2]);
    precise vec3 along = (right * nx + up * ny) + forward;
    return unit(along);
}

vec3 eye()
{
    return vec3(job.pos[0], job.pos[1], job.pos[2]);
}

/* --- what was hit ----------------------------------------------------------------------------- */

struct surface {
    vec3 p;
    vec3 n;    /* shading normal */
    vec3 g;    /* REPAIRED: the plane's normal, towards the ray's start */
    uint prim;
};

struct material {
    vec3 color;
    float exponent;
    float diffuse;
    float specular;
    float reflective;
};

uint shade_at(uint prim)
{
    return ABI_LIGHTS_MOST + 4u * prim;
}

material material_of(uint prim)
{
    uint id = floatBitsToUint(shade_quad[shade_at(prim)].w);
    vec4 a = shade_quad[shade_at(job.tri_count) + 2u * id];
    vec4 b = shade_quad[shade_at(job.tri_count) + 2u * id + 1u];
    return material(a.xyz, a.w, b.x, b.y, b.z);
}

/* The surface at u and v of the triangle test. */
surface surface_repaired(vec3 dir, float u, float v, uint prim)
{
    vec3 a, b, c;
    tri_load(prim, a, b, c);
    uint at = shade_at(prim);
    vec3 na = shade_quad[at].xyz, nb = shade_quad[at + 1u].xyz, nc = shade_quad[at + 2u].xyz;
    vec3 plane = shade_quad[at + 3u].xyz;
    precise vec3 e1 = b - a;
    precise vec3 e2 = c - a;
    precise vec3 p = a + (e1 * u + e2 * v);
    precise float w = (1.0 - u) - v;
    precise vec3 blend = (na * w + nb * u) + nc * v;
    vec3 n = unit(blend);
    precise vec3 minus = -plane;
    vec3 g = pick(tri_sum(plane, dir) > 0.0, minus, plane);
    n = pick(is_zero(n), g, n);
    precise vec3 turned = -n;
    n = pick(tri_sum(n, g) < 0.0, turned, n);
    return surface(p, n, g, prim);
}

surface surface_rtrs(vec3 org, vec3 dir, float t, uint prim)
{
    vec3 a, b, c;
    tri_load(prim, a, b, c);
    uint at = shade_at(prim);
    vec3 na = shade_quad[at].xyz, nb = shade_quad[at + 1u].xyz, nc = shade_quad[at + 2u].xyz;
    precise vec3 e1 = b - a;
    precise vec3 e2 = c - a;
    precise vec3 p = org + dir * t;
    precise vec3 q = p - a;
    float d00 = tri_sum(e1, e1), d01 = tri_sum(e1, e2), d11 = tri_sum(e2, e2);
    float d20 = tri_sum(q, e1), d21 = tri_sum(q, e2);
    precise float den = d00 * d11 - d01 * d01;
    precise float v = (d11 * d20 - d01 * d21) / den;
    precise float w = (d00 * d21 - d01 * d20) / den;
    precise float u = (1.0 - v) - w;
    precise vec3 blend = (na * u + nb * v) + nc * w;
    return surface(p, unit(blend), vec3(0.0), prim);
}

surface surface_of(vec3 org, vec3 dir, vec3 tuv, uint prim)
{
    if (repaired())
        return surface_repaired(dir, tuv.y, tuv.z, prim);
    return surface_rtrs(org, dir, tuv.x, prim);
}

/* --- lights ----------------------------------------------------------------------------------- */

/* The light of a segment so far. */
struct lit {
    float diffuse;
    float specular;
    uint asked;
    uint shadowed;
};

/* Makes the ray from a surface to a light, and returns the light's distance in `far`. Returns false
 * if no ray is needed. */
bool shadow_of(surface s, uint light, out vec3 org, out vec3 dir, out float far)
{
    vec3 pos = pick(both(light == 0u, light_at_eye()), eye(), shade_quad[light].xyz);
    precise vec3 v = pos - s.p;
    dir = unit(v);
    far = sqrt_nearest(tri_sum(v, v));
    float nl = tri_sum(s.n, dir);
    bool sent = !is_zero(dir);
    if (repaired()) {
        org = moved(s.p, s.g, false);
        sent = both(sent, nl > 0.0, tri_sum(s.g, dir) > 0.0);
    } else {
        org = moved(s.p, s.n, nl < 0.0);
    }
    return sent;
}

/* pow(rv, exponent), which Vulkan leaves undefined unless rv is above 0. */
float highlight(float rv, float exponent)
{
    float power = pow(rv, exponent);
    return pick(rv > 0.0, power, pick(both(!repaired(), exponent == 0.0), 1.0, 0.0));
}

/* Adds a light after its shadow ray was traced; t and prim are that ray's hit. `along` is the
 * segment's direction, `dir` the light's. */
void light_add(surface s, vec3 along, vec3 dir, float far, uint light, float t, uint prim,
               inout lit l)
{
    l.asked |= 1u << light;
    bool shadowed = both(prim != ABI_NO_PRIM, any(bvec2(repaired(), t < far)));
    l.shadowed |= pick(shadowed, 1u << light, 0u);
    float strength = shade_quad[light].w, nl = tri_sum(s.n, dir);
    precise float diffuse = l.diffuse + strength * pick(nl > 0.0, nl, 0.0);
    l.diffuse = pick(shadowed, l.diffuse, diffuse);
    material m = material_of(s.prim);
    if (both(has(ABI_LOOK_SPECULAR), m.specular != 0.0, !shadowed)) {
        precise vec3 mirrored = s.n * (2.0 * nl) - dir;
        precise float rv = -tri_sum(mirrored, along);
        precise float specular = l.specular + strength * highlight(rv, m.exponent);
        l.specular = specular;
    }
}

/* --- colours, and the next segment ------------------------------------------------------------ */

/* Adds the light of segment `i` to the path's total. */
vec3 total_with(vec3 total, material m, lit l, float weight, uint i)
{
    vec3 sum;
    if (repaired()) {
        precise float light = pick(has(ABI_LOOK_AMBIENCE), job.ambience, 0.0) + l.diffuse;
        precise vec3 color = (m.color * light) * m.diffuse + l.specular * m.specular;
        precise vec3 with = total + color * weight;
        sum = with;
    } else {
        precise vec3 color = (m.color * l.diffuse) * m.diffuse + l.specular * m.specular;
        precise vec3 weak = color * m.reflective;
        precise vec3 with = total + pick(i > 0u, weak, color);
        sum = with;
    }
    return sum;
}

/* Makes the ray after a segment whose direction was `dir`. Returns false if the path ends. */
bool path_next(surface s, material m, inout vec3 dir, inout float weight, out vec3 org)
{
    bool more = true;
    if (repaired()) {
        precise float less = weight * m.reflective;
        more = less > 0.0;
        weight = less;
    }
    precise vec3 mirrored = dir - s.n * (2.0 * tri_sum(s.n, dir));
    dir = unit(mirrored);
    if (repaired()) {
        org = moved(s.p, s.g, false);
        more = both(more, tri_sum(dir, s.g) > 0.0);
    } else {
        org = moved(s.p, s.n, tri_sum(dir, s.n) < 0.0);
    }
    return both(more, !is_zero(dir));
}

/* Converts a colour channel to 0 .. 255; NaN is 0. */
uint channel(float total)
{
    float kept = pick(total > 0.0, total, 0.0);
    precise float level = 255.0 * pick(kept < 1.0, kept, 1.0) + 0.5;
    return uint(level);
}

#endif
