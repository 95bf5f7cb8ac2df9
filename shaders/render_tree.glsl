/* Rendering with a tree. The file of a layout is included before. */
#include "walk.glsl"

/* Finds the closest or any hit in [tmin, tmax]: t, u, v and the triangle, or ABI_NO_PRIM. */
void answer(uint query, vec3 org, vec3 dir, float tmin, float tmax, inout vec3 tuv,
            inout uint prim)
{
    if (job.node_count > 0u) {
        slab_ray slab = slab_ray_make(org, dir, tmin);
        vec3 nearer, farther;
        float entry, tbest = tmax;
        node root = node_load(slab, job.root, nearer, farther);
        slab_ray_place(slab, nearer);
        if (slab_test(slab, nearer, farther, tbest, entry))
            walk(slab, tri_ray_make(org, dir, tmin, tmax), query, root, tuv, prim, tbest);
    }
}

#include "render.glsl"
