#include "ref/base/rng.h"
#include "scenes/generators/pen.h"

enum { N, HEIGHT, Z, OFFSET };

extern const struct generator gen_grid;

static enum status make(const double *value, uint64_t seed, struct scene *out,
                        struct reason *reason)
{
    struct pen pen;
    *out = (struct scene){0};
    unsigned whole = 1u << N | 1u << HEIGHT | 1u << Z | 1u << OFFSET;
    enum status status = pen_values(&gen_grid, value, whole, reason);
    if (status)
        return status;
    uint32_t n = (uint32_t)value[N], steps = (uint32_t)value[HEIGHT] + 1;
    status = pen_start(&gen_grid, PEN_QUAD_VERTICES(n), 2 * (uint64_t)n * n, out, &pen, reason);
    if (status)
        return status;
    double corner = value[OFFSET] - n / 2;
    pen_quad(&pen, (const double[3]){corner, corner, value[Z]}, (const double[3]){n, 0, 0},
             (const double[3]){0, n, 0}, n);
    struct rng rng = rng_make(seed, 0);
    for (uint32_t i = 0; i < out->vertex_count; i++)
        out->vertex[3 * (size_t)i + 2] += (float)rng_below(&rng, steps);
    return STATUS_OK;
}

/* The ranges keep every coordinate below 2^24, where floats hold all integers. */
const struct generator gen_grid = {
    .name = "grid",
    .summary = "height grid on the integer lattice, z up: exact coordinates, exact ties",
    .param = {[N] = {"n", "quads a side", 32, 1, 1024},
              [HEIGHT] = {"height", "heights are z .. z + height; 0 is flat", 2, 0, 1000000},
              [Z] = {"z", "lowest level", 0, -8000000, 8000000},
              [OFFSET] = {"offset", "added to x and y", 0, -8000000, 8000000}},
    .make = make,
};
