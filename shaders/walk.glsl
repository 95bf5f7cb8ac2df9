/* The traversal, the same as ref/trace.c visits, of a ray at a time. The query is a parameter, a
 * constant once the driver has inlined the calls, so that one shader can ask several. Who defines
 * WALK_LISTS before can ask ABI_QUERY_ALL. */
#ifndef WALK_GLSL
#define WALK_GLSL

#include "tri.glsl"
#include "tri_load.glsl"

/* The stack: nodes that wait, with their entry distances. */
node stack_node[STACK];
float stack_entry[STACK];
uint stack_count = 0u;

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

void stack_push(node n, float entry)
{
#if MUTANT == MUTANT_SHORT_STACK
    if (stack_count >= STACK - 1u) {
#else
    if (stack_count >= STACK) {
#endif
        trouble |= ABI_FLAG_STACK;
    } else {
#if MUTANT == MUTANT_STACK_WRAPPED
        stack_node[stack_count & 3u] = n;
#else
        stack_node[stack_count] = n;
#endif
        stack_entry[stack_count] = entry;
        stack_count++;
    }
}

/* The next node that can still hold something nearer, or NODE_DONE. */
node stack_pop(float tbest)
{
    bool found = false;
#if MUTANT == MUTANT_BOTTOM_UNREAD
    stack_count -= stack_count == 1u ? 1u : 0u;
#endif
    while (both(stack_count > 0u, !found)) {
        stack_count--;
#if MUTANT == MUTANT_POP_STRICT
        found = any(bvec2(BOX_TEST == ABI_BOX_RTRS, stack_entry[stack_count] < tbest));
#else
        found = any(bvec2(BOX_TEST == ABI_BOX_RTRS, stack_entry[stack_count] <= tbest));
#endif
    }
    node next = NODE_DONE;
    if (found) {
#if MUTANT == MUTANT_STACK_WRAPPED
        next = stack_node[stack_count & 3u];
#else
        next = stack_node[stack_count];
#endif
    } else if (stack_count > 0u) {
        trouble |= ABI_FLAG_LOOP;
    }
    return next;
}

#ifdef WIDE
/* Pushes a child among those of its node, which lie from `base` on, the nearest last; of equal ones
 * the first pushed is taken for nearer. */
void stack_insert(uint base, node n, float entry)
{
    if (stack_count >= STACK) {
        trouble |= ABI_FLAG_STACK;
    } else {
        uint at = stack_count;
        while (both(at > base, stack_entry[pick(at > 0u, at - 1u, 0u)] <= entry)) {
            stack_node[at] = stack_node[at - 1u];
            stack_entry[at] = stack_entry[at - 1u];
            at--;
        }
        if (both(at > base, stack_entry[pick(at > 0u, at - 1u, 0u)] <= entry))
            trouble |= ABI_FLAG_LOOP;
#if MUTANT == MUTANT_WIDE_UNSORTED
        at = stack_count;
#endif
        stack_node[at] = n;
        stack_entry[at] = entry;
        stack_count++;
    }
}

/* The children of an inner node: pushed, and the nearest popped. */
node step_inner(slab_ray slab, node n, float tbest)
{
    wide w = wide_load(n);
    uint base = stack_count, slot = 0u;
    while (slot < WIDE) {
        vec3 nearer, farther;
        float entry;
        node child = wide_child(slab, w, slot, nearer, farther);
        bool hit = slab_test(slab, nearer, farther, tbest, entry);
        if (both(hit, child.a != NODE_LEAF))
            stack_insert(base, child, entry);
        slot++;
    }
    if (slot < WIDE)
        trouble |= ABI_FLAG_LOOP;
#if MUTANT == MUTANT_WIDE_ONE_LOST
    stack_count -= stack_count - base == 5u ? 1u : 0u;
#endif
    return stack_pop(tbest);
}
#else
/* The children of an inner node: the next node, the other one pushed. */
node step_inner(slab_ray slab, node n, float tbest)
{
    uint ref0 = node_fst(n), ref1 = node_snd(n);
    vec3 near0, far0, near1, far1;
    float entry0, entry1;
    node child0 = node_load(slab, ref0, near0, far0);
    node child1 = node_load(slab, ref1, near1, far1);
    bool hit0 = both(slab_test(slab, near0, far0, tbest, entry0), ref0 < job.node_count);
    bool hit1 = both(slab_test(slab, near1, far1, tbest, entry1), ref1 < job.node_count);
#if MUTANT == MUTANT_EQUAL_ENTRY_LOST
    hit1 = hit1 && (!hit0 || entry0 != entry1);
#endif
#if MUTANT == MUTANT_FAR_FIRST
    bool second = hit1 && (!hit0 || entry1 > entry0);
#elif defined(ORDER_NEAR)
    bool second = both(hit1, any(bvec2(!hit0, entry1 < entry0)));
#elif defined(ORDER_SND)
    bool second = hit1;
#else
    bool second = !hit0;
#endif
    node next = child0, other = child1;
    if (second) {
        next = child1;
        other = child0;
    }
#if MUTANT == MUTANT_SWAPPED_CHILD
    other = next;
#endif
    if (both(hit0, hit1))
        stack_push(other, second ? entry0 : entry1);
    if (both(!hit0, !hit1))
        next = stack_pop(tbest);
    return next;
}
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
#if MUTANT == MUTANT_LAST_IS_EMPTY
        prim = prim + 1u == job.tri_count ? ABI_NO_PRIM : prim;
#endif
        if (prim < job.tri_count) {
            vec3 tuv;
            bool hit = leaf_test(l, slot, prim, r, tuv);
            if (query == ABI_QUERY_ALL) {
                if (hit)
                    list(tuv, prim);
#if MUTANT == MUTANT_CULLED_ALL
                if (hit && tuv.x < tbest)
                    tbest = tuv.x;
#endif
#if MUTANT == MUTANT_FIRST_HIT_KEPT
            } else if (hit && best_prim == ABI_NO_PRIM) {
#elif MUTANT == MUTANT_LATER_WINS
            } else if (hit && (best_prim == ABI_NO_PRIM || tuv.x <= tbest)) {
#else
            } else if (both(hit, any(bvec2(best_prim == ABI_NO_PRIM, tuv.x < tbest)))) {
#endif
#if MUTANT == MUTANT_NUMBERS_KEPT
                best = best_prim == ABI_NO_PRIM ? tuv : best;
#else
                best = tuv;
#endif
                best_prim = prim;
                tbest = tuv.x;
                answered = query == ABI_QUERY_ANY;
            }
#if MUTANT == MUTANT_ANY_TOO_EARLY
            answered = query == ABI_QUERY_ANY;
#endif
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
                n = stack_pop(tbest);
        }
    }
    if (!node_is_done(n))
        trouble |= ABI_FLAG_LOOP;
}

#endif
