#include "gpu/accel/accel_window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- transforms ------------------------------------------------------------------------------- */

bool accel_transform_of(const struct accel_variant *variant, uint32_t number, float m[3][4])
{
    memset(m, 0, 12 * sizeof(float));
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t from = variant->transform == ACCEL_TURNED ? (k + number + 1) % 3 : k;
        const float size =
            variant->transform == ACCEL_SCALED ? ldexpf(1.0f, 1 + (int)((number + k) % 4)) : 1.0f;
        const bool mirrored = variant->transform == ACCEL_TURNED && (number + k) % 2;
        m[k][from] = mirrored ? -size : size;
        m[k][3] = variant->transform == ACCEL_MOVED ? (float)(4 + number % 8 + k) : 0.0f;
    }
    return variant->transform != ACCEL_TRANSFORM_NONE;
}

bool accel_untransform(const struct accel_variant *variant, uint32_t number, const float at[3],
                       float to[3])
{
    float m[3][4];
    bool exact = true;
    memcpy(to, at, 3 * sizeof *to);
    if (!accel_transform_of(variant, number, m))
        return true;
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t i = 0; i < 3; i++)
            if (m[k][i] != 0.0f)
                to[i] = (at[k] - m[k][3]) / m[k][i];
    for (uint32_t k = 0; k < 3; k++) {
        double sum = (double)m[k][3];
        for (uint32_t i = 0; i < 3; i++)
            sum += (double)m[k][i] * (double)to[i];
        exact = exact && sum == (double)at[k] && !(to[k] != 0.0f && fabsf(to[k]) < 1e-37f);
    }
    return exact;
}

/* --- windows ---------------------------------------------------------------------------------- */

static enum status no_memory(struct reason *reason)
{
    return fail(reason, STATUS_MEMORY, "vulkan: no memory for the vertices of a geometry");
}

enum status window_begin(struct accel_window *out, const struct scene *scene, struct reason *reason)
{
    *out = (struct accel_window){.vertex = NULL};
    out->local = alloc_zeroed(scene->vertex_count, sizeof *out->local);
    out->stamp = alloc_zeroed(scene->vertex_count, sizeof *out->stamp);
    return out->local && out->stamp ? STATUS_OK : no_memory(reason);
}

void window_end(struct accel_window *window)
{
    free(window->vertex);
    free(window->corner);
    free(window->local);
    free(window->stamp);
}

static enum status add_vertex(struct accel_window *window, struct accel_vertex vertex,
                              uint32_t *number)
{
    enum status status = array_reserve(&window->vertex, &window->vertex_capacity,
                                       (size_t)window->vertex_count + 1, sizeof vertex);
    if (status)
        return status;
    *number = window->vertex_count++;
    window->vertex[*number] = vertex;
    return STATUS_OK;
}

static enum status add_triangle(struct accel_window *window, const uint32_t corner[3])
{
    enum status status = array_reserve(&window->corner, &window->corner_capacity,
                                       3 * ((size_t)window->tri_count + 1), sizeof *window->corner);
    if (status)
        return status;
    memcpy(window->corner + 3 * (size_t)window->tri_count++, corner, 3 * sizeof *corner);
    return STATUS_OK;
}

static enum status add_scene_triangle(struct accel_window *window, const struct scene *scene,
                                      uint32_t tri)
{
    uint32_t corner[3];
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && !status; k++) {
        const uint32_t i = scene->index[3 * (size_t)tri + (size_t)k];
        if (window->stamp[i] != window->fills) {
            struct accel_vertex vertex = {.number = i};
            memcpy(vertex.at, scene->vertex + 3 * (size_t)i, sizeof vertex.at);
            window->stamp[i] = window->fills;
            status = add_vertex(window, vertex, &window->local[i]);
        }
        corner[k] = window->local[i];
    }
    return status ? status : add_triangle(window, corner);
}

/* Adds triangles like others of the window, but with a NaN in the x of one vertex. */
static enum status add_nan(struct accel_window *window, uint32_t count)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < window_added(count) && !status; i++) {
        const uint32_t *like = window->corner + 3 * (size_t)(8 * i < count ? 8 * i : 0);
        uint32_t corner[3] = {like[0], like[1], like[2]};
        struct accel_vertex vertex = window->vertex[like[i % 3]];
        vertex.nan = true;
        status = add_vertex(window, vertex, &corner[i % 3]);
        if (!status)
            status = add_triangle(window, corner);
    }
    return status;
}

/* Adds triangles of one or two points. */
static enum status add_degenerate(struct accel_window *window, uint32_t count)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < window_added(count) && !status; i++) {
        const uint32_t *like = window->corner + 3 * (size_t)(8 * i < count ? 8 * i : 0);
        const uint32_t a = like[i % 3], b = i % 2 ? a : like[(i + 1) % 3];
        status = add_triangle(window, (const uint32_t[]){a, b, a});
    }
    return status;
}

enum status window_fill(struct accel_window *window, const struct scene *scene, uint32_t first,
                        uint32_t count, const struct accel_variant *variant, struct reason *reason)
{
    enum status status = STATUS_OK;
    window->vertex_count = window->tri_count = 0;
    window->fills++;
    for (uint32_t i = 0; i < count && !status; i++)
        status = add_scene_triangle(window, scene, first + i);
    window->real_count = window->vertex_count;
    if (!status && variant->nan)
        status = add_nan(window, count);
    if (!status && variant->degenerate)
        status = add_degenerate(window, count);
    return status ? no_memory(reason) : STATUS_OK;
}

/* --- geometries ------------------------------------------------------------------------------- */

/* Returns how many triangles from `first` on, at most `most`, have few enough vertices for the
 * variant's indices, with what is added. */
static uint32_t reach_of(struct accel_window *window, const struct scene *scene, uint32_t first,
                         uint32_t most, const struct accel_variant *variant)
{
    uint32_t vertices = 0, i = 0;
    window->fills++;
    for (; i < most && variant->index == ACCEL_U16; i++) {
        if (vertices + 3 + window_added(i + 1) > WINDOW_MOST)
            return i;
        for (int k = 0; k < 3; k++) {
            uint32_t *stamp = &window->stamp[scene->index[3 * (size_t)(first + i) + (size_t)k]];
            vertices += *stamp != window->fills;
            *stamp = window->fills;
        }
    }
    return most;
}

enum status accel_split(const struct scene *scene, const struct accel_variant *variant,
                        struct accel_part **out, uint32_t *count, struct reason *reason)
{
    const uint32_t pieces = variant->split ? variant->split : 1;
    struct accel_window window;
    size_t capacity = 0;
    uint32_t first = 0;
    enum status status = window_begin(&window, scene, reason);
    *out = NULL;
    *count = 0;
    for (uint32_t piece = 0; piece < pieces && !status;) {
        const uint32_t end = (uint32_t)((uint64_t)scene->tri_count * (piece + 1) / pieces);
        const uint32_t part = reach_of(&window, scene, first, end - first, variant);
        status = array_reserve(out, &capacity, (size_t)*count + 1, sizeof **out);
        if (status)
            break;
        (*out)[(*count)++] = (struct accel_part){first, part};
        first += part;
        piece += first == end;
    }
    window_end(&window);
    return status ? no_memory(reason) : STATUS_OK;
}
