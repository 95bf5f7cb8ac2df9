#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
#extension GL_EXT_ray_flags_primitive_culling : require
/* Traces one ray per invocation through the driver's own trees of a world, with the mask and the
 * flags of the ray. The range is open, tmin < t < tmax. Rays that are undefined in the
 * specification are misses and are not traced. What the driver calls not opaque is confirmed by the
 * filter. QUERY_ALL lists candidates and confirms none, so that none ends the ray. For that the
 * driver takes all of them for not opaque, and opacity and its culling are decided here. */
#define WORLDS
#include "job.glsl"
#include "filter.glsl"
#include "query_defined.glsl"

layout(primitive_culling);
layout(set = 0, binding = ABI_BIND_STRUCTURE) uniform accelerationStructureEXT structure;

#define OPACITY_FLAGS (ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE | ABI_RAY_CULL_OPAQUE | \
                       ABI_RAY_CULL_NO_OPAQUE | ABI_RAY_FIRST)

/* An intersection as the driver reports it. */
struct meeting {
    vec3 tuv;
    uint index, geometry, tri, custom;
    bool front;
};

/* The quad of an instance, zeros if there is none of that number. */
uvec4 instance_quad(uint index)
{
    return index < world.instance_count ? world_quad[world.records + index] : uvec4(0u);
}

/* The quad of a geometry, zeros if the instance has none of that number. */
uvec4 geometry_quad(uvec4 of, uint number)
{
    return number < of.z ? world_quad[world.geometries + of.y + number] : uvec4(0u);
}

/* The number of the placed triangle; ABI_PHANTOM if there is none. */
uint placed_number(meeting m)
{
    uvec4 of = instance_quad(m.index);
    uvec4 geometry = geometry_quad(of, m.geometry);
    return m.tri < geometry.y ? of.x + geometry.x + m.tri : ABI_PHANTOM;
}

uint tag_of(meeting m)
{
    return (m.custom & ABI_TAG_CUSTOM) | (m.front ? ABI_TAG_FRONT : 0u);
}

void put_hit(uint place, meeting m)
{
    hit_quad[ABI_WORLD_HIT * place] = uvec4(floatBitsToUint(m.tuv), placed_number(m));
    hit_quad[ABI_WORLD_HIT * place + 1u] = uvec4(tag_of(m), 0u, 0u, 0u);
}

/* A number that the world does not have passes, so that it is seen. */
bool passes(meeting m)
{
    return placed_number(m) == ABI_PHANTOM ||
        filter_passes(m.index, m.geometry, m.tri, m.tuv.yz);
}

/* Whether a candidate is listed. */
bool is_listed(meeting m, uint flags)
{
    uvec4 of = instance_quad(m.index);
    bool opaque = geometry_quad(of, m.geometry).z != 0u;
    if ((of.w & (ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE)) != 0u)
        opaque = (of.w & ABI_INSTANCE_FORCE_OPAQUE) != 0u;
    if ((flags & (ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE)) != 0u)
        opaque = (flags & ABI_RAY_OPAQUE) != 0u;
    uint cull = opaque ? ABI_RAY_CULL_OPAQUE : ABI_RAY_CULL_NO_OPAQUE;
    return (flags & cull) == 0u && (opaque || passes(m));
}

#define MEETING(query, committed)                                                                  \
    meeting(vec3(rayQueryGetIntersectionTEXT(query, committed),                                    \
                 rayQueryGetIntersectionBarycentricsEXT(query, committed)),                        \
            uint(rayQueryGetIntersectionInstanceIdEXT(query, committed)),                          \
            uint(rayQueryGetIntersectionGeometryIndexEXT(query, committed)),                       \
            uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, committed)),                      \
            uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, committed)),                 \
            rayQueryGetIntersectionFrontFaceEXT(query, committed))

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= world.ray_count)
        return;
    vec4 org = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id]);
    vec4 dir = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id + 1u]);
    uvec2 mode = ray_quad[ABI_WORLD_RAY * id + 2u].xy;
    uint found = 0u, steps = 0u;
    bool more = false, answered = false;
    if (is_defined(org, dir)) {
        uint flags = mode.y;
        if (QUERY == ABI_QUERY_ALL)
            flags = (flags & ~OPACITY_FLAGS) | ABI_RAY_NO_OPAQUE;
        if (QUERY == ABI_QUERY_ANY)
            flags |= ABI_RAY_FIRST;
        rayQueryEXT query;
        rayQueryInitializeEXT(query, structure, flags, mode.x, org.xyz, org.w, dir.xyz, dir.w);
        more = rayQueryProceedEXT(query);
        while (more && steps < STEPS_MOST) {
            meeting candidate = MEETING(query, false);
            if (QUERY == ABI_QUERY_ALL) {
                if (is_listed(candidate, mode.y)) {
                    if (found < world.capacity)
                        put_hit(id * world.capacity + found, candidate);
                    found++;
                }
            } else if (passes(candidate)) {
                rayQueryConfirmIntersectionEXT(query);
            }
            steps++;
            more = rayQueryProceedEXT(query);
        }
        if (QUERY != ABI_QUERY_ALL && rayQueryGetIntersectionTypeEXT(query, true) ==
                                          gl_RayQueryCommittedIntersectionTriangleEXT) {
            meeting closest = MEETING(query, true);
            put_hit(id, closest);
            answered = true;
        }
    }
    if (QUERY == ABI_QUERY_ALL) {
        found_word[id] = found;
    } else if (!answered) {
        hit_quad[ABI_WORLD_HIT * id] = uvec4(0u, 0u, 0u, ABI_NO_PRIM);
        hit_quad[ABI_WORLD_HIT * id + 1u] = uvec4(0u);
    }
    flag_word[id] = ABI_FLAG_DONE | (more ? ABI_FLAG_EXHAUSTED | ABI_FLAG_LOOP : 0u);
}
