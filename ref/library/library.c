/* The public library: triangles, errors and names. */
#include "ref/library/library.h"

#include "ref/base/nearest_name.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint32_t raydiff_version(void)
{
    return (uint32_t)RAYDIFF_VERSION_MAJOR << 16 | (uint32_t)RAYDIFF_VERSION_MINOR << 8 |
           (uint32_t)RAYDIFF_VERSION_PATCH;
}

void library_goes_on(const char *truth, const char *file, int line)
{
    (void)truth, (void)file, (void)line;
}

enum raydiff_error library_end(unsigned long modes, enum status status, const struct reason *reason,
                               struct raydiff_why *why)
{
    static const enum raydiff_error error[] = {
        [STATUS_OK] = RAYDIFF_ERROR_NONE,         [STATUS_MEMORY] = RAYDIFF_ERROR_MEMORY,
        [STATUS_INPUT] = RAYDIFF_ERROR_INPUT,     [STATUS_LIMIT] = RAYDIFF_ERROR_LIMIT,
        [STATUS_REFUSED] = RAYDIFF_ERROR_STOPPED, [STATUS_UNSUPPORTED] = RAYDIFF_ERROR_UNSUPPORTED,
        [STATUS_DEVICE] = RAYDIFF_ERROR_INTERNAL, [STATUS_INTERNAL] = RAYDIFF_ERROR_INTERNAL,
    };
    library_modes(modes);
    if (why)
        snprintf(why->line, sizeof why->line, "%s", reason->text);
    return error[status];
}

enum status library_given(const void *pointer, const char *what, struct reason *reason)
{
    return pointer ? STATUS_OK : fail(reason, STATUS_INPUT, "%s: is NULL", what);
}

enum status library_find(const char *what, const char *word, const char *(*name)(uint32_t),
                         uint32_t *out, struct reason *reason)
{
    char hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(word, strlen(word));
    *out = 0;
    for (uint32_t i = 0; name(i); i++) {
        if (strcmp(name(i), word) == 0) {
            *out = i;
            return STATUS_OK;
        }
        nearest_try(&nearest, name(i));
    }
    return fail(reason, STATUS_INPUT, "%s: there is no '%.40s'%s", what, word,
                nearest_hint(&nearest, hint));
}

enum status library_scene(const struct raydiff_case *from, struct scene *out, struct reason *reason)
{
    const size_t vertices = from->vertex_count, triangles = from->triangle_count;
    *out = (struct scene){0};
    enum status status = vertices ? library_given(from->vertex, "vertices", reason) : STATUS_OK;
    if (!status && triangles)
        status = library_given(from->index, "indices", reason);
    if (status)
        return status;
    /* Looked at where they are: a copy of what is wrong may be a large one. */
    const struct scene borrowed = {.vertex = (float *)(uintptr_t)from->vertex,
                                   .index = (uint32_t *)(uintptr_t)from->index,
                                   .vertex_count = from->vertex_count,
                                   .tri_count = from->triangle_count};
    status = scene_check(&borrowed, reason);
    if (!status && triangles == RAYDIFF_NOTHING)
        status = fail(reason, STATUS_LIMIT, "more than 4294967294 triangles");
    if (!status && scene_make(from->vertex_count, from->triangle_count, out))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu triangles", triangles);
    if (status)
        return status;
    if (vertices)
        memcpy(out->vertex, from->vertex, 3 * vertices * sizeof *out->vertex);
    if (triangles)
        memcpy(out->index, from->index, 3 * triangles * sizeof *out->index);
    return STATUS_OK;
}

enum raydiff_error raydiff_oracle_make(const float *vertex, uint32_t vertex_count,
                                       const uint32_t *index, uint32_t triangle_count,
                                       struct raydiff_oracle **out, struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    const struct raydiff_case from = {vertex, index, vertex_count, triangle_count, NULL};
    struct reason reason = {""};
    struct raydiff_oracle *oracle = NULL;
    enum status status = library_given(out, "out", &reason);
    if (status)
        return library_end(modes, status, &reason, why);
    *out = NULL;
    oracle = alloc_zeroed(1, sizeof *oracle);
    if (!oracle)
        status = fail(&reason, STATUS_MEMORY, "no memory for an oracle");
    if (!status)
        status = library_scene(&from, &oracle->scene, &reason);
    if (!status)
        status = oracle_make(&oracle->scene, &oracle->oracle, &reason);
    if (status)
        raydiff_oracle_free(oracle);
    else
        *out = oracle;
    return library_end(modes, status, &reason, why);
}

void raydiff_oracle_free(struct raydiff_oracle *oracle)
{
    if (!oracle)
        return;
    oracle_free(oracle->oracle);
    scene_free(&oracle->scene);
    world_free(&oracle->world);
    free(oracle);
}
