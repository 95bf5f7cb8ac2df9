/* The state of a path between two of its rays. If paths are traced in steps, it is stored in
 * state_quad[] between dispatches, ABI_STATE_QUADS per pixel after the head:
 *   0 ray's org, phase   2 total, queue     4 N, t        6 diffuse, specular, asked, shadowed
 *   1 ray's dir, far     3 P, prim          5 G, weight   7 segment's dir, queue   8 t, u, v, prim
 * Quad 8 is the best hit in the parts of the triangles so far. The queues do not describe that
 * pixel: entry i of a queue, stored with pixel i, is the i-th pixel whose path has a ray. Even and
 * odd rays use different queues. A dispatch has as many workgroups as its queue needs. */
#ifndef RENDER_STATE_GLSL
#define RENDER_STATE_GLSL

#include "shade.glsl"

#define LIT_NONE lit(0.0, 0.0, 0u, 0u)

struct path {
    bool more;     /* there is a ray to trace */
    bool to_light; /* it is a shadow ray */
    uint segment;
    uint light;
    vec3 org; /* the ray */
    vec3 dir;
    float far; /* the light's distance */
    vec3 along; /* direction of the segment */
    vec3 total;
    float weight;
    surface s; /* the segment's hit */
    float t;
    lit l;
};

/* Bits of a phase. */
#define PHASE_MORE     1u
#define PHASE_TO_LIGHT 2u
#define PHASE_LIGHT    8u  /* the light, from this bit on */
#define PHASE_SEGMENT  16u /* the segment, from this bit on */

path path_begin(vec3 org, vec3 dir)
{
    surface none = surface(vec3(0.0), vec3(0.0), vec3(0.0), ABI_NO_PRIM);
    return path(bounce_count() > 0u, false, 0u, 0u, org, dir, 0.0, dir, vec3(0.0), 1.0, none, 0.0,
                LIT_NONE);
}

vec3 state_vec(uint at)
{
    return uintBitsToFloat(state_quad[at].xyz);
}

void state_put(uint at, vec3 v, uint w)
{
    state_quad[at] = uvec4(floatBitsToUint(v), w);
}

/* Writes three words only, as other invocations may be writing the fourth. */
void state_put3(uint at, vec3 v)
{
    state_quad[at].x = floatBitsToUint(v.x);
    state_quad[at].y = floatBitsToUint(v.y);
    state_quad[at].z = floatBitsToUint(v.z);
}

uint state_at(uint slot)
{
    return ABI_STATE_HEAD + ABI_STATE_QUADS * slot;
}

/* The quad whose fourth word is entry `i` of the queue of ray `ray`. */
uint queue_at(uint ray, uint i)
{
    return state_at(i) + pick((ray & 1u) == 0u, 2u, 7u);
}

/* Adds `slot`, whose path has another ray, to the next queue. */
void queue_add(uint slot)
{
    uint next = job.ray + 1u, i = atomicAdd(state_quad[next].w, 1u);
    if (i % (TILE * TILE) == 0u)
        atomicAdd(state_quad[next].x, 1u);
    state_quad[queue_at(next, i)].w = slot;
}

path path_load(uint at)
{
    path p;
    uint phase = state_quad[at].w;
    p.more = (phase & PHASE_MORE) != 0u;
    p.to_light = (phase & PHASE_TO_LIGHT) != 0u;
    p.light = phase >> PHASE_LIGHT & 255u;
    p.segment = phase >> PHASE_SEGMENT;
    p.org = state_vec(at);
    p.dir = state_vec(at + 1u);
    p.far = uintBitsToFloat(state_quad[at + 1u].w);
    p.total = state_vec(at + 2u);
    p.s = surface(state_vec(at + 3u), state_vec(at + 4u), state_vec(at + 5u),
                  state_quad[at + 3u].w);
    p.t = uintBitsToFloat(state_quad[at + 4u].w);
    p.weight = uintBitsToFloat(state_quad[at + 5u].w);
    uvec4 l = state_quad[at + 6u];
    p.l = lit(uintBitsToFloat(l.x), uintBitsToFloat(l.y), l.z, l.w);
    p.along = state_vec(at + 7u);
    return p;
}

void path_store(uint at, path p)
{
    uint phase = (p.more ? PHASE_MORE : 0u) | (p.to_light ? PHASE_TO_LIGHT : 0u) |
                 p.light << PHASE_LIGHT | p.segment << PHASE_SEGMENT;
    state_put(at, p.org, phase);
    state_put(at + 1u, p.dir, floatBitsToUint(p.far));
    state_put3(at + 2u, p.total);
    state_put(at + 3u, p.s.p, p.s.prim);
    state_put(at + 4u, p.s.n, floatBitsToUint(p.t));
    state_put(at + 5u, p.s.g, floatBitsToUint(p.weight));
    state_quad[at + 6u] =
        uvec4(floatBitsToUint(vec2(p.l.diffuse, p.l.specular)), p.l.asked, p.l.shadowed);
    state_put3(at + 7u, p.along);
}

#endif
