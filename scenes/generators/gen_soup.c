#include "ref/base/rng.h"
#include "scenes/generators/pen.h"

#include <math.h>

enum { N, SIZE, OFFSET };

extern const struct generator gen_soup;

static enum status make(const double *value, uint64_t seed, struct scene *out,
                        struct reason *reason)
{
    struct pen pen;
    *out = (struct scene){0};
    enum status status = pen_values(&gen_soup, value, 1u << N, reason);
    if (status)
        return status;
    uint32_t n = (uint32_t)value[N];
    status = pen_start(&gen_soup, 3 * (uint64_t)n, n, out, &pen, reason);
    if (status)
        return status;
    struct rng rng = rng_make(seed, 0);
    float size = (float)value[SIZE], offset = (float)value[OFFSET];
    float reach = 0.5f * (1.0f - size); /* centres keep so far from the middle of the cube */
    for (uint32_t i = 0; i < n; i++) {
        float centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] = rng_range(&rng, -reach, reach);
        for (int c = 0; c < 3; c++) {
            float p[3];
            for (int k = 0; k < 3; k++) {
                p[k] = centre[k] + size * (rng_float(&rng) - 0.5f);
                p[k] = fminf(fmaxf(p[k], -0.5f), 0.5f); /* rounding may step out by an ulp */
            }
            pen_vertex(&pen, p[0] + offset, p[1] + offset, p[2] + offset);
        }
        pen_tri(&pen, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return STATUS_OK;
}

const struct generator gen_soup = {
    .name = "soup",
    .summary = "random triangles in the unit cube around (offset, offset, offset)",
    .param = {[N] = {"n", "triangles", 1000, 0, 1 << 20},
              [SIZE] = {"size", "largest side of a triangle's box", 0.1, 0, 1},
              [OFFSET] = {"offset", "added to every coordinate", 0, -1e9, 1e9}},
    .make = make,
};
