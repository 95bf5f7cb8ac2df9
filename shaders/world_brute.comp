#version 450
#extension GL_GOOGLE_include_directive : require
/* Tests every triangle of every instance for every ray, as trace_world_brute and
 * trace_world_brute_all of ref/trace/trace_world.h do: one ray per invocation and one part of the
 * placed triangles per dispatch, as trace_brute.comp. Results of earlier parts are passed in
 * buffers that only trees need: best hits in that of the nodes, numbers of hits in that of the
 * items. */
#define WORLDS
#include "job.glsl"

uint trouble = 0u;

#include "world_instance.glsl"

/* The ray in the instance that it is in. */
instance at;
tri_ray tri;

/* Enters an instance, if the ray meets it. `end` is the number behind its last triangle: where the
 * next instance begins. One that is not active has triangles, too, if it has a mesh. */
bool enter(uint index, vec4 org, vec4 dir, uvec2 mode, out uint end)
{
    at = instance_load(index);
    end = world.last;
    if (index + 1u < world.instance_count)
        end = instance_load(index + 1u).first;
    if (at.mesh != ABI_NO_PRIM) {
        vec3 o, d;
        tree_use(1u + at.mesh);
        instance_ray(at, org.xyz, dir.xyz, o, d);
        tri = tri_ray_make(o, d, org.w, dir.w);
    }
    return instance_is_met(at, mode);
}

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= world.ray_count)
        return;
    vec4 org = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id]);
    vec4 dir = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id + 1u]);
    uvec2 mode = ray_quad[ABI_WORLD_RAY * id + 2u].xy;
    bool ends = QUERY == ABI_QUERY_ANY ||
        both(QUERY == ABI_QUERY_CLOSEST, (mode.y & ABI_RAY_FIRST) != 0u);
    uvec4 best = uvec4(0u, 0u, 0u, ABI_NO_PRIM);
    uint best_tag = 0u, found = 0u;
    if (world.first > 0u) {
        if (QUERY == ABI_QUERY_ALL) {
            found = item_word[id];
        } else {
            best = node_quad[ABI_WORLD_HIT * id];
            best_tag = node_quad[ABI_WORLD_HIT * id + 1u].x;
        }
    }
    uint number = world.first, end = number, index = world.index;
    bool met = false, answered = both(ends, best.w != ABI_NO_PRIM);
    while (both(number < world.last, !answered)) {
        if (number >= end) {
            met = enter(index, org, dir, mode, end);
            index++;
            if (!met)
                number = end;
        } else {
            vec3 v0, v1, v2, tuv;
            uint tag, prim = number - at.first;
            tri_load(prim, v0, v1, v2);
            bool hit = tri_test_run(TRI_TEST, tri, v0, v1, v2, tuv);
            bool nearer =
                any(bvec2(best.w == ABI_NO_PRIM, tuv.x < uintBitsToFloat(best.x)));
            if (both(hit, nearer)) {
                if (candidate_counts(at, mode.y, tri.d, prim, tuv, tag)) {
                    if (QUERY == ABI_QUERY_ALL) {
                        if (found < world.capacity) {
                            uint place = ABI_WORLD_HIT * (id * world.capacity + found);
                            hit_quad[place] = uvec4(floatBitsToUint(tuv), number);
                            hit_quad[place + 1u] = uvec4(tag, 0u, 0u, 0u);
                        }
                        found++;
                    } else {
                        best = uvec4(floatBitsToUint(tuv), number);
                        best_tag = tag;
                        answered = ends;
                    }
                }
            }
            number++;
        }
    }
    if (both(number < world.last, !answered))
        trouble |= ABI_FLAG_LOOP;
    if (QUERY == ABI_QUERY_ALL) {
        found_word[id] = found;
    } else {
        hit_quad[ABI_WORLD_HIT * id] = best;
        hit_quad[ABI_WORLD_HIT * id + 1u] = uvec4(best_tag, 0u, 0u, 0u);
    }
    flag_word[id] = ABI_FLAG_DONE | trouble | (trouble != 0u ? ABI_FLAG_EXHAUSTED : 0u);
}
