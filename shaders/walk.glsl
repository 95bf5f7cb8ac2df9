/* The traversal, the same as ref/trace/trace.c visits, of a ray at a time. The query is a parameter, a
 * constant once the driver has inlined the calls, so that one shader can ask several. Who defines
 * WALK_LISTS before can ask ABI_QUERY_ALL. */
#ifndef WALK_GLSL
#define WALK_GLSL

#include "tri.glsl"
#include "tri_load.glsl"

#ifdef WALK_LISTS
/* QUERY_ALL: hits listed so far, and where the next one goes. */
uint found = 0u;
uint found_at = 0u;
#endif

/* Reasons why an answer must not be believed, ABI_FLAG_*. */
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

/* The ray keeps its length. Past the capacity hits are counted only. */
void list(vec3 tuv, uint prim)
{
#ifdef WALK_LISTS
    if (found < job.capacity)
        hit_quad[found_at + found] = uvec4(floatBitsToUint(tuv), prim);
    found++;
#endif
}

#ifndef STORE_GLSL
/* Items that lie in the nodes name the scene's triangles. */
bool leaf_test(leaf l, uint slot, uint prim, tri_ray r, out vec3 tuv)
{
    vec3 v0, v1, v2;
    tri_load(prim, v0, v1, v2);
    return tri_test_run(TRI_TEST, r, v0, v1, v2, tuv);
}
#endif

/* Tests the items of a leaf in slot order. True if the query is answered. */
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

/* A driver can end a loop before its condition does (lavapipe 22 does after 65,535 iterations), so
 * every loop's condition is looked at again behind it. */
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
