/* Traversal of a binary tree without a stack, as in ref/trace/trace_walk.h. A trail with one bit
 * per level records whether the other child must still be visited, and links to parents, stored
 * after the items, lead back. */
#ifndef WALK_STACKLESS_GLSL
#define WALK_STACKLESS_GLSL

#include "walk_two.glsl"

uint at = 0u;            /* reference of the current node */
uvec2 trail = uvec2(0u); /* bit i of 64: i levels up the other child is still to visit */
uint level = 0u;

void walk_begin()
{
    at = job.root;
    trail = uvec2(0u);
    level = 0u;
}

/* Returns the next node whose box may contain a nearer hit; NODE_DONE if there is none. */
node walk_back(slab_ray slab, float tbest)
{
    bool found = false;
    node next = NODE_DONE;
    while (both(level > 0u, !found)) {
        uint up = ITEM_WORD(job.item_count + at);
        bool waits = (trail.x & 1u) != 0u;
        vec3 nearer, farther;
        float entry;
        node parent = node_load(slab, up, nearer, farther);
        uint fst = node_fst(parent), snd = node_snd(parent);
        uint other = pick(fst == at, snd, fst);
        if (waits) {
            trail.x ^= 1u;
            node sibling = node_load(slab, other, nearer, farther);
            if (slab_test(slab, nearer, farther, tbest, entry)) {
                next = sibling;
                at = other;
                found = true;
            }
        } else {
            trail = uvec2(trail.x >> 1 | trail.y << 31, trail.y >> 1);
            level--;
            at = up;
        }
    }
    if (both(level > 0u, !found))
        trouble |= ABI_FLAG_LOOP;
    return next;
}

/* Tests the children of an inner node, returns the next node and records the other one in the
 * trail. */
node step_inner(slab_ray slab, node n, float tbest)
{
    two t = two_test(slab, n, tbest);
    node next = t.child0;
    if (t.second)
        next = t.child1;
    if (both(!t.hit0, !t.hit1)) {
        next = walk_back(slab, tbest);
    } else if (level >= ABI_STACK_MAX) {
        trouble |= ABI_FLAG_STACK;
    } else {
        bool waits = both(t.hit0, t.hit1);
        trail = uvec2(trail.x << 1 | pick(waits, 1u, 0u), trail.y << 1 | trail.x >> 31);
        level++;
        at = pick(t.second, t.ref1, t.ref0);
    }
    return next;
}

#endif
