#include "fuzz/gen/gen_sketch.h"

#include <assert.h>

const float sketch_origin[3] = {0, 0, 0};

float float_step(float x, int steps)
{
    /* Integers in the order of the floats; -0 and 0 are both 0. */
    int64_t bits = float_bits(x) & 0x7FFFFFFFu;
    int64_t place = (float_bits(x) & 0x80000000u ? -bits : bits) + steps;
    const int64_t most = 0x7F7FFFFF;
    place = place > most ? most : place < -most ? -most : place;
    return float_from_bits(place < 0 ? 0x80000000u | (uint32_t)-place : (uint32_t)place);
}

uint32_t sketch_vertex(struct sketch *sketch, float x, float y, float z)
{
    assert(sketch->vertex_count < 3 * sketch->goal);
    float *v = sketch->vertex + 3 * (size_t)sketch->vertex_count;
    v[0] = x;
    v[1] = y;
    v[2] = z;
    return sketch->vertex_count++;
}

void sketch_tri(struct sketch *sketch, uint32_t a, uint32_t b, uint32_t c)
{
    if (sketch_room(sketch) == 0)
        return;
    uint32_t *index = sketch->index + 3 * (size_t)sketch->tri_count++;
    index[0] = a;
    index[1] = b;
    index[2] = c;
}

void sketch_loose(struct sketch *sketch, float v[3][3])
{
    if (sketch_room(sketch) == 0)
        return;
    uint32_t a = sketch_vertex(sketch, v[0][0], v[0][1], v[0][2]);
    uint32_t b = sketch_vertex(sketch, v[1][0], v[1][1], v[1][2]);
    uint32_t c = sketch_vertex(sketch, v[2][0], v[2][1], v[2][2]);
    sketch_tri(sketch, a, b, c);
}

void sketch_point(struct sketch *sketch, const float centre[3], float reach, float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = centre[k] + reach * sketch_signed(sketch);
}

void sketch_small(struct sketch *sketch, const float centre[3], float reach)
{
    float v[3][3];
    for (int c = 0; c < 3; c++)
        sketch_point(sketch, centre, reach, v[c]);
    sketch_loose(sketch, v);
}

void sketch_box(struct sketch *sketch, const float lo[3], const float hi[3])
{
    /* Corner bits are x, y, z; two triangles a face, outward. */
    static const uint8_t corner[SKETCH_BOX][3] = {
        {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
        {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
    };
    uint32_t first = sketch->vertex_count;
    for (uint32_t c = 0; c < 8; c++)
        sketch_vertex(sketch, c & 1 ? hi[0] : lo[0], c & 2 ? hi[1] : lo[1], c & 4 ? hi[2] : lo[2]);
    for (uint32_t t = 0; t < SKETCH_BOX; t++)
        sketch_tri(sketch, first + corner[t][0], first + corner[t][1], first + corner[t][2]);
}

void sketch_tetra(struct sketch *sketch, float v[4][3])
{
    uint32_t first = sketch->vertex_count;
    for (int c = 0; c < 4; c++)
        sketch_vertex(sketch, v[c][0], v[c][1], v[c][2]);
    sketch_tri(sketch, first, first + 1, first + 2);
    sketch_tri(sketch, first, first + 3, first + 1);
    sketch_tri(sketch, first, first + 2, first + 3);
    sketch_tri(sketch, first + 1, first + 3, first + 2);
}

void sketch_sheet_size(const struct sketch *sketch, uint32_t *n, uint32_t *m)
{
    uint32_t quads = sketch_room(sketch) / 2;
    *n = 0;
    while ((*n + 1) * (*n + 1) <= quads)
        (*n)++;
    *m = *n ? quads / *n : 0;
}

void sketch_sheet(struct sketch *sketch, uint32_t n, uint32_t m,
                  void (*point)(struct sketch *sketch, uint32_t i, uint32_t j, float out[3],
                                const void *how),
                  const void *how)
{
    uint32_t first = sketch->vertex_count;
    for (uint32_t j = 0; j <= m; j++)
        for (uint32_t i = 0; i <= n; i++) {
            float p[3] = {0, 0, 0};
            point(sketch, i, j, p, how);
            sketch_vertex(sketch, p[0], p[1], p[2]);
        }
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            sketch_tri(sketch, a, b, d);
            sketch_tri(sketch, a, d, c);
        }
}
