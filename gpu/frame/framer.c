#include "gpu/frame/framer_private.h"

#include "gpu/trace/dispatch.h"
#include "gpu/trace/gather.h"

#include <stdlib.h>
#include <string.h>

/* Node and triangle visits of the first submission, if each path visits every node. */
#define COST_FIRST (1u << 25)

#define BUFFER_MOST ((uint64_t)256 << 20) /* of buffers that grow with the picture */
#define QUAD        ((uint64_t)16)

struct framer *framer_make(struct vk *vk, bool brute)
{
    struct framer *framer = alloc_zeroed(1, sizeof *framer);
    if (framer)
        *framer = (struct framer){.vk = vk, .brute = brute};
    return framer;
}

static void free_buffers(struct framer *framer)
{
    vk_buffers_free(framer->vk, framer->buffer, FRAME_BINDINGS);
}

void framer_free(struct framer *framer)
{
    if (!framer)
        return;
    free_buffers(framer);
    pipelines_free(&framer->pipelines, framer->vk);
    free(framer);
}

enum frame_plan framer_plan(const struct framer *framer)
{
    return framer->dispatch.plan;
}

uint32_t framer_pipelines(const struct framer *framer)
{
    return (uint32_t)framer->pipelines.count;
}

/* --- preparation ------------------------------------------------------------------------------ */

/* Uploads lights, triangles and materials, one after the other. */
static enum status upload_shading(struct framer *framer, const struct frame_job *job,
                                  struct reason *reason)
{
    const uint32_t tri_count = job->job.scene->tri_count;
    const uint64_t tri_at = ABI_LIGHTS_MOST * sizeof *job->light;
    const uint64_t material_at = tri_at + tri_count * sizeof *job->shade;
    const uint64_t bytes = material_at + job->material_count * sizeof *job->material;
    struct vk_buffer **buffer = &framer->buffer[ABI_BIND_SHADE];
    enum status status = vk_buffer_make(framer->vk, bytes, buffer, reason);
    if (!status && job->light_count)
        status = vk_buffer_write(framer->vk, *buffer, 0, job->light,
                                 job->light_count * sizeof *job->light, reason);
    if (!status && tri_count)
        status = vk_buffer_write(framer->vk, *buffer, tri_at, job->shade,
                                 tri_count * sizeof *job->shade, reason);
    if (!status)
        status = vk_buffer_write(framer->vk, *buffer, material_at, job->material,
                                 job->material_count * sizeof *job->material, reason);
    return status;
}

static enum status upload_tree(struct framer *framer, const struct packed *packed,
                               struct reason *reason)
{
    static const struct packed none;
    const struct packed *tree = framer->brute ? &none : packed;
    enum status status = vk_buffer_make_of(framer->vk, tree->word, packed_node_bytes(tree),
                                           &framer->buffer[ABI_BIND_NODES], reason);
    return status ? status
                  : vk_buffer_make_of(framer->vk, tree->item, packed_item_bytes(tree),
                                      &framer->buffer[ABI_BIND_ITEMS], reason);
}

static uint32_t first_batch(const struct frame_dispatch *dispatch)
{
    const uint64_t tile = (uint64_t)dispatch->tile * dispatch->tile;
    const uint64_t tiles = COST_FIRST / (dispatch->cost * tile + 1);
    return tiles ? (uint32_t)tiles : 1;
}

enum status framer_prepare(struct framer *framer, const struct frame_job *job,
                           struct reason *reason)
{
    free_buffers(framer);
    framer->prepared = false;
    framer->job = *job;
    enum status status =
        frame_dispatch_make(job, framer->brute, vk_limits(framer->vk), &framer->dispatch, reason);
    if (status)
        return status;
    framer->batch = first_batch(&framer->dispatch);
    status = upload_tree(framer, job->job.packed, reason);
    if (!status)
        status =
            gather_triangles(framer->vk, job->job.scene, &framer->buffer[ABI_BIND_TRIS], reason);
    if (!status)
        status = upload_shading(framer, job, reason);
    framer->prepared = !status;
    if (status)
        free_buffers(framer);
    return status;
}

/* --- drawing ---------------------------------------------------------------------------------- */

/* Bytes that a pixel needs in the buffer of `binding`. */
static uint64_t pixel_bytes(const struct framer *framer, uint32_t look, uint32_t binding)
{
    switch (binding) {
    case ABI_BIND_STATE:
        return framer->dispatch.plan == FRAME_STEPS ? ABI_STATE_QUADS * QUAD : 0;
    case ABI_BIND_PIXELS:
        return sizeof(uint32_t);
    case ABI_BIND_SEGMENTS:
        return look & ABI_LOOK_SEGMENTS ? framer->job.look.bounces * sizeof(struct segment) : 0;
    case ABI_BIND_COLORS:
        return look & ABI_LOOK_COLORS ? 3 * sizeof(float) : 0;
    default:
        return 0;
    }
}

/* Bytes before those of the pixels. */
static uint64_t head_bytes(const struct framer *framer, uint32_t binding)
{
    return binding == ABI_BIND_STATE && framer->dispatch.plan == FRAME_STEPS ? ABI_STATE_HEAD * QUAD
                                                                             : 0;
}

static const uint32_t per_pixel[] = {ABI_BIND_STATE, ABI_BIND_PIXELS, ABI_BIND_SEGMENTS,
                                     ABI_BIND_COLORS};

/* Sets *out to the rows, in whole tiles, that all buffers can hold. */
static enum status rows_at_once(const struct framer *framer, uint32_t look, uint32_t *out,
                                struct reason *reason)
{
    const struct vk_limits *limits = vk_limits(framer->vk);
    const uint32_t tile = framer->dispatch.tile, width = framer->job.width;
    uint64_t rows = (framer->job.height + tile - 1) / tile * tile, worst = 0;
    for (size_t i = 0; i < ARRAY_COUNT(per_pixel); i++) {
        const uint64_t bytes = pixel_bytes(framer, look, per_pixel[i]) * width;
        const uint64_t most =
            (BUFFER_MOST < limits->buffer_bytes ? BUFFER_MOST : limits->buffer_bytes) -
            head_bytes(framer, per_pixel[i]);
        worst = bytes > worst ? bytes : worst;
        if (bytes && most / bytes < rows)
            rows = most / bytes / tile * tile;
    }
    if (rows == 0 && worst * tile <= limits->buffer_bytes)
        rows = tile; /* over BUFFER_MOST, but within the device's limit */
    *out = (uint32_t)rows;
    if (rows == 0)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %u rows of %u pixels need buffers of %llu bytes, %s allows %llu", tile,
                    width, (unsigned long long)(worst * tile), limits->device,
                    (unsigned long long)limits->buffer_bytes);
    return STATUS_OK;
}

/* Makes the buffers hold `rows` rows. A new pixel buffer is zeroed; no slab has serial 0. */
static enum status reserve(struct framer *framer, uint32_t look, uint32_t rows,
                           struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(per_pixel) && !status; i++) {
        struct vk_buffer **buffer = &framer->buffer[per_pixel[i]];
        const uint64_t bytes = pixel_bytes(framer, look, per_pixel[i]) * framer->job.width * rows +
                               head_bytes(framer, per_pixel[i]);
        if (*buffer && vk_buffer_bytes(*buffer) >= bytes)
            continue;
        status = vk_buffer_grow(framer->vk, bytes, buffer, reason);
        if (status || per_pixel[i] != ABI_BIND_PIXELS)
            continue;
        void *zero = alloc_zeroed(bytes, 1);
        if (!zero)
            return fail(reason, STATUS_MEMORY, "vulkan: no memory for %llu bytes of pixels",
                        (unsigned long long)bytes);
        status = vk_buffer_write(framer->vk, *buffer, 0, zero, bytes, reason);
        free(zero);
    }
    return status;
}

/* Checks and removes serial and flags of the pixels. *trouble has the flags of the first unfinished
 * pixel. */
static enum status check_pixels(struct framer *framer, const struct slab *slab, uint32_t *pixel,
                                uint32_t *trouble, struct reason *reason)
{
    const uint32_t good = ABI_FLAG_DONE | framer->serial << ABI_FLAG_BITS;
    const size_t count = (size_t)slab->rows * framer->job.width;
    for (size_t i = 0; i < count; i++) {
        const uint32_t flags = pixel[i] >> 24;
        if (flags != good) {
            const bool old = flags >> ABI_FLAG_BITS != framer->serial;
            *trouble = old ? 0 : flags & ((1u << ABI_FLAG_BITS) - 1);
            return fail(
                reason, STATUS_DEVICE, "vulkan: %s: the path of pixel %u,%u was not finished: %s",
                vk_limits(framer->vk)->device, (uint32_t)(i % framer->job.width),
                (uint32_t)(slab->first_row + i / framer->job.width), dispatch_cause(*trouble));
        }
        pixel[i] |= 0xFF000000u;
    }
    return STATUS_OK;
}

static enum status read_slab(struct framer *framer, const struct slab *slab, struct frame *out,
                             uint32_t *trouble, struct reason *reason)
{
    const uint64_t count = (uint64_t)slab->rows * framer->job.width;
    const uint64_t first = (uint64_t)slab->first_row * framer->job.width;
    const uint64_t bounces = framer->job.look.bounces;
    enum status status = vk_buffer_read(framer->vk, framer->buffer[ABI_BIND_PIXELS], 0,
                                        out->pixel + first, count * sizeof *out->pixel, reason);
    if (!status)
        status = check_pixels(framer, slab, out->pixel + first, trouble, reason);
    if (!status && out->color)
        status = vk_buffer_read(framer->vk, framer->buffer[ABI_BIND_COLORS], 0,
                                out->color + 3 * first, count * 3 * sizeof *out->color, reason);
    if (!status && out->segment && bounces)
        status = vk_buffer_read(framer->vk, framer->buffer[ABI_BIND_SEGMENTS], 0,
                                out->segment + bounces * first,
                                count * bounces * sizeof *out->segment, reason);
    return status;
}

static void place_view(const struct view *view, struct frame_push *push)
{
    memcpy(push->pos, view->pos, sizeof push->pos);
    memcpy(push->right, view->right, sizeof push->right);
    memcpy(push->up, view->up, sizeof push->up);
    memcpy(push->forward, view->forward, sizeof push->forward);
    push->centre = view->centre;
}

/* Draws by the plan of framer->dispatch. *trouble has the flags of an unfinished path. */
static enum status draw(struct framer *framer, const struct view *view, struct frame *out,
                        struct trace_report *report, uint32_t *trouble, struct reason *reason)
{
    const uint32_t height = framer->job.height;
    const uint32_t look =
        (out->segment ? ABI_LOOK_SEGMENTS : 0) | (out->color ? ABI_LOOK_COLORS : 0);
    struct frame_dispatch dispatch = framer->dispatch;
    uint32_t rows = 0;
    *report = (struct trace_report){.device_clock = true};
    place_view(view, &dispatch.push);
    dispatch.constant[ABI_SPEC_LOOK] |= look;
    enum status status = rows_at_once(framer, look, &rows, reason);
    if (!status)
        status = reserve(framer, look, rows, reason);
    for (uint32_t row = 0; row < height && !status; row += rows) {
        const struct slab slab = {row, height - row < rows ? height - row : rows};
        framer->serial = framer->serial % (ABI_SERIALS - 1) + 1;
        dispatch.push.serial = framer->serial;
        status = framer_slab(framer, &dispatch, &slab, report, reason);
        if (!status)
            status = read_slab(framer, &slab, out, trouble, reason);
    }
    return status;
}

enum status framer_draw(struct framer *framer, const struct view *view, struct frame *out,
                        struct trace_report *report, struct reason *reason)
{
    uint32_t trouble = 0;
    *report = (struct trace_report){0};
    if (!framer || !framer->prepared)
        return fail(reason, STATUS_DEVICE, "vulkan: no frame is prepared to be drawn");
    enum status status = draw(framer, view, out, report, &trouble, reason);
    if (status == STATUS_DEVICE && trouble & ABI_FLAG_LOOP && framer->job.plan == FRAME_AUTO &&
        framer->dispatch.plan == FRAME_WHOLE) {
        frame_dispatch_plan(&framer->dispatch, FRAME_STEPS);
        trouble = 0;
        status = draw(framer, view, out, report, &trouble, reason);
    }
    report->flags = trouble;
    for (uint32_t i = 0; i < FRAME_BINDINGS; i++)
        report->memory_bytes += vk_buffer_bytes(framer->buffer[i]);
    if (!status && vk_messages(framer->vk, reason))
        status = STATUS_DEVICE;
    return status;
}
