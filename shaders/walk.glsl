/* The traversal of one ray, in the same order as ref/trace/trace.c. The query is a parameter, which
 * is constant once the driver has inlined the calls, so that one shader can use several. WALK_LISTS
 * must be defined before for ABI_QUERY_ALL. */
#ifndef WALK_GLSL
#define WALK_GLSL

#include "tri.glsl"
#include "tri_load.glsl"

#ifdef WALK_LISTS
/* QUERY_ALL: number of hits, and the index of the first in the list. */
uint found = 0u;
uint found_at = 0u;
#endif

/* ABI_FLAG_* of errors that make the result invalid. */
uint trouble = 0u;

bool node_is_leaf(node n)
{
    return (n.a & NODE_LEAF) != 0u;
}

/* NODE_DONE, a leaf without items, ends a walk. */
bool node_is_done(node n)
{
    return n.a == NODE_LEAF;
}

#ifdef STACKLESS
#include "walk_stackless.glsl"
#else
#include "walk_stack.glsl"
#endif

/* Adds a hit to the list; the ray keeps its length. Hits beyond the capacity are only counted. */
void list(vec3 tuv, uint prim)
{
#ifdef WALK_LISTS
    if (found < job.capacity)
        hit_quad[found_at + found] = uvec4(floatBitsToUint(tuv), prim);
    found++;
#endif
}

#ifndef STORE_GLSL
/* Tests an item that is stored in its node; `prim` is its triangle in the scene. */
bool leaf_test(leaf l, uint slot, uint prim, tri_ray r, out vec3 tuv)
{
    vec3 v0, v1, v2;
    tri_load(prim, v0, v1, v2);
    return tri_test_run(TRI_TEST, r, v0, v1, v2, tuv);
}
#endif

/* Tests the items of a leaf in slot order. Returns true if the ray is finished. */
bool step_leaf(tri_ray r, uint query, node n, inout vec3 best, inout uint best_prim,
               inout float tbest)
{
    leaf l = leaf_load(n);
    uint slot = 0u;
    bool answered = false;
    while (both(slot < l.count, !answered)) {
        uint prim = leaf_item(l, slot);
        if (prim < job.tri_count) {
            vec3 tuv;
            bool hit = leaf_test(l, slot, prim, r, tuv);
            if (query == ABI_QUERY_ALL) {
                if (hit)
                    list(tuv, prim);
            } else if (both(hit, any(bvec2(best_prim == ABI_NO_PRIM, tuv.x < tbest)))) {
                best = tuv;
                best_prim = prim;
                tbest = tuv.x;
                answered = query == ABI_QUERY_ANY;
            }
        }
        slot++;
    }
    if (both(slot < l.count, !answered))
        trouble |= ABI_FLAG_LOOP;
    return answered;
}

/* Traverses the tree from node n. A driver can end a loop before its condition does (lavapipe 22
 * does after 65,535 iterations), so every loop's condition is checked again after the loop. */
void walk(slab_ray slab, tri_ray tri, uint query, node n, inout vec3 best, inout uint prim,
          inout float tbest)
{
    uint visits = 0u;
    walk_begin();
    while (both(!node_is_done(n), trouble == 0u)) {
        while (both(!node_is_leaf(n), visits < job.node_count)) {
            visits++;
            n = step_inner(slab, n, tbest);
        }
        if (!node_is_leaf(n)) {
            trouble |= visits < job.node_count ? ABI_FLAG_LOOP : ABI_FLAG_VISITS;
        } else if (!node_is_done(n)) {
            if (visits >= job.node_count)
                trouble |= ABI_FLAG_VISITS;
            visits++;
            if (step_leaf(tri, query, n, best, prim, tbest))
                n = NODE_DONE;
            else
                n = walk_back(slab, tbest);
        }
    }
    if (!node_is_done(n))
        trouble |= ABI_FLAG_LOOP;
}

#endif
