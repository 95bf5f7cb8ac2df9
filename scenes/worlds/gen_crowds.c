/* Many boxes, and instances that touch, overlap or share one large mesh. */
#include "scenes/worlds/placer.h"

/* --- wall ------------------------------------------------------------------------------------- */

static enum status make_wall(struct placer *placer, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[0];
    const struct linear one = linear_diagonal(1, 1, 1);
    enum status status = placer_start(placer, 1, n * n, reason);
    if (!status)
        status = placer_box(placer, reason);
    for (uint32_t i = 0; i < n * n && !status; i++)
        placer_add(placer, 0, &one, (const double[3]){i % n + value[1], i / n + value[1], 0});
    return status;
}

/* Every coordinate is below 2^24, where floats hold all integers. */
const struct world_generator gen_wall = {
    .name = "wall",
    .summary = "touching unit boxes on the integer lattice: seams between instances",
    .param = {{"n", "boxes a side", 8, 1, 1024, true},
              {"offset", "added to x and y", 0, -8000000, 8000000, true}},
    .make = make_wall,
    .seedless = true,
};

/* --- nest ------------------------------------------------------------------------------------- */

static enum status make_nest(struct placer *placer, const double *value, struct reason *reason)
{
    uint32_t count = (uint32_t)value[1];
    enum status status = placer_start(placer, 1, count, reason);
    if (!status)
        status = placer_generated(placer, "sphere", (const double[GENERATOR_PARAMS]){value[0], 1},
                                  1, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        double size = 1 / (1 + 0.125 * (i % 64)), t[3];
        struct linear scale = linear_diagonal(size, size, size), turn = placer_rotation(placer);
        struct linear m = linear_multiply(&turn, &scale);
        for (int k = 0; k < 3; k++)
            t[k] = (double)rng_range(&placer->rng, -0.125f, 0.125f);
        placer_add(placer, 0, &m, t);
    }
    return status;
}

const struct world_generator gen_nest = {
    .name = "nest",
    .summary = "rotated spheres inside each other: boxes of instances overlap",
    .param = {{"n", "the sphere has 8 n^2 triangles", 4, 1, 512, true},
              {"count", "instances", 16, 1, 65536, true}},
    .make = make_nest,
};

/* --- crowd ------------------------------------------------------------------------------------ */

static enum status make_crowd(struct placer *placer, const double *value, struct reason *reason)
{
    uint32_t count = (uint32_t)value[0];
    enum status status = placer_start(placer, 1, count, reason);
    if (!status)
        status = placer_box(placer, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        double t[3], size = (double)rng_range(&placer->rng, 0.5f, 1.5f) * value[1];
        struct linear scale = linear_diagonal(size, size, size), turn = placer_rotation(placer);
        struct linear m = linear_multiply(&turn, &scale);
        for (int k = 0; k < 3; k++)
            t[k] = (double)rng_range(&placer->rng, -1, 1);
        placer_add(placer, 0, &m, t)->custom = i;
    }
    return status;
}

const struct world_generator gen_crowd = {
    .name = "crowd",
    .summary = "rotated boxes of 12 triangles in a cube; each instance's custom index is its own",
    .param = {{"n", "instances", 1000, 1, PLACER_INSTANCES_MOST, true},
              {"size", "their sides, 0.5 to 1.5 times that", 0.05, 1e-6, 1, false}},
    .make = make_crowd,
};

/* --- twins ------------------------------------------------------------------------------------ */

static enum status make_twins(struct placer *placer, const double *value, struct reason *reason)
{
    const double terrain[GENERATOR_PARAMS] = {value[0], 0.5, 0.25};
    const struct linear one = linear_diagonal(1, 1, 1);
    const uint64_t seed = rng_u64(&placer->rng);
    enum status status = placer_start(placer, 1, 2, reason);
    if (!status)
        status = placer_generated(placer, "terrain", terrain, seed, reason);
    if (status)
        return status;
    struct linear turn = placer_rotation(placer);
    placer_add(placer, 0, &one, (const double[3]){0, 0, 0});
    placer_add(placer, 0, &turn, (const double[3]){0.5, 0.25, 0});
    return STATUS_OK;
}

const struct world_generator gen_twins = {
    .name = "twins",
    .summary = "one large mesh twice: a terrain, and another one through it",
    .param = {{"k", "the terrain has 2^(2 k + 1) triangles", 6, 0, 11, true}},
    .make = make_twins,
};
