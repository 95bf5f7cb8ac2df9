/* Instances: which of them a ray meets, the ray in the space of a mesh (ref/world/object_ray.h),
 * and which of its candidates count (ref/world/world.h, ref/world/candidate.h). */
#ifndef WORLD_INSTANCE_GLSL
#define WORLD_INSTANCE_GLSL

#include "filter.glsl"
#include "tri.glsl"
#include "tri_load.glsl"

/* Half of a record: what decides about rays and candidates. Of a part of an instance `mesh` is the
 * number of its tree. */
struct instance {
    uint entry; /* number of the record */
    uint index; /* of the instance */
    uint first;
    uint mesh;
    uint custom_mask;
    uint flags;
};

/* Records of parts are behind those of instances, and the numbers of their instances behind all. */
instance instance_load(uint entry)
{
    uvec4 words = world_quad[world.records + ABI_WORLD_INSTANCE * entry + 3u];
    uint index = entry;
    if (entry >= world.instance_count) {
        uint part = entry - world.instance_count;
        uint owners = world.records + ABI_WORLD_INSTANCE * world.entry_count;
        index = world_quad[owners + part / 4u][part % 4u];
    }
    return instance(entry, index, words.x, words.y, words.z, words.w);
}

/* `mode` is mask and flags of the ray. */
bool instance_is_met(instance i, uvec2 mode)
{
    return both(i.mesh != ABI_NO_PRIM, (i.custom_mask >> 24 & mode.x) != 0u,
                (mode.y & ABI_RAY_SKIP_TRIANGLES) == 0u);
}

/* Origin and direction of the ray in the space of the instance's mesh. */
void instance_ray(instance i, vec3 o, vec3 d, out vec3 moved_o, out vec3 moved_d)
{
    uint at = world.records + ABI_WORLD_INSTANCE * i.entry;
    vec4 a = uintBitsToFloat(world_quad[at]), b = uintBitsToFloat(world_quad[at + 1u]);
    vec4 c = uintBitsToFloat(world_quad[at + 2u]);
    vec3 row0 = a.xyz, row1 = vec3(a.w, b.xy), row2 = vec3(b.zw, c.x);
    precise vec3 x = o - c.yzw;
    vec3 turned_o = vec3(tri_sum(row0, x), tri_sum(row1, x), tri_sum(row2, x));
    vec3 turned_d = vec3(tri_sum(row0, d), tri_sum(row1, d), tri_sum(row2, d));
    bool still = (i.flags & ABI_INSTANCE_IDENTITY) != 0u;
    moved_o = pick(still, o, turned_o);
    moved_d = pick(still, d, turned_d);
}

/* The geometry of a triangle of the mesh: its number, its first triangle, whether it is opaque. */
uvec3 geometry_of(uint prim)
{
    uint from = 0u, to = geometry_count;
    while (to - from > 1u) {
        uint middle = from + (to - from) / 2u;
        bool before = world_quad[world.geometries + geometry_first + middle].x <= prim;
        from = pick(before, middle, from);
        to = pick(before, to, middle);
    }
    if (to - from > 1u)
        trouble |= ABI_FLAG_LOOP;
    uvec4 words = world_quad[world.geometries + geometry_first + from];
    return uvec3(from, words.x, words.z);
}

bool is_opaque(instance i, bool geometry_opaque, uint ray_flags)
{
    bool opaque = any(bvec2(geometry_opaque, (i.flags & ABI_INSTANCE_FORCE_OPAQUE) != 0u));
    opaque = both(opaque, (i.flags & ABI_INSTANCE_FORCE_NO_OPAQUE) == 0u);
    opaque = any(bvec2(opaque, (ray_flags & ABI_RAY_OPAQUE) != 0u));
    return both(opaque, (ray_flags & ABI_RAY_NO_OPAQUE) == 0u);
}

bool is_culled(instance i, bool opaque, bool front, uint ray_flags)
{
    uint by_opacity = pick(opaque, ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE);
    uint by_side = pick(front, ABI_RAY_CULL_FRONT, ABI_RAY_CULL_BACK);
    bool by_facing = both((ray_flags & by_side) != 0u,
                          (i.flags & ABI_INSTANCE_CULL_DISABLE) == 0u);
    return any(bvec2((ray_flags & by_opacity) != 0u, by_facing));
}

/* Decides about a hit of triangle `prim` of the mesh; `tag` is for one that counts. */
bool candidate_counts(instance i, uint ray_flags, vec3 d, uint prim, vec3 tuv, out uint tag)
{
    vec3 v0, v1, v2;
    tri_load(prim, v0, v1, v2);
    precise vec3 a = v1 - v0;
    precise vec3 b = v2 - v0;
    float side = tri_sum(d, tri_cross(a, b));
    uvec3 geometry = geometry_of(prim);
    bool opaque = is_opaque(i, geometry.z != 0u, ray_flags);
    bool front = (side < 0.0) != ((i.flags & ABI_INSTANCE_FLIP_FACING) != 0u);
    tag = (i.custom_mask & ABI_TAG_CUSTOM) | pick(front, ABI_TAG_FRONT, 0u);
    bool passes = filter_passes(i.index, geometry.x, prim - geometry.y, tuv.yz);
    return both(any(bvec2(opaque, passes)), !is_culled(i, opaque, front, ray_flags));
}

#endif
