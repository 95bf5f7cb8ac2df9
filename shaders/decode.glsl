/* Writes what a layout's GLSL decodes, one slot of a record per invocation, for comparison with its
 * C code (gpu/trace/decode.c). No ray is traced. Bounds are in the order in which a ray along (1,
 * 1, 1) meets them: lower, then upper. */
#ifndef DECODE_GLSL
#define DECODE_GLSL

layout(std430, set = 0, binding = ABI_BIND_ASKED) readonly buffer Asked { uvec2 asked[]; };

#ifdef WIDE
uint decode_kind(node n)
{
    return n.a == NODE_LEAF ? ABI_DECODED_NONE
           : (n.a & NODE_LEAF) != 0u ? ABI_DECODED_LEAF
                                     : ABI_DECODED_INNER;
}

uint decode_mix(uint sum, uint word)
{
    return (sum ^ word) * 16777619u;
}

/* A hash of an inner node's children in one word. Two references whose nodes have the same hash
 * cannot be told apart at this level. */
uint decode_sum(slab_ray r, node n)
{
    wide w = wide_load(n);
    uint sum = 2166136261u;
    for (uint slot = 0u; slot < WIDE; slot++) {
        vec3 lo, hi;
        node child = wide_child(r, w, slot, lo, hi);
        uint kind = decode_kind(child);
        uvec3 low = floatBitsToUint(lo), high = floatBitsToUint(hi);
        sum = decode_mix(sum, kind);
        if (kind != ABI_DECODED_NONE) {
            sum = decode_mix(decode_mix(decode_mix(sum, low.x), low.y), low.z);
            sum = decode_mix(decode_mix(decode_mix(sum, high.x), high.y), high.z);
        }
        if (kind == ABI_DECODED_LEAF) {
            leaf l = leaf_load(child);
            sum = decode_mix(decode_mix(sum, l.count), leaf_item(l, 0u));
        }
    }
    return sum;
}

/* Slot s of a record and item i of that slot, requested as i * WIDE + s. */
void decode(slab_ray r, uvec2 what, out uvec4 low, out uvec4 high, out uvec4 more)
{
    vec3 lo, hi;
    node record = node_of(what.x);
    node child = wide_child(r, wide_load(record), what.y % WIDE, lo, hi);
    uint kind = decode_kind(child), item = what.y / WIDE;
    low = uvec4(floatBitsToUint(lo), kind);
    high = uvec4(floatBitsToUint(hi), 0u);
    more = uvec4(ABI_NO_PRIM, 0u, decode_sum(r, record), child.a);
    if (kind == ABI_DECODED_LEAF) {
        leaf l = leaf_load(child);
        high.w = l.count;
        if (item < l.count)
            more.x = leaf_item(l, item);
    } else if (kind == ABI_DECODED_INNER) {
        more.y = decode_sum(r, child);
    }
}
#else
/* Item i of a record, or its children. */
void decode(slab_ray r, uvec2 what, out uvec4 low, out uvec4 high, out uvec4 more)
{
    vec3 lo, hi;
    node n = node_load(r, what.x, lo, hi);
    bool is_leaf = (n.a & NODE_LEAF) != 0u;
    low = uvec4(floatBitsToUint(lo), is_leaf ? ABI_DECODED_LEAF : ABI_DECODED_INNER);
    high = uvec4(floatBitsToUint(hi), 0u);
    more = uvec4(ABI_NO_PRIM, 0u, 0u, n.a);
    if (is_leaf) {
        leaf l = leaf_load(n);
        high.w = l.count;
        if (what.y < l.count)
            more.x = leaf_item(l, what.y);
    } else {
        more.x = node_fst(n);
        more.y = node_snd(n);
    }
}
#endif

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    uvec4 low, high, more;
    decode(slab_ray_make(vec3(0.0), vec3(1.0), 0.0), asked[id], low, high, more);
    hit_quad[3u * id] = low;
    hit_quad[3u * id + 1u] = high;
    hit_quad[3u * id + 2u] = more;
}

#endif
