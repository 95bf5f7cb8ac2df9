#version 450
#extension GL_GOOGLE_include_directive : require
/* Tests every triangle for every ray, as trace_brute and trace_brute_all of ref/trace/trace.c do.
 * There is one ray per invocation and one part of the triangles per dispatch, so that no loop is
 * long enough for a driver to end it early (lavapipe 22 does after 65,535 iterations). Results of
 * earlier parts are passed in buffers that only a tree needs: best hits in that of the nodes,
 * numbers of hits in that of the items.
 *   push.root        first triangle of the part
 *   push.node_count  one past its last
 */
#include "tri.glsl"
#include "tri_load.glsl"

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    vec4 org = ray_quad[2u * id], dir = ray_quad[2u * id + 1u];
    tri_ray r = tri_ray_make(org.xyz, dir.xyz, org.w, dir.w);
    uvec4 best = uvec4(0u, 0u, 0u, ABI_NO_PRIM);
    uint found = 0u;
    if (job.root > 0u) {
        if (QUERY == ABI_QUERY_ALL)
            found = item_word[id];
        else
            best = node_quad[id];
    }
    uint prim = job.root, last = job.node_count;
    bool answered = QUERY == ABI_QUERY_ANY && best.w != ABI_NO_PRIM;
    while (prim < last && !answered) {
        vec3 v0, v1, v2, tuv;
        tri_load(prim, v0, v1, v2);
        if (tri_test_run(TRI_TEST, r, v0, v1, v2, tuv)) {
            if (QUERY == ABI_QUERY_ALL) {
                if (found < job.capacity)
                    hit_quad[id * job.capacity + found] = uvec4(floatBitsToUint(tuv), prim);
                found++;
            } else if (best.w == ABI_NO_PRIM || tuv.x < uintBitsToFloat(best.x)) {
                best = uvec4(floatBitsToUint(tuv), prim);
                answered = QUERY == ABI_QUERY_ANY;
            }
        }
        prim++;
    }
    if (QUERY == ABI_QUERY_ALL)
        found_word[id] = found;
    else
        hit_quad[id] = best;
    bool cut = prim < last && !answered;
    flag_word[id] = ABI_FLAG_DONE | (cut ? ABI_FLAG_EXHAUSTED | ABI_FLAG_LOOP : 0u);
}
