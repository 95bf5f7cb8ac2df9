/* Storages `quantised` and `truncated`, as in ref/store/store_quantised.c and store_truncated.c:
 * blocks of codes on a grid, and of vertices without their low bits. For store.glsl, after
 * store_word. */
#ifndef STORE_QUANTISED_GLSL
#define STORE_QUANTISED_GLSL

struct quantised {
    uint first;
    uint tris, vertices;
    uint code, number; /* widths in bits */
    uvec3 width;
    uint corner_at, number_at, vertex_at;
    bool there; /* the block is within the words, and the slot within the block */
};

uint quantised_bits(uint first, uint at, uint width)
{
    uint word = first + (at >> 5), shift = at & 31u;
    uint low = store_word(word) >> shift;
    uint high = store_word(word + 1u) << ((32u - shift) & 31u);
    return (low | pick(shift + width > 32u, high, 0u)) & ((1u << width) - 1u);
}

quantised quantised_of(uint first, uint slot)
{
    quantised q;
    uint sizes = store_word(first), widths = store_word(4u);
    q.first = first;
    q.tris = (sizes & 7u) + 1u;
    q.vertices = ((sizes >> 3) & 15u) + 1u;
    q.width = uvec3(sizes >> 7, sizes >> 12, sizes >> 17) & 31u;
    q.code = widths & 31u;
    q.number = (widths >> 5) & 31u;
    q.corner_at = 22u + 3u * q.code;
    q.number_at = q.corner_at + 12u * q.tris;
    q.vertex_at = q.number_at + q.number * q.tris;
    uint end = q.vertex_at + (q.width.x + q.width.y + q.width.z) * q.vertices;
    bool inside = both(first < job.item_count, ((end + 31u) >> 5) <= job.item_count - first);
    q.there = both(both(job.item_count >= 5u, slot < q.tris), inside);
    return q;
}

/* Converts a signed number of 25 bits, which is exact in float. */
float quantised_decode(uint n, uint exponent)
{
    int whole = int((n & 0x1FFFFFFu) ^ 0x1000000u) - 0x1000000;
    precise float x = float(whole) * uintBitsToFloat(exponent << 23);
    return x;
}

vec3 quantised_vertex(quantised q, uint corner, uint slot)
{
    uint vertex = quantised_bits(q.first, q.corner_at + 12u * slot + 4u * corner, 4u);
    uint at = q.vertex_at +
              (q.width.x + q.width.y + q.width.z) * pick(vertex < q.vertices, vertex, 0u);
    uvec3 n = uvec3(quantised_bits(q.first, 22u, q.code) + quantised_bits(q.first, at, q.width.x),
                    quantised_bits(q.first, 22u + q.code, q.code) +
                        quantised_bits(q.first, at + q.width.x, q.width.y),
                    quantised_bits(q.first, 22u + 2u * q.code, q.code) +
                        quantised_bits(q.first, at + q.width.x + q.width.y, q.width.z));
    uint steps = store_word(3u);
    return vec3(quantised_decode(store_word(0u) + n.x, steps & 255u),
                quantised_decode(store_word(1u) + n.y, (steps >> 8) & 255u),
                quantised_decode(store_word(2u) + n.z, (steps >> 16) & 255u));
}

/* --- truncated */

struct truncated {
    uint first;
    uint vertices, dropped;
    uint number, coordinate; /* widths in bits */
    uint number_at, vertex_at;
    bool there; /* the block is within the words, and the slot within the block */
};

/* Reads 1 to 32 bits. */
uint truncated_bits(uint first, uint at, uint width)
{
    uint word = first + (at >> 5), shift = at & 31u;
    uint low = store_word(word) >> shift;
    uint high = store_word(word + 1u) << ((32u - shift) & 31u);
    return (low | pick(shift + width > 32u, high, 0u)) & (0xFFFFFFFFu >> (32u - width));
}

truncated truncated_of(uint first, uint slot)
{
    truncated t;
    uint sizes = store_word(first);
    uint tris = (sizes & 7u) + 1u;
    t.first = first;
    t.vertices = ((sizes >> 3) & 15u) + 1u;
    t.dropped = (sizes >> 7) & 31u;
    t.number = ((sizes >> 12) & 31u) + 1u;
    t.coordinate = 32u - t.dropped;
    t.number_at = 17u + 12u * tris;
    t.vertex_at = t.number_at + t.number * tris;
    uint end = t.vertex_at + 3u * t.coordinate * t.vertices;
    bool inside = both(first < job.item_count, ((end + 31u) >> 5) <= job.item_count - first);
    t.there = both(slot < tris, inside);
    return t;
}

vec3 truncated_vertex(truncated t, uint corner, uint slot)
{
    uint vertex = truncated_bits(t.first, 17u + 12u * slot + 4u * corner, 4u);
    uint at = t.vertex_at + 3u * t.coordinate * pick(vertex < t.vertices, vertex, 0u);
    return uintBitsToFloat(
        uvec3(truncated_bits(t.first, at, t.coordinate),
              truncated_bits(t.first, at + t.coordinate, t.coordinate),
              truncated_bits(t.first, at + 2u * t.coordinate, t.coordinate))
        << t.dropped);
}

#endif
