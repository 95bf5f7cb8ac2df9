/* One sphere under transforms of one kind: a generator each. */
#include "scenes/worlds/placer.h"

enum { N, COUNT };

static enum status make(struct placer *placer, const double *value, placed_draw *draw,
                        struct reason *reason)
{
    uint32_t count = (uint32_t)value[COUNT];
    enum status status = placer_start(placer, 1, count, reason);
    if (!status)
        status = placer_generated(placer, "sphere", (const double[GENERATOR_PARAMS]){value[N], 1},
                                  1, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        double t[3] = {4.0 * i, 0, 0};
        struct linear m = draw(placer, i, t);
        placer_add(placer, 0, &m, t);
    }
    return status;
}

/* 1 or -1. */
static double draw_sign(struct placer *placer)
{
    return rng_below(&placer->rng, 2) ? 1 : -1;
}

static struct linear draw_identity(struct placer *placer, uint32_t i, double t[3])
{
    (void)placer, (void)i;
    t[0] = t[1] = t[2] = 0;
    return linear_diagonal(1, 1, 1);
}

static struct linear draw_far(struct placer *placer, uint32_t i, double t[3])
{
    for (int k = 0; k < 3; k++) {
        double sign = draw_sign(placer);
        t[k] = sign * (2e6 + 4.0 * i + (double)rng_float(&placer->rng));
    }
    return linear_diagonal(1, 1, 1);
}

static struct linear draw_turned(struct placer *placer, uint32_t i, double t[3])
{
    (void)i, (void)t;
    return placer_rotation(placer);
}

static struct linear draw_scaled(struct placer *placer, uint32_t i, double t[3])
{
    (void)i, (void)t;
    double size = placer_power((int)rng_below(&placer->rng, 41) - 20);
    return linear_diagonal(size, size, size);
}

static struct linear draw_tiny(struct placer *placer, uint32_t i, double t[3])
{
    (void)i, (void)t;
    struct linear small = linear_diagonal(1e-6, 1e-6, 1e-6), turn = placer_rotation(placer);
    return linear_multiply(&turn, &small);
}

/* 1e6 : 1, along axes for even i, along others for odd. */
static struct linear draw_stretched(struct placer *placer, uint32_t i, double t[3])
{
    (void)t;
    double size[3] = {1, 1, 1};
    uint32_t axis = rng_below(&placer->rng, 3);
    size[axis] = 1e3;
    size[(axis + 1) % 3] = 1e-3;
    struct linear stretch = linear_diagonal(size[0], size[1], size[2]);
    struct linear turn = placer_rotation(placer);
    return i % 2 ? linear_multiply(&turn, &stretch) : stretch;
}

/* At an axis for even i, at any plane for odd. */
static struct linear draw_mirrored(struct placer *placer, uint32_t i, double t[3])
{
    (void)t;
    double size[3] = {1, 1, 1};
    size[rng_below(&placer->rng, 3)] = -1;
    struct linear mirror = linear_diagonal(size[0], size[1], size[2]);
    struct linear turn = placer_rotation(placer);
    return i % 2 ? linear_multiply(&turn, &mirror) : mirror;
}

static struct linear draw_sheared(struct placer *placer, uint32_t i, double t[3])
{
    (void)i, (void)t;
    struct linear shear = linear_diagonal(1, 1, 1);
    shear.m[0][1] = (double)rng_range(&placer->rng, -2, 2);
    shear.m[0][2] = (double)rng_range(&placer->rng, -2, 2);
    shear.m[1][2] = (double)rng_range(&placer->rng, -2, 2);
    return shear;
}

/* A quarter of a whole number in -4 .. 4. */
static double draw_quarter(struct placer *placer)
{
    return ((double)rng_below(&placer->rng, 9) - 4) / 4;
}

/* Two shears around a flattening by 2^20. Every number has at most 24 bits, so that the determinant
 * is 2^-20, exactly. */
static struct linear draw_thin(struct placer *placer, uint32_t i, double t[3])
{
    (void)i, (void)t;
    struct linear lower = linear_diagonal(1, 1, 1), upper = lower;
    for (int k = 1; k < 3; k++)
        for (int j = 0; j < k; j++) {
            lower.m[k][j] = draw_quarter(placer);
            upper.m[j][k] = draw_quarter(placer);
        }
    struct linear flat = linear_diagonal(1, 1, placer_power(-20));
    struct linear half = linear_multiply(&flat, &upper);
    return linear_multiply(&lower, &half);
}

#define PLACED(kind, text, instances, without_seed)                                                \
    static enum status make_##kind(struct placer *placer, const double *value,                     \
                                   struct reason *reason)                                          \
    {                                                                                              \
        return make(placer, value, draw_##kind, reason);                                           \
    }                                                                                              \
    const struct world_generator gen_placed_##kind = {                                             \
        .name = "placed-" #kind,                                                                   \
        .summary = text,                                                                           \
        .param = {[N] = {"n", "the sphere has 8 n^2 triangles", 8, 1, 512, true},                  \
                  [COUNT] = {"count", "instances", instances, 1, 65536, true}},                    \
        .make = make_##kind,                                                                       \
        .seedless = without_seed,                                                                  \
    };

PLACED(identity, "spheres at the identity, all at one place: exact ties", 2, true)
PLACED(far, "spheres moved by a million of their size", 4, false)
PLACED(turned, "spheres rotated by no round angle", 4, false)
PLACED(scaled, "spheres scaled by powers of two, 2^-20 to 2^20", 4, false)
PLACED(tiny, "spheres rotated and scaled by 1e-6", 4, false)
PLACED(stretched, "spheres scaled by 1e3 and 1e-3 along two axes", 4, false)
PLACED(mirrored, "spheres in a mirror", 4, false)
PLACED(sheared, "sheared spheres", 4, false)
PLACED(thin, "spheres almost flat: det M is 2^-20", 4, false)

const struct placed_kind placed_kinds[] = {
    {"identity", draw_identity}, {"far", draw_far},
    {"turned", draw_turned},     {"scaled", draw_scaled},
    {"tiny", draw_tiny},         {"stretched", draw_stretched},
    {"mirrored", draw_mirrored}, {"sheared", draw_sheared},
    {"thin", draw_thin},         {NULL, NULL}};
