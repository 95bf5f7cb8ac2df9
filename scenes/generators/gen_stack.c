#include "scenes/generators/pen.h"

enum { N, COPIES, OFFSET };

/* Draws copy `c` of a triangle: the same one, reversed, or a smaller one in its plane that shares a
 * vertex. */
static void draw_copy(struct pen *pen, uint32_t first, uint32_t half, uint32_t c)
{
    if (c % 3 == 0)
        pen_tri(pen, first, first + 1, first + 2);
    else if (c % 3 == 1)
        pen_tri(pen, first + 1, first, first + 2);
    else
        pen_tri(pen, first, half, half + 1);
}

/* All triangles lie in planes z = i / 8 (exact), so that coplanar ones overlap exactly. */
static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N], copies = (uint32_t)value[COPIES];
    enum status status =
        pen_start(pen, (copies > 2 ? 5 : 3) * (uint64_t)n, (uint64_t)n * copies, reason);
    if (status)
        return status;
    double offset = value[OFFSET];
    for (uint32_t i = 0; i < n; i++) {
        double z = offset + (double)rng_below(&pen->rng, 8) / 8.0, corner[3][2];
        uint32_t first = 0, half = 0;
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 2; k++)
                corner[c][k] = offset + (double)rng_below(&pen->rng, 65) / 64.0;
            uint32_t vertex = pen_vertex(pen, corner[c][0], corner[c][1], z);
            first = c == 0 ? vertex : first;
        }
        for (int c = 1; c < 3 && copies > 2; c++) {
            uint32_t vertex = pen_vertex(pen, 0.5 * (corner[0][0] + corner[c][0]),
                                         0.5 * (corner[0][1] + corner[c][1]), z);
            half = c == 1 ? vertex : half;
        }
        for (uint32_t c = 0; c < copies; c++)
            draw_copy(pen, first, half, c);
    }
    return STATUS_OK;
}

const struct generator gen_stack = {
    .name = "stack",
    .summary = "duplicates, turned copies and coplanar overlaps on a lattice: exact ties",
    .param = {[N] = {"n", "different triangles", 200, 0, 1 << 18, true},
              [COPIES] = {"copies", "triangles made of each", 4, 1, 64, true},
              [OFFSET] = {"offset", "added to every coordinate", 0, -1e6, 1e6, true}},
    .make = make,
};
