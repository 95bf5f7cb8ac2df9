#include "fuzz/campaign/worker_base.h"

#include <string.h>

/* The file itself, with pointers that mean nothing, then these arrays of it. */
struct worker_part {
    void *at;
    size_t bytes;
};

#define PARTS 6

static void parts_of(const struct fuzz_trial *trial, struct worker_part part[PARTS])
{
    const struct scene *scene = &trial->scene;
    const struct trial_world *world = &trial->world;
    part[0] = (struct worker_part){scene->vertex, 3 * sizeof(float) * scene->vertex_count};
    part[1] = (struct worker_part){scene->index, 3 * sizeof(uint32_t) * scene->tri_count};
    part[2] = (struct worker_part){trial->ray, sizeof *trial->ray * trial->ray_count};
    part[3] =
        (struct worker_part){world->geometry, sizeof *world->geometry * world->geometry_count};
    part[4] =
        (struct worker_part){world->instance, sizeof *world->instance * world->instance_count};
    part[5] =
        (struct worker_part){world->mode, world->is ? sizeof *world->mode * trial->ray_count : 0};
}

size_t worker_base_bytes(const struct finding_file *file)
{
    struct worker_part part[PARTS];
    size_t bytes = sizeof *file;
    parts_of(&file->trial, part);
    for (size_t i = 0; i < PARTS; i++)
        bytes += part[i].bytes;
    return bytes;
}

void worker_base_put(const struct finding_file *file, void *bytes)
{
    struct worker_part part[PARTS];
    char *at = bytes;
    parts_of(&file->trial, part);
    memcpy(at, file, sizeof *file);
    at += sizeof *file;
    for (size_t i = 0; i < PARTS; at += part[i].bytes, i++)
        if (part[i].bytes > 0)
            memcpy(at, part[i].at, part[i].bytes);
}

enum status worker_base_get(const void *bytes, size_t size, struct finding_file *out,
                            struct reason *reason)
{
    struct finding_file file;
    struct fuzz_trial made;
    struct worker_part part[PARTS];
    const char *at = bytes;
    *out = (struct finding_file){.has_signature = false};
    if (size < sizeof file)
        return fail(reason, STATUS_INPUT, "an order's base has %zu bytes, too few", size);
    memcpy(&file, at, sizeof file);
    at += sizeof file;
    if (worker_base_bytes(&file) != size)
        return fail(reason, STATUS_INPUT, "an order's base has %zu bytes, not %zu", size,
                    worker_base_bytes(&file));
    enum status status = fuzz_trial_make(file.trial.scene.vertex_count, file.trial.scene.tri_count,
                                         file.trial.ray_count, &made, reason);
    if (!status && file.trial.world.is)
        status =
            trial_world_make(0, file.trial.world.geometry_count, file.trial.world.instance_count,
                             file.trial.ray_count, &made.world, reason);
    if (status) {
        fuzz_trial_free(&made);
        return status;
    }
    const struct filter_rule filter = file.trial.world.filter;
    file.trial.world = made.world;
    file.trial.world.filter = filter;
    file.trial.scene = made.scene;
    file.trial.ray = made.ray;
    parts_of(&file.trial, part);
    for (size_t i = 0; i < PARTS; at += part[i].bytes, i++)
        if (part[i].bytes > 0)
            memcpy(part[i].at, at, part[i].bytes);
    *out = file;
    return STATUS_OK;
}
