/* Tracing, one ray per invocation. */
#define WALK_LISTS
#include "walk.glsl"

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    vec4 org = ray_quad[2u * id], dir = ray_quad[2u * id + 1u];
    slab_ray slab = slab_ray_make(org.xyz, dir.xyz, org.w);
    found_at = id * job.capacity;
    vec3 best = vec3(0.0);
    uint prim = ABI_NO_PRIM;
    float tbest = dir.w;
    if (job.node_count > 0u) {
        vec3 nearer, farther;
        float entry;
        node root = node_load(slab, job.root, nearer, farther);
        slab_ray_place(slab, nearer);
        if (slab_test(slab, nearer, farther, tbest, entry))
            walk(slab, tri_ray_make(org.xyz, dir.xyz, org.w, dir.w), QUERY, root, best, prim,
                 tbest);
    }
    if (QUERY == ABI_QUERY_ALL)
        found_word[id] = found;
    else
        hit_quad[id] = uvec4(floatBitsToUint(best), prim);
    flag_word[id] = ABI_FLAG_DONE | trouble | (trouble != 0u ? ABI_FLAG_EXHAUSTED : 0u);
}
