#version 450
#extension GL_GOOGLE_include_directive : require
/* Rendering without a tree: tests every triangle for every ray. If paths are traced in steps, a
 * dispatch tests triangles job.part_first to job.part_last - 1, so that no loop is long enough for
 * a driver to end it early. */
#define RENDERING
#include "tri.glsl"
#include "tri_load.glsl"

/* ABI_FLAG_* of errors that make the result invalid. */
uint trouble = 0u;

/* Continues from the best hit in earlier parts. */
void answer(uint query, vec3 org, vec3 dir, float tmin, float tmax, inout vec3 tuv,
            inout uint prim)
{
    tri_ray r = tri_ray_make(org, dir, tmin, tmax);
    uint at = job.part_first;
    bool answered = both(query == ABI_QUERY_ANY, prim != ABI_NO_PRIM);
    while (both(at < job.part_last, !answered)) {
        vec3 v0, v1, v2, here;
        tri_load(at, v0, v1, v2);
        bool hit = tri_test_run(TRI_TEST, r, v0, v1, v2, here);
        if (both(hit, any(bvec2(prim == ABI_NO_PRIM, here.x < tuv.x)))) {
            tuv = here;
            prim = at;
            answered = query == ABI_QUERY_ANY;
        }
        at++;
    }
    if (both(at < job.part_last, !answered))
        trouble |= ABI_FLAG_LOOP;
}

#include "render.glsl"
