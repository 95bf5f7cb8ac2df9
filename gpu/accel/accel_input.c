#include "gpu/accel/accel_input.h"

#include "gpu/accel/accel_format.h"
#include "gpu/accel/accel_window.h"

#include <stdlib.h>
#include <string.h>

#define TRANSFORM_BYTES (12 * sizeof(float))

/* --- buffers ---------------------------------------------------------------------------------- */

/* A buffer that grows; `unread` is the byte of what no driver may read. */
struct accel_bytes {
    uint8_t *byte;
    size_t count, capacity;
    uint8_t unread;
};

/* Adds bytes that no driver may read, up to a multiple of `align`. */
static enum status grow(struct accel_bytes *to, size_t bytes, size_t align, struct reason *reason)
{
    const size_t end = (to->count + bytes + align - 1) / align * align;
    if (array_reserve(&to->byte, &to->capacity, end + 1, 1))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %zu bytes of triangles", end);
    memset(to->byte + to->count, to->unread, end - to->count);
    to->count = end;
    return STATUS_OK;
}

/* The buffers of an input while they are filled. */
struct accel_filling {
    const struct accel_variant *variant;
    const float *earlier; /* where the scene's vertices were, or NULL */
    struct accel_bytes vertices, before, indices, transforms;
    uint32_t stride;
};

/* Adds such bytes to both buffers of vertices. */
static enum status grow_vertices(struct accel_filling *f, size_t bytes, size_t align,
                                 struct reason *reason)
{
    enum status status = grow(&f->vertices, bytes, align, reason);
    return status ? status : grow(&f->before, bytes, align, reason);
}

/* --- one part --------------------------------------------------------------------------------- */

/* The number in a window of vertex `i` of those that are written. */
static uint32_t written(const struct accel_filling *f, const struct accel_window *window, size_t i)
{
    return f->variant->index == ACCEL_UNINDEXED ? window->corner[i] : (uint32_t)i;
}

/* Where a vertex of a window is before an update: where it was earlier, or where the next one is;
 * what is NaN stays so. */
static const float *before_of(const struct accel_filling *f, const struct accel_window *window,
                              uint32_t own)
{
    const struct accel_vertex *vertex = &window->vertex[own];
    if (f->earlier)
        return f->earlier + 3 * (size_t)vertex->number;
    return vertex->nan ? vertex->at : window->vertex[(own + 1) % window->real_count].at;
}

/* Writes the vertices of a window behind `lead` others. */
static enum status put_vertices(struct accel_filling *f, const struct accel_window *window,
                                uint32_t number, size_t lead, struct reason *reason)
{
    const enum accel_format format = f->variant->format;
    const bool unindexed = f->variant->index == ACCEL_UNINDEXED;
    const size_t count = unindexed ? 3 * (size_t)window->tri_count : window->vertex_count;
    size_t at = f->vertices.count + lead * f->stride;
    enum status status = grow_vertices(f, (lead + count) * f->stride, 1, reason);
    for (size_t i = 0; i < count && !status; i++, at += f->stride) {
        const uint32_t own = written(f, window, i);
        const struct accel_vertex *vertex = &window->vertex[own];
        float now[3], then[3];
        const bool exact = accel_untransform(f->variant, number, vertex->at, now);
        (void)accel_untransform(f->variant, number, before_of(f, window, own), then);
        if (vertex->nan) {
            accel_encode_nan(format, now, f->vertices.byte + at);
            accel_encode_nan(format, then, f->before.byte + at);
            continue;
        }
        (void)accel_encode(format, then, f->before.byte + at);
        if (!accel_encode(format, now, f->vertices.byte + at) || !exact)
            return fail(reason, STATUS_LIMIT,
                        "rayquery: vertex %u of the mesh, (%.9g, %.9g, %.9g), would be rounded: "
                        "format %s%s",
                        vertex->number, (double)vertex->at[0], (double)vertex->at[1],
                        (double)vertex->at[2], accel_format[format].name,
                        f->variant->transform ? " behind a transform" : "");
    }
    return status;
}

/* Writes the indices of a window, each with `base` added. */
static enum status put_indices(struct accel_filling *f, const struct accel_window *window,
                               uint32_t base, const struct vk_accel_form *form,
                               struct reason *reason)
{
    size_t at = (size_t)form->indices_at + form->primitive_offset;
    const size_t bytes = form->index_bytes;
    enum status status =
        grow(&f->indices, at - f->indices.count + 3 * window->tri_count * bytes, 4, reason);
    for (size_t i = 0; i < 3 * (size_t)window->tri_count && !status; i++, at += bytes) {
        const uint32_t index = base + window->corner[i];
        const uint16_t narrow = (uint16_t)index;
        memcpy(f->indices.byte + at, bytes == 2 ? (const void *)&narrow : &index, bytes);
    }
    return status;
}

static enum status put_transform(struct accel_filling *f, uint32_t number,
                                 struct vk_accel_form *form, struct reason *reason)
{
    float m[3][4];
    form->transform_at = VK_ACCEL_NO_TRANSFORM;
    if (!accel_transform_of(f->variant, number, m))
        return STATUS_OK;
    form->transform_at = f->transforms.count;
    form->transform_offset = f->variant->offset ? (uint32_t)TRANSFORM_BYTES : 0;
    const size_t at = f->transforms.count + form->transform_offset;
    enum status status = grow(&f->transforms, form->transform_offset + sizeof m, 1, reason);
    if (!status)
        memcpy(f->transforms.byte + at, m, sizeof m);
    return status;
}

/* What is added to indices, so that 16 bits are used to the last in one part of a mesh. */
static uint32_t base_of(const struct accel_filling *f, const struct accel_window *window,
                        uint32_t number)
{
    if (!f->variant->offset || f->variant->index == ACCEL_UNINDEXED)
        return 0;
    return f->variant->index == ACCEL_U16 && number == 0 ? WINDOW_MOST - window->vertex_count : 0;
}

static enum status put_part(struct accel_filling *f, const struct accel_window *window,
                            uint32_t number, struct vk_accel_form *form, struct reason *reason)
{
    const struct accel_variant *variant = f->variant;
    const struct accel_format_facts *format = &accel_format[variant->format];
    const bool indexed = variant->index != ACCEL_UNINDEXED, offset = variant->offset;
    const uint32_t base = base_of(f, window, number);
    const size_t lead = variant->first_vertex ? 3 + number % 5 : 0;
    if (indexed && variant->index == ACCEL_U16 && window->vertex_count > WINDOW_MOST)
        return fail(reason, STATUS_LIMIT,
                    "rayquery: geometry %u has %u vertices, 16-bit indices reach %u", number,
                    window->vertex_count, WINDOW_MOST);
    enum status status = grow_vertices(f, offset ? 3 * format->align : 0, format->align, reason);
    if (!status)
        status = grow(&f->indices, offset ? 8 : 0, 4, reason);
    if (status)
        return status;
    *form = (struct vk_accel_form){
        .format = format->vk_format,
        .index_bytes = !indexed                      ? 0
                       : variant->index == ACCEL_U16 ? 2
                                                     : 4,
        .vertices_at = f->vertices.count,
        .stride = f->stride,
        .indices_at = indexed ? f->indices.count : 0,
        .first_vertex = (uint32_t)lead,
    };
    if (offset)
        form->primitive_offset = indexed ? 6 * form->index_bytes : 2 * f->stride + format->align;
    if (!indexed && offset) /* primitive_offset is of the vertices then */
        status = grow_vertices(f, form->primitive_offset, 1, reason);
    if (!status)
        status = put_vertices(f, window, number, lead + base, reason);
    /* A driver that adds the first vertex twice reads garbage, but none that is not ours. */
    if (!status)
        status = grow_vertices(f, lead * f->stride, 1, reason);
    if (!status && indexed)
        status = put_indices(f, window, base, form, reason);
    form->max_vertex =
        (uint32_t)lead + base + (indexed ? window->vertex_count : 3 * window->tri_count);
    form->max_vertex -= form->max_vertex > 0;
    return status ? status : put_transform(f, number, form, reason);
}

/* --- all -------------------------------------------------------------------------------------- */

enum status accel_input_make(const struct scene *scene, const float *earlier,
                             const struct accel_part *part, uint32_t part_count,
                             const struct accel_variant *variant, struct accel_input *out,
                             struct reason *reason)
{
    struct accel_filling f = {.variant = variant,
                              .earlier = earlier,
                              .vertices.unread = 0xFF,
                              .before.unread = 0xFF,
                              .transforms.unread = 0xFF,
                              .stride = variant->stride ? variant->stride
                                                        : accel_format[variant->format].bytes};
    struct accel_window window = {.vertex = NULL};
    *out = (struct accel_input){.part_count = part_count};
    out->form = alloc_zeroed(part_count, sizeof *out->form);
    out->count = alloc_zeroed(part_count, sizeof *out->count);
    enum status status = window_begin(&window, scene, reason);
    if (!status && (!out->form || !out->count))
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for %u geometries", part_count);
    for (uint32_t i = 0; i < part_count && !status; i++) {
        status = window_fill(&window, scene, part[i].first, part[i].count, variant, reason);
        if (!status)
            status = put_part(&f, &window, i, &out->form[i], reason);
        out->count[i] = window.tri_count;
    }
    window_end(&window);
    out->vertices = f.vertices.byte;
    out->before = f.before.byte;
    out->indices = f.indices.byte;
    out->transforms = f.transforms.byte;
    out->vertex_bytes = f.vertices.count;
    out->index_bytes = f.indices.count;
    out->transform_bytes = f.transforms.count;
    return status;
}

void accel_input_free(struct accel_input *input)
{
    free(input->vertices);
    free(input->before);
    free(input->indices);
    free(input->transforms);
    free(input->form);
    free(input->count);
    *input = (struct accel_input){.part_count = 0};
}
