/* Layouts amd64: box nodes of AMD's hardware, 64 bytes with float16 or 128 with float32. See
 * ref/layouts/layout_amd64.c for the words. */
#define WIDE 4u
#include "half.glsl"
#include "wide_leaf.glsl"

struct wide {
    uvec4 child;
    uint at; /* first quad */
    bool f32;
};

/* The node of a reference; b of an inner node is 1 if its boxes are float32. There are ten
 * references per record. */
node node_of(uint ref)
{
    uint records = job.node_count / 10u;
    return node(pick(ref < records, ref, ref - records), ref < records ? 0u : 1u);
}

wide wide_load(node n)
{
    return wide(NODE_QUAD(4u * n.a), 4u * n.a, n.b != 0u);
}

/* Returns words `skip` to `skip` + 3 of the eight words a, b. */
uvec4 words_from(uvec4 a, uvec4 b, uint skip)
{
    uvec4 c = uvec4(pick((skip & 1u) == 0u, a.x, a.y), pick((skip & 1u) == 0u, a.y, a.z),
                    pick((skip & 1u) == 0u, a.z, a.w), pick((skip & 1u) == 0u, a.w, b.x));
    uint d = pick((skip & 1u) == 0u, b.x, b.y), e = pick((skip & 1u) == 0u, b.y, b.z);
    bool near = skip < 2u;
    return uvec4(pick(near, c.x, c.z), pick(near, c.y, c.w), pick(near, c.z, d),
                 pick(near, c.w, e));
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    /* After the first quad each box has 3 or 6 words. */
    uint word = pick(w.f32, 6u * slot, 3u * slot);
    uint quad = word >> 2, skip = word & 3u;
    uvec4 first = NODE_QUAD(w.at + 1u + quad);
    uvec4 second = NODE_QUAD(w.at + 1u + pick(any(bvec2(w.f32, skip > 1u)), quad + 1u, quad));
    uvec4 bits = words_from(first, second, skip);
    uvec2 more = uvec2(pick(skip == 0u, second.x, second.z), pick(skip == 0u, second.y, second.w));
    vec3 lo32 = uintBitsToFloat(bits.xyz);
    vec3 hi32 = uintBitsToFloat(uvec3(bits.w, more));
    vec3 lo16 =
        vec3(half_any(bits.x & 0xFFFFu), half_any(bits.x >> 16), half_any(bits.y & 0xFFFFu));
    vec3 hi16 = vec3(half_any(bits.y >> 16), half_any(bits.z & 0xFFFFu), half_any(bits.z >> 16));
    vec3 lo = pick(w.f32, lo32, lo16);
    vec3 hi = pick(w.f32, hi32, hi16);
    slab_order(r, lo, hi, nearer, farther);
    uint child = quad_word(w.child, slot);
    uint type = child & 7u, at = child >> 3;
    bool inner = both(type >= 4u, type <= 5u);
    uint leaf_bits = NODE_LEAF | pick(type < 4u, type + 1u, 0u);
    return node(pick(inner, at, leaf_bits), pick(inner, type - 4u, at));
}

#include "wide.glsl"
