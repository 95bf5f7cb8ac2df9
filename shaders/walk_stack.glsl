/* Traversal with a stack. */
#ifndef WALK_STACK_GLSL
#define WALK_STACK_GLSL

/* The stack: nodes and their entry distances. */
node stack_node[STACK];
float stack_entry[STACK];
uint stack_count = 0u;

void stack_push(node n, float entry)
{
    if (stack_count >= STACK) {
        trouble |= ABI_FLAG_STACK;
    } else {
        stack_node[stack_count] = n;
        stack_entry[stack_count] = entry;
        stack_count++;
    }
}

/* Pops the next node whose entry is not beyond the best hit (RTRS: any node); NODE_DONE if there is
 * none. */
node stack_pop(float tbest)
{
    bool found = false;
    while (both(stack_count > STACK_BASE, !found)) {
        stack_count--;
        found = any(bvec2(BOX_TEST == ABI_BOX_RTRS, stack_entry[stack_count] <= tbest));
    }
    node next = NODE_DONE;
    if (found) {
        next = stack_node[stack_count];
    } else if (stack_count > STACK_BASE) {
        trouble |= ABI_FLAG_LOOP;
    }
    return next;
}

#ifdef WIDE
/* Pushes a child among those of its node, which begin at `base`, with the nearest on top. Of equal
 * ones the first pushed is treated as nearer. */
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
        stack_node[at] = n;
        stack_entry[at] = entry;
        stack_count++;
    }
}

/* Tests the children of an inner node, pushes those that are hit and pops the nearest. */
node step_inner(slab_ray slab, node n, float tbest)
{
    wide w = wide_load(n);
    uint base = stack_count, slot = 0u;
    while (slot < WIDE) {
        vec3 nearer, farther;
        float entry;
        node child = wide_child(slab, w, slot, nearer, farther);
        bool hit = slab_test(slab, nearer, farther, tbest, entry);
#ifdef WIDE_MISSES
        hit = both(hit, !wide_misses(slab, w, slot, tbest));
#endif
        if (both(hit, child.a != NODE_LEAF))
            stack_insert(base, child, entry);
        slot++;
    }
    if (slot < WIDE)
        trouble |= ABI_FLAG_LOOP;
    return stack_pop(tbest);
}
#else
#include "walk_two.glsl"

/* Tests the children of an inner node, returns the next node and pushes the other one. */
node step_inner(slab_ray slab, node n, float tbest)
{
    two t = two_test(slab, n, tbest);
    node next = t.child0, other = t.child1;
    if (t.second) {
        next = t.child1;
        other = t.child0;
    }
    if (both(t.hit0, t.hit1))
        stack_push(other, t.second ? t.entry0 : t.entry1);
    if (both(!t.hit0, !t.hit1))
        next = stack_pop(tbest);
    return next;
}
#endif

node walk_back(slab_ray slab, float tbest)
{
    return stack_pop(tbest);
}

void walk_begin()
{
    stack_count = 0u;
}

#endif
