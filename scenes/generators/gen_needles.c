#include "scenes/generators/pen.h"

#include <math.h>

enum { N, ASPECT, OFFSET };

/* A random point on the unit sphere, by rejection. Only + - * / and sqrt are used, so that the
 * bytes are the same on every machine. */
static void direction(struct rng *rng, double d[3])
{
    double size = 0;
    while (!(size > 0.01 && size <= 1.0)) {
        size = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = 2.0 * (double)rng_float(rng) - 1.0;
            size += d[k] * d[k];
        }
    }
    for (int k = 0; k < 3; k++)
        d[k] /= sqrt(size);
}

/* Odd triangles are slivers: the third vertex is beside the middle of the long edge, so that one
 * angle is nearly 180 degrees. Even ones are needles with one short edge. */
static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N];
    enum status status = pen_start(pen, 3 * (uint64_t)n, n, reason);
    if (status)
        return status;
    double offset = value[OFFSET];
    for (uint32_t i = 0; i < n; i++) {
        double along[3], aside[3], centre[3], length = 0.05 + 0.25 * (double)rng_float(&pen->rng);
        direction(&pen->rng, along);
        direction(&pen->rng, aside);
        for (int k = 0; k < 3; k++)
            centre[k] = offset + 0.7 * ((double)rng_float(&pen->rng) - 0.5);
        double half = 0.5 * length, thin = length / value[ASPECT], at = i % 2 ? 0.0 : half;
        for (int c = 0; c < 3; c++) {
            double s = c == 0 ? -half : c == 1 ? half : at, t = c == 2 ? thin : 0.0;
            pen_vertex(pen, centre[0] + s * along[0] + t * aside[0],
                       centre[1] + s * along[1] + t * aside[1],
                       centre[2] + s * along[2] + t * aside[2]);
        }
        pen_tri(pen, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return STATUS_OK;
}

const struct generator gen_needles = {
    .name = "needles",
    .summary = "needles and slivers, long and thin, around (offset, offset, offset)",
    .param = {[N] = {"n", "triangles", 1000, 0, 1 << 20, true},
              [ASPECT] = {"aspect", "length over width", 100, 1, 1e9, false},
              [OFFSET] = {"offset", "added to every coordinate", 0, -1e9, 1e9, false}},
    .make = make,
};
