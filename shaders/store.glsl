/* Triangle storage, as in ref/store/: reads the items of a leaf of first and count. For layouts
 * whose items are not in their nodes, which include this before their leaf_load. */
#ifndef STORE_GLSL
#define STORE_GLSL

#include "tri.glsl"
#include "tri_load.glsl"

layout(constant_id = ABI_SPEC_STORE) const uint STORE = ABI_STORE_INDEXED;

#define STORE_ROW 10u /* words of a row: nine floats and a number */

struct leaf {
    uint first;
    uint count;
};

/* Reads a word; out of range it reads word 0. */
uint store_word(uint at)
{
    return ITEM_WORD(pick(at < job.item_count, at, 0u));
}

vec3 store_vec(uint at, uint stride)
{
    return uintBitsToFloat(
        uvec3(store_word(at), store_word(at + stride), store_word(at + 2u * stride)));
}

#include "store_quantised.glsl"
#include "store_dgf1.glsl"

/* Returns the larger of each two bytes, which are at most 15. */
uint store_larger(uint a, uint b)
{
    uint not_less = (((a | 0x10101010u) - b) >> 4) & 0x01010101u;
    uint mask = not_less * 15u;
    return (a & mask) | (b & ~mask & 0x0F0F0F0Fu);
}

uint store_halves(uint word)
{
    return store_larger(word & 0x0F0F0F0Fu, (word >> 4) & 0x0F0F0F0Fu);
}

/* Returns the number of vertices of the block at `first`: its largest corner plus one. */
uint block_vertices(uint first)
{
    uint most = store_larger(
        store_halves(store_word(first)),
        store_larger(store_halves(store_word(first + 1u)), store_halves(store_word(first + 2u))));
    most = store_larger(most, most >> 16);
    most = store_larger(most, most >> 8);
    return (most & 15u) + 1u;
}

vec3 block_vertex(uint first, uint vertices, uint corner, uint slot)
{
    uint at = (store_word(first + corner) >> ((slot & 7u) * 4u)) & 15u;
    return store_vec(first + 3u + at, vertices);
}

/* Returns the triangle of an item, or ABI_NO_PRIM. */
uint leaf_item(leaf l, uint slot)
{
    if (STORE == ABI_STORE_QUANTISED) {
        quantised q = quantised_of(l.first, slot);
        uint prim = quantised_bits(l.first, q.number_at + q.number * slot, q.number);
        return pick(q.there, prim, ABI_NO_PRIM);
    }
    if (STORE == ABI_STORE_TRUNCATED) {
        truncated t = truncated_of(l.first, slot);
        uint prim = truncated_bits(l.first, t.number_at + t.number * slot, t.number);
        return pick(t.there, prim, ABI_NO_PRIM);
    }
    if (STORE == ABI_STORE_DGF1) {
        dense d = dense_of(l.first, slot);
        uint prim = truncated_bits(l.first, d.end + (d.number + 2u) * slot, d.number);
        return pick(d.there, prim, ABI_NO_PRIM);
    }
    uint at = l.first + slot;
    uint mask = 0xFFFFFFFFu;
    if (STORE == ABI_STORE_COMPACT) {
        at = l.first + 3u + 3u * block_vertices(l.first) + slot;
    } else if (STORE != ABI_STORE_INDEXED) {
        at = l.first + STORE_ROW * slot + 9u;
        mask = 0x3FFFFFFFu;
    }
    return at < job.item_count ? ITEM_WORD(at) & mask : ABI_NO_PRIM;
}

/* Tests an item; `prim` is its triangle in the scene. */
bool leaf_test(leaf l, uint slot, uint prim, tri_ray r, out vec3 tuv)
{
    bool hit;
    uint row = l.first + STORE_ROW * slot;
    if (STORE == ABI_STORE_INDEXED) {
        vec3 v0, v1, v2;
        tri_load(prim, v0, v1, v2);
        hit = tri_test_run(TRI_TEST, r, v0, v1, v2, tuv);
    } else if (STORE == ABI_STORE_COMPACT) {
        uint vertices = block_vertices(l.first);
        hit = tri_test_run(TRI_TEST, r, block_vertex(l.first, vertices, 0u, slot),
                           block_vertex(l.first, vertices, 1u, slot),
                           block_vertex(l.first, vertices, 2u, slot), tuv);
    } else if (STORE == ABI_STORE_QUANTISED) {
        quantised q = quantised_of(l.first, slot);
        hit = tri_test_run(TRI_TEST, r, quantised_vertex(q, 0u, slot),
                           quantised_vertex(q, 1u, slot), quantised_vertex(q, 2u, slot), tuv);
    } else if (STORE == ABI_STORE_TRUNCATED) {
        truncated t = truncated_of(l.first, slot);
        hit = tri_test_run(TRI_TEST, r, truncated_vertex(t, 0u, slot),
                           truncated_vertex(t, 1u, slot), truncated_vertex(t, 2u, slot), tuv);
    } else if (STORE == ABI_STORE_DGF1) {
        dense d = dense_of(l.first, slot);
        vec3 v0, v1, v2;
        dense_triangle(d, slot, v0, v1, v2);
        hit = tri_test_run(TRI_TEST, r, v0, v1, v2, tuv);
    } else if (STORE == ABI_STORE_EDGES) {
        hit = tri_moeller_trumbore_edges(r, store_vec(row, 1u), store_vec(row + 3u, 1u),
                                         store_vec(row + 6u, 1u),
                                         TRI_TEST == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0, tuv);
        hit = both(hit, tri_in_range(TRI_TEST, r, tuv.x));
    } else if (STORE == ABI_STORE_BALDWIN_WEBBER) {
        hit = baldwin_webber_hit(r, store_vec(row, 1u), store_vec(row + 3u, 1u),
                                 store_vec(row + 6u, 1u), store_word(row + 9u) >> 30, tuv);
        hit = both(hit, tri_in_range(TRI_TEST, r, tuv.x));
    } else {
        hit = tri_test_run(TRI_TEST, r, store_vec(row, 1u), store_vec(row + 3u, 1u),
                           store_vec(row + 6u, 1u), tuv);
    }
    return hit;
}

#endif
