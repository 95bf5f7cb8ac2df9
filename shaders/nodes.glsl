/* Writes what a layout decodes, for rays of every octant; tests/gpu/test_vulkan_nodes.c compares it
 * with C. An invocation has two words: a reference, and slot | item << 8 | octant << 16. Bit k of
 * the octant: the ray goes down along axis k. It writes five quads:
 *   0  near planes, word a of the node; wide layouts: of the child in the slot
 *   1  far planes, word b
 *   2  leaf: number of its items, the item; else binary layouts: the children
 *   3  near planes of the reference, word a
 *   4  far planes of the reference, word b */
#ifndef NODES_GLSL
#define NODES_GLSL

layout(std430, set = 0, binding = ABI_BIND_ASKED) readonly buffer Questions { uvec2 question[]; };

#ifdef WIDE
#define NODE_B(n) (n).b
#else
#define NODE_B(n) 0u
#endif

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    uint ref = question[id].x, what = question[id].y, octant = what >> 16;
    vec3 direction = vec3(1.0) - 2.0 * vec3(uvec3(octant, octant >> 1, octant >> 2) & 1u);
    slab_ray r = slab_ray_make(vec3(0.0), direction, 0.0);
    vec3 near_all, far_all, nearer, farther;
    node all = node_load(r, ref, near_all, far_all), n = all;
    uvec2 more = uvec2(0u);
    nearer = near_all;
    farther = far_all;
#ifdef WIDE
    n = wide_child(r, wide_load(all), what & 255u, nearer, farther);
#endif
    if ((n.a & NODE_LEAF) != 0u) {
        leaf l = leaf_load(n);
        more = uvec2(l.count, leaf_item(l, what >> 8 & 255u));
    }
#ifndef WIDE
    else
        more = uvec2(node_fst(n), node_snd(n));
#endif
    hit_quad[5u * id] = uvec4(floatBitsToUint(nearer), n.a);
    hit_quad[5u * id + 1u] = uvec4(floatBitsToUint(farther), NODE_B(n));
    hit_quad[5u * id + 2u] = uvec4(more, 0u, 0u);
    hit_quad[5u * id + 3u] = uvec4(floatBitsToUint(near_all), all.a);
    hit_quad[5u * id + 4u] = uvec4(floatBitsToUint(far_all), NODE_B(all));
}

#endif
