/* A reader of the buffers of a form, as the Vulkan specification says that they are read. Include
 * after cmocka.h. */
#ifndef FORM_READER_H
#define FORM_READER_H

#include "gpu/accel/accel_format.h"
#include "gpu/accel/accel_input.h"

#include <math.h>
#include <string.h>

/* What a geometry is read from. */
struct form_reader {
    const struct accel_input *input;
    const struct vk_accel_form *form;
    const uint8_t *vertices;
    const struct accel_format_facts *format;
    uint32_t largest;    /* number of a vertex that was read */
    uint8_t *read;       /* of each byte of the vertices, whether it was; or NULL */
    uint64_t indices_to; /* the end of the indices that were read */
};

static inline const struct accel_format_facts *format_of(uint32_t vk_format)
{
    for (size_t i = 0; i < ACCEL_FORMATS; i++)
        if (accel_format[i].vk_format == vk_format)
            return &accel_format[i];
    fail_msg("no format %u", vk_format);
    return NULL;
}

/* Of geometry `part`, from its vertices or from those before an update. */
static inline struct form_reader form_reader_make(const struct accel_input *input, uint32_t part,
                                                  const uint8_t *vertices)
{
    return (struct form_reader){.input = input,
                                .form = &input->form[part],
                                .vertices = vertices,
                                .format = format_of(input->form[part].format)};
}

static inline uint64_t little(const uint8_t *from, uint32_t bytes)
{
    uint64_t number = 0;
    for (uint32_t i = 0; i < bytes; i++)
        number |= (uint64_t)from[i] << 8 * i;
    return number;
}

static inline double half_of(uint32_t bits)
{
    const int exponent = (int)(bits >> 10 & 31);
    const double fraction = (double)(bits & 1023);
    const double size = exponent == 31  ? (fraction > 0 ? (double)NAN : (double)INFINITY)
                        : exponent == 0 ? ldexp(fraction, -24)
                                        : ldexp(1024 + fraction, exponent - 25);
    return bits >> 15 ? -size : size;
}

/* A component, as "Fixed-Point Data Conversion" and the formats of float have it. */
static inline double component(const struct accel_format_facts *format, const uint8_t *at,
                               uint32_t k)
{
    const uint32_t bytes = format->bits / 8;
    uint64_t raw =
        format->packed ? little(at, 4) >> format->bits * k & 1023 : little(at + k * bytes, bytes);
    const double most = (double)(UINT64_MAX >> (64 - format->bits + (format->kind == ACCEL_SNORM)));
    if (format->kind == ACCEL_UNORM)
        return (double)raw / most;
    if (format->kind == ACCEL_SNORM) {
        const double number =
            (double)(int64_t)(raw << (64 - format->bits)) / ldexp(1.0, 64 - (int)format->bits);
        return number / most < -1 ? -1 : number / most;
    }
    if (format->bits == 16)
        return half_of((uint32_t)raw);
    float narrow;
    double wide;
    const uint32_t word = (uint32_t)raw;
    memcpy(&narrow, &word, sizeof narrow);
    memcpy(&wide, &raw, sizeof wide);
    return format->bits == 32 ? (double)narrow : wide;
}

/* Vertex `corner` of triangle `tri` in object space. */
static inline void vertex_of(struct form_reader *r, uint32_t tri, uint32_t corner, float to[3])
{
    const struct vk_accel_form *form = r->form;
    uint64_t index = 3ull * tri + corner, base = form->vertices_at;
    if (form->index_bytes) {
        const uint64_t at = form->indices_at + form->primitive_offset + index * form->index_bytes;
        assert_true(at % form->index_bytes == 0 && at + form->index_bytes <= r->input->index_bytes);
        index = little(r->input->indices + at, form->index_bytes);
        r->indices_to =
            at + form->index_bytes > r->indices_to ? at + form->index_bytes : r->indices_to;
    } else {
        base += form->primitive_offset;
    }
    const uint64_t number = index + (form->index_bytes ? form->first_vertex : 0);
    assert_true(number <= form->max_vertex);
    r->largest = number > r->largest ? (uint32_t)number : r->largest;
    const uint64_t at = base + form->stride * (index + form->first_vertex);
    assert_true(at % r->format->align == 0 && at + r->format->bytes <= r->input->vertex_bytes);
    const uint32_t bytes = r->format->packed ? 4 : r->format->bits / 8;
    for (uint32_t k = 0; r->read && k < 3 && k < r->format->components; k++)
        memset(r->read + at + (r->format->packed ? 0 : k * bytes), 1, bytes);
    double v[4] = {0, 0, 0, 1};
    for (uint32_t k = 0; k < 3 && k < r->format->components; k++)
        v[k] = component(r->format, r->vertices + at, k);
    for (uint32_t k = 0; k < 3; k++)
        to[k] = (float)v[k];
    if (form->transform_at == VK_ACCEL_NO_TRANSFORM)
        return;
    float m[3][4];
    const uint64_t where = form->transform_at + form->transform_offset;
    assert_true(where % 16 == 0 && where + sizeof m <= r->input->transform_bytes);
    memcpy(m, r->input->transforms + where, sizeof m);
    for (uint32_t k = 0; k < 3; k++)
        to[k] = (float)((double)m[k][0] * v[0] + (double)m[k][1] * v[1] + (double)m[k][2] * v[2] +
                        (double)m[k][3]);
}

#endif
