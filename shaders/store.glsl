/* Triangle storage, the same as ref/store/: what a leaf of first and count holds, of the layouts
 * whose items lie outside their nodes; they include this before their leaf_load. */
#ifndef STORE_GLSL
#define STORE_GLSL

#include "tri.glsl"
#include "tri_load.glsl"

layout(constant_id = ABI_SPEC_STORE) const uint STORE = ABI_STORE_INDEXED;

struct leaf {
    uint first;
    uint count;
};

/* The triangle of an item, or ABI_NO_PRIM. */
uint leaf_item(leaf l, uint slot)
{
#if MUTANT == MUTANT_SLOTS_WRAPPED
    uint at = l.first + (slot & 1u);
#else
    uint at = l.first + slot;
#endif
    return at < job.item_count ? item_word[at] : ABI_NO_PRIM;
}

/* Whether it is hit; `prim` is its triangle, of the scene. */
bool leaf_test(leaf l, uint slot, uint prim, tri_ray r, out vec3 tuv)
{
    vec3 v0, v1, v2;
    tri_load(prim, v0, v1, v2);
    return tri_test_run(TRI_TEST, r, v0, v1, v2, tuv);
}

#endif
