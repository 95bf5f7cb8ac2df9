/* raydiff tree --from: what a Vulkan driver builds for ray queries. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/tree/cmd_tree_dump.h"

#include "gpu/engines/rayquery_save.h"
#include "ref/files/file.h"
#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

static enum status variant_of(const char *name, struct accel_variant *out, struct reason *reason)
{
    *out = (struct accel_variant){.split = 0};
    if (strcmp(name, "rayquery") == 0)
        return STATUS_OK;
    if (!accel_is_named(name))
        return fail(reason, STATUS_INPUT,
                    "--from: '%.60s' is not rayquery or a variant of it (docs/variants.md)", name);
    enum status status = accel_parse(name, out, reason);
    if (!status && (out->nan || out->degenerate || out->split))
        status = fail(reason, STATUS_INPUT,
                      "--from: '%.60s' has other triangles or geometries than the scene", name);
    return status;
}

static enum status save(const char *path, const struct rayquery_saved *saved, struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    fwrite(saved->byte, 1, saved->size, out.stream);
    status = file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

enum status tree_build(const struct tree_command *command, const char *spec, char **bytes,
                       size_t *size, char **driver, struct reason *reason)
{
    struct accel_variant variant;
    struct rayquery_saved saved = {0};
    struct world world = {0};
    *bytes = *driver = NULL;
    enum status status = variant_of(command->from, &variant, reason);
    if (!status)
        status = world_open(spec, 1, &world, reason);
    if (!status)
        status = rayquery_save(&command->engines, &variant, &world, &saved, reason);
    world_free(&world);
    if (!status && command->save)
        status = save(command->save, &saved, reason);
    *bytes = saved.byte;
    *size = saved.size;
    if (!status && !(*driver = strdup(saved.driver)))
        status = fail(reason, STATUS_MEMORY, "no memory");
    return status;
}
