#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
/* Traces one ray per invocation through the driver's own tree and triangle test. Triangles are hit
 * from both sides; the range is open, tmin < t < tmax. Rays that are undefined in the specification
 * (numbers that are not finite, tmin below 0 or above tmax) are misses and are not traced.
 * QUERY_ALL lists candidates and confirms none, so that none ends the ray. */
#include "job.glsl"
#include "query_defined.glsl"

layout(set = 0, binding = ABI_BIND_FOUND + 1) uniform accelerationStructureEXT world;

uvec4 hit_of(float t, vec2 barycentrics, int prim)
{
    return uvec4(floatBitsToUint(vec3(t, barycentrics)), uint(prim));
}

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    vec4 org = ray_quad[2u * id], dir = ray_quad[2u * id + 1u];
    uvec4 answer = uvec4(0u, 0u, 0u, ABI_NO_PRIM);
    uint found = 0u, steps = 0u;
    bool more = false;
    if (is_defined(org, dir)) {
        const uint flags = QUERY == ABI_QUERY_ALL ? gl_RayFlagsNoOpaqueEXT
            : QUERY == ABI_QUERY_ANY ? gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT
                                     : gl_RayFlagsOpaqueEXT;
        rayQueryEXT query;
        rayQueryInitializeEXT(query, world, flags, 0xFFu, org.xyz, org.w, dir.xyz, dir.w);
        more = rayQueryProceedEXT(query);
        while (more && steps < STEPS_MOST) {
            if (QUERY == ABI_QUERY_ALL) {
                if (found < job.capacity)
                    hit_quad[id * job.capacity + found] =
                        hit_of(rayQueryGetIntersectionTEXT(query, false),
                               rayQueryGetIntersectionBarycentricsEXT(query, false),
                               rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
                found++;
            }
            steps++;
            more = rayQueryProceedEXT(query);
        }
        if (QUERY != ABI_QUERY_ALL && rayQueryGetIntersectionTypeEXT(query, true) ==
                                          gl_RayQueryCommittedIntersectionTriangleEXT)
            answer = hit_of(rayQueryGetIntersectionTEXT(query, true),
                            rayQueryGetIntersectionBarycentricsEXT(query, true),
                            rayQueryGetIntersectionPrimitiveIndexEXT(query, true));
    }
    if (QUERY == ABI_QUERY_ALL)
        found_word[id] = found;
    else
        hit_quad[id] = answer;
    flag_word[id] = ABI_FLAG_DONE | (more ? ABI_FLAG_EXHAUSTED | ABI_FLAG_LOOP : 0u);
}
