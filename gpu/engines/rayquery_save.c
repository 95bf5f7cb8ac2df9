#include "gpu/engines/rayquery_save.h"

#include "gpu/trace/vulkan_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of every serialised structure, by the standard: two UUIDs, two sizes, the number of handles, then
 * the handles. */
#define SAVED_COUNT   48u
#define SAVED_HANDLES 56u

static uint64_t word_of(const uint8_t *byte, uint64_t at)
{
    uint64_t value;
    memcpy(&value, byte + at, sizeof value);
    return value;
}

static enum status append(struct rayquery_saved *out, const uint8_t *byte, uint64_t count,
                          struct reason *reason)
{
    char *grown = realloc(out->byte, out->size + count + 1);
    if (!grown)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for serialised structures");
    memcpy(grown + out->size, byte, count);
    out->byte = grown;
    out->size += count;
    out->byte[out->size] = 0;
    return STATUS_OK;
}

/* Appends the level that a handle is of, unless it was before. Handles of no level, such as 0, are
 * passed over. */
static enum status append_named(const struct vk_accel_bytes *bytes, uint64_t wanted, bool *done,
                                struct rayquery_saved *out, struct reason *reason)
{
    uint64_t count, handle;
    const uint8_t *byte;
    for (uint32_t level = 1; (byte = vk_accel_bytes_level(bytes, level, &count, &handle)); level++)
        if (handle == wanted && !done[level]) {
            done[level] = true;
            return append(out, byte, count, reason);
        }
    return STATUS_OK;
}

static enum status join(const struct vk_accel_bytes *bytes, uint32_t meshes,
                        struct rayquery_saved *out, struct reason *reason)
{
    uint64_t count, unused;
    const uint8_t *top = vk_accel_bytes_level(bytes, 0, &count, &unused);
    bool *done = alloc_zeroed((size_t)meshes + 1, sizeof *done);
    enum status status =
        done ? append(out, top, count, reason)
             : fail(reason, STATUS_MEMORY, "vulkan: no memory for %u meshes", meshes);
    if (!status && (count < SAVED_HANDLES ||
                    word_of(top, SAVED_COUNT) > (count - SAVED_HANDLES) / sizeof(uint64_t)))
        status = fail(reason, STATUS_DEVICE,
                      "vulkan: %s serialised %llu bytes that are no top "
                      "level",
                      out->driver, (unsigned long long)count);
    const uint64_t handles = status ? 0 : word_of(top, SAVED_COUNT);
    for (uint64_t i = 0; i < handles && !status; i++)
        status = append_named(bytes, word_of(top, SAVED_HANDLES + 8 * i), done, out, reason);
    free(done);
    return status;
}

enum status rayquery_save(const struct engine_options *options, const struct accel_variant *variant,
                          const struct world *world, struct rayquery_saved *out,
                          struct reason *reason)
{
    struct vk_options open = vulkan_options(options);
    struct vk *vk = NULL;
    struct vk_accel *accel = NULL;
    struct vk_accel_bytes *bytes = NULL;
    *out = (struct rayquery_saved){0};
    open.ray_query = true;
    open.ray_more = vk_accel_needs(&variant->how);
    enum status status = vk_open(&open, &vk, reason);
    if (!status) {
        snprintf(out->driver, sizeof out->driver, "%s (%s)", vk_limits(vk)->device,
                 vk_limits(vk)->driver);
        status = rayquery_build(vk, &open, world, NULL, variant, &accel, reason);
    }
    if (!status)
        status = vk_accel_save(vk, accel, &bytes, reason);
    if (!status)
        status = join(bytes, world->mesh_count, out, reason);
    vk_accel_bytes_free(bytes);
    if (vk) {
        vk_accel_free(vk, accel);
        struct reason message = {""};
        if (vk_close(vk, &message) && !status)
            status = fail(reason, STATUS_DEVICE, "vulkan: %s", message.text);
    }
    if (status) {
        free(out->byte);
        out->byte = NULL;
        out->size = 0;
    }
    return status;
}
