#include "scenes/generators/pen.h"

enum { N, RADIUS };

extern const struct generator gen_sphere;

static enum status make(const double *value, uint64_t seed, struct scene *out,
                        struct reason *reason)
{
    struct pen pen;
    *out = (struct scene){0};
    (void)seed; /* nothing here is random */
    enum status status = pen_values(&gen_sphere, value, 1u << N, reason);
    if (status)
        return status;
    uint32_t n = (uint32_t)value[N];
    status = pen_start(&gen_sphere, PEN_SPHERE_VERTICES(n), PEN_SPHERE_TRIS(n), out, &pen, reason);
    if (status)
        return status;
    pen_sphere(&pen, n, (const double[3]){0, 0, 0}, value[RADIUS]);
    return STATUS_OK;
}

const struct generator gen_sphere = {
    .name = "sphere",
    .summary = "closed sphere around the origin, 8 n^2 triangles, vertices shared; no seed",
    .param = {[N] = {"n", "parts of each octahedron edge", 16, 1, 1448},
              [RADIUS] = {"radius", "radius", 1, 1e-9, 1e9}},
    .make = make,
    .seedless = true,
};
