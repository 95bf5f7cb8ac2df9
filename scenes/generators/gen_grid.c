#include "scenes/generators/pen.h"

enum { N, HEIGHT, Z, OFFSET };

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N], steps = (uint32_t)value[HEIGHT] + 1;
    enum status status = pen_start(pen, PEN_QUAD_VERTICES(n), 2 * (uint64_t)n * n, reason);
    if (status)
        return status;
    double corner = value[OFFSET] - n / 2;
    pen_quad(pen, (const double[3]){corner, corner, value[Z]}, (const double[3]){n, 0, 0},
             (const double[3]){0, n, 0}, n);
    for (uint32_t i = 0; i < pen->vertex_count; i++)
        pen->scene->vertex[3 * (size_t)i + 2] += (float)rng_below(&pen->rng, steps);
    return STATUS_OK;
}

/* The parameter ranges keep every coordinate below 2^24, where floats hold all integers. */
const struct generator gen_grid = {
    .name = "grid",
    .summary = "height grid on the integer lattice, z up: exact coordinates, exact ties",
    .param = {[N] = {"n", "quads a side", 32, 1, 1024, true},
              [HEIGHT] = {"height", "heights are z .. z + height; 0 is flat", 2, 0, 1000000, true},
              [Z] = {"z", "lowest level", 0, -8000000, 8000000, true},
              [OFFSET] = {"offset", "added to x and y", 0, -8000000, 8000000, true}},
    .make = make,
};
