#include "scenes/generators/pen.h"

#include <math.h>

enum { N, SIZE, OFFSET };

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N];
    enum status status = pen_start(pen, 3 * (uint64_t)n, n, reason);
    if (status)
        return status;
    float size = (float)value[SIZE], offset = (float)value[OFFSET];
    float reach = 0.5f * (1.0f - size); /* largest |coordinate| of a centre */
    for (uint32_t i = 0; i < n; i++) {
        float centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] = rng_range(&pen->rng, -reach, reach);
        for (int c = 0; c < 3; c++) {
            float p[3];
            for (int k = 0; k < 3; k++) {
                p[k] = centre[k] + size * (rng_float(&pen->rng) - 0.5f);
                p[k] = fminf(fmaxf(p[k], -0.5f), 0.5f); /* rounding may exceed the cube by an ulp */
            }
            pen_vertex(pen, p[0] + offset, p[1] + offset, p[2] + offset);
        }
        pen_tri(pen, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return STATUS_OK;
}

const struct generator gen_soup = {
    .name = "soup",
    .summary = "random triangles in the unit cube around (offset, offset, offset)",
    .param = {[N] = {"n", "triangles", 1000, 0, 1 << 20, true},
              [SIZE] = {"size", "largest side of a triangle's box", 0.1, 0, 1, false},
              [OFFSET] = {"offset", "added to every coordinate", 0, -1e9, 1e9, false}},
    .make = make,
};
