#include "scenes/generators/pen.h"

enum { N, RADIUS };

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N];
    enum status status = pen_start(pen, PEN_SPHERE_VERTICES(n), PEN_SPHERE_TRIS(n), reason);
    if (status)
        return status;
    pen_sphere(pen, n, (const double[3]){0, 0, 0}, value[RADIUS]);
    return STATUS_OK;
}

const struct generator gen_sphere = {
    .name = "sphere",
    .summary = "closed sphere around the origin, 8 n^2 triangles, vertices shared; no seed",
    .param = {[N] = {"n", "parts of each octahedron edge", 16, 1, 1448, true},
              [RADIUS] = {"radius", "radius", 1, 1e-9, 1e9, false}},
    .make = make,
    .seedless = true,
};
