#include "scenes/worlds/crowd.h"

#include "scenes/worlds/placer.h"

/* The largest side of the mesh, and its centre. */
static double measure(const struct scene *mesh, double centre[3])
{
    struct box box = scene_bounds(mesh);
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double side = (double)box.hi[k] - (double)box.lo[k];
        centre[k] = ((double)box.lo[k] + (double)box.hi[k]) / 2;
        most = side > most ? side : most;
    }
    return mesh->tri_count ? most : 0;
}

/* The mesh of the world: all of it is opaque. */
static enum status lend(struct placer *placer, const struct scene *mesh, struct reason *reason)
{
    struct geometry *all = alloc_zeroed(1, sizeof *all);
    if (!all)
        return fail(reason, STATUS_MEMORY, "no memory for a mesh");
    *all = (struct geometry){.count = mesh->tri_count, .opaque = true};
    placer->world->mesh[placer->world->mesh_count++] =
        (struct world_mesh){(struct scene *)mesh, all, 1};
    return STATUS_OK;
}

static enum status place(struct placer *placer, const struct scene *mesh, uint32_t count,
                         double size, struct reason *reason)
{
    double centre[3], side = measure(mesh, centre);
    enum status status = placer_start(placer, 1, count, reason);
    if (!status && !(side > 0))
        status = fail(reason, STATUS_INPUT, "a mesh of no size cannot be placed");
    if (!status)
        status = lend(placer, mesh, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        double by = (double)rng_range(&placer->rng, 0.5f, 1.5f) * size / side, t[3];
        struct linear scale = linear_diagonal(by, by, by), turn = placer_rotation(placer);
        struct linear m = linear_multiply(&turn, &scale);
        for (int k = 0; k < 3; k++) {
            t[k] = (double)rng_range(&placer->rng, -1, 1);
            for (int j = 0; j < 3; j++)
                t[k] -= m.m[k][j] * centre[j];
        }
        placer_add(placer, 0, &m, t)->custom = i;
    }
    return status;
}

enum status world_crowd_of(const struct scene *mesh, uint32_t count, double size, uint64_t seed,
                           struct world *out, struct reason *reason)
{
    struct placer placer = {.world = out, .rng = rng_make(seed, 0)};
    *out = (struct world){.borrows = true};
    enum status status = place(&placer, mesh, count, size, reason);
    if (!status)
        status = world_finish(out, reason);
    if (status)
        world_free(out);
    return status;
}
