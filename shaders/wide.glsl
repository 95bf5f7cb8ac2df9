/* Shared by the layouts of wide nodes. Their files define, before they include this,
 *   WIDE                child slots of a node
 *   struct node         with a: NODE_LEAF in a leaf; and NODE_DONE
 *   node node_of(ref)   the inner node of a reference
 *   struct wide, wide wide_load(node)   the record of an inner node
 *   node wide_child(slab_ray, wide, slot, out nearer, out farther)   a child and its bounds, in the
 *                       order in which the ray meets them; NODE_DONE: the slot is empty
 * and, if they define WIDE_MISSES,
 *   bool wide_misses(slab_ray, wide, slot, tbest)   as layout->misses of ref/layout.h */
#ifndef WIDE_GLSL
#define WIDE_GLSL

/* Extends one bound of a union by a box, if the box exists: to the larger or the smaller bound. */
float wide_outer(bool there, bool larger, float have, float also)
{
    float outer = pick(larger, pick(also > have, also, have), pick(also < have, also, have));
    return pick(there, outer, have);
}

/* Returns the root and the union of its children's boxes. */
node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    node root = node_of(ref);
    wide w = wide_load(root);
    vec3 most = vec3(uintBitsToFloat(0x7F7FFFFFu));
    slab_order(r, most, -most, nearer, farther);
    for (uint slot = 0u; slot < WIDE; slot++) {
        vec3 a, b;
        node child = wide_child(r, w, slot, a, b);
        bool there = child.a != NODE_LEAF;
        nearer.x = wide_outer(there, r.swapped.x, nearer.x, a.x);
        nearer.y = wide_outer(there, r.swapped.y, nearer.y, a.y);
        nearer.z = wide_outer(there, r.swapped.z, nearer.z, a.z);
        farther.x = wide_outer(there, !r.swapped.x, farther.x, b.x);
        farther.y = wide_outer(there, !r.swapped.y, farther.y, b.y);
        farther.z = wide_outer(there, !r.swapped.z, farther.z, b.z);
    }
    return root;
}

#endif
