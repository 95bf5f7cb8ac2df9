/* Storage `dgf1`, as in ref/store/store_dgf1.c: blocks of the dense geometry format. For
 * store.glsl, after store_quantised.glsl, whose truncated_bits it reads with. */
#ifndef STORE_DGF1_GLSL
#define STORE_DGF1_GLSL

#define DENSE_RESTART   0u
#define DENSE_EDGE1     1u
#define DENSE_EDGE2     2u
#define DENSE_BACKTRACK 3u

struct dense {
    uint first;
    uint tris, vertices;
    uint index, number; /* widths in bits */
    uvec3 width;
    uint stride;
    uint reuse_at, end;
    bool there; /* the leaf is within the words, and the slot within the leaf */
};

dense dense_of(uint first, uint slot)
{
    dense d;
    uint sizes = store_word(first), xy = store_word(first + 2u), z = store_word(first + 3u);
    uint user = store_word(first + 5u);
    d.first = first;
    d.tris = ((sizes >> 16) & 63u) + 1u;
    d.vertices = ((sizes >> 10) & 63u) + 1u;
    d.index = ((sizes >> 8) & 3u) + 3u;
    d.number = ((user >> 5) & 31u) + 1u;
    d.width = (uvec3(xy, xy >> 4, z) & 15u) + 1u;
    d.stride = d.width.x + d.width.y + d.width.z;
    d.reuse_at = 192u + ((d.vertices * d.stride + 7u) & ~7u);
    d.end = ((user & 31u) + 1u) * 32u;
    uint words = (d.end >> 5) + ((d.tris * (d.number + 2u) + 31u) >> 5);
    bool inside = both(first < job.item_count, job.item_count - first >= 6u);
    inside = both(inside, words <= job.item_count - first);
    d.there = both(both(slot < d.tris, inside), d.reuse_at + 2u * (d.tris - 1u) <= d.end);
    return d;
}

/* Returns the places of the three indices of a triangle. */
uvec3 dense_indices(dense d, uint slot)
{
    uvec3 one = uvec3(0u, 1u, 2u), two = uvec3(0u);
    uint before = DENSE_RESTART, next = 3u, i = 1u;
    while (both(i <= slot, i < 64u)) {
        uint control = truncated_bits(d.first, d.end - 2u * i, 2u);
        bool restart = control == DENSE_RESTART, back = control == DENSE_BACKTRACK;
        uvec3 of = uvec3(pick(back, two.x, one.x), pick(back, two.y, one.y),
                         pick(back, two.z, one.z));
        bool second = any(bvec2(control == DENSE_EDGE2, both(back, before == DENSE_EDGE1)));
        uvec3 now = uvec3(pick(restart, next, pick(second, of.x, of.z)),
                          pick(restart, next + 1u, pick(second, of.z, of.y)),
                          pick(restart, next + 2u, next));
        next += pick(restart, 3u, 1u);
        two = one;
        one = now;
        before = control;
        i++;
    }
    return one;
}

/* Returns the vertex of an index. Bits that the block does not have are 0. */
uint dense_vertex(dense d, uint index)
{
    uint firsts = pick(index < 3u, index, 3u), i = 3u;
    bool is_first = index < 3u;
    while (both(i <= index, i < 192u)) {
        uint at = d.end - 2u * (d.tris - 1u) - (i - 2u);
        is_first = both(at < d.end, truncated_bits(d.first, at, 1u) == 1u);
        firsts += pick(both(i < index, is_first), 1u, 0u);
        i++;
    }
    uint at = d.reuse_at + d.index * (index - firsts);
    uint reused = truncated_bits(d.first, at, d.index);
    uint vertex = pick(is_first, firsts, pick(at + d.index <= d.end, reused, 0u));
    return pick(vertex < d.vertices, vertex, 0u);
}

/* The anchor is in the upper 24 bits of a word. The sum has 25 bits, so float represents it. */
float dense_decode(uint anchor, uint offset, uint exponent)
{
    int whole = int((anchor >> 8) ^ 0x800000u) - 0x800000 + int(offset);
    precise float x = float(whole) * uintBitsToFloat(exponent << 23);
    return x;
}

vec3 dense_corner(dense d, uint index)
{
    uint at = 192u + d.stride * dense_vertex(d, index);
    uint x = store_word(d.first + 1u), y = store_word(d.first + 2u), z = store_word(d.first + 3u);
    return vec3(dense_decode(x, truncated_bits(d.first, at, d.width.x), x & 255u),
                dense_decode(y, truncated_bits(d.first, at + d.width.x, d.width.y), x & 255u),
                dense_decode(z,
                             truncated_bits(d.first, at + d.width.x + d.width.y, d.width.z),
                             x & 255u));
}

void dense_triangle(dense d, uint slot, out vec3 v0, out vec3 v1, out vec3 v2)
{
    uint turn = truncated_bits(d.first, d.end + (d.number + 2u) * slot + d.number, 2u);
    uvec3 index = dense_indices(d, slot);
    vec3 a = dense_corner(d, index.x), b = dense_corner(d, index.y), c = dense_corner(d, index.z);
    /* The strip's vertex c is corner (c + turn) % 3. */
    uint by = pick(turn == 3u, 0u, turn);
    v0 = pick(by == 0u, a, pick(by == 1u, c, b));
    v1 = pick(by == 0u, b, pick(by == 1u, a, c));
    v2 = pick(by == 0u, c, pick(by == 1u, b, a));
}

#endif
