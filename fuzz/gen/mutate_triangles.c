/* Edits of which triangles there are and of what they share. */
#include "fuzz/gen/mutate_inner.h"

#include <stdlib.h>
#include <string.h>

/* An edit makes no trial larger than this one. */
#define GROWN_MOST 128u

static void put_index(uint32_t *place, uint32_t index, bool *changed)
{
    *changed = *changed || *place != index;
    *place = index;
}

/* One triangle once more: at the end while the scene is small, else in place of another. */
enum status edit_duplicate(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct scene *scene = &trial->scene;
    if (scene->tri_count == 0)
        return STATUS_OK;
    uint32_t from = rng_below(rng, scene->tri_count), to = rng_below(rng, scene->tri_count);
    if (scene->tri_count < GROWN_MOST && rng_below(rng, 2)) {
        uint32_t *index = realloc(scene->index, 12 * ((size_t)scene->tri_count + 1));
        if (!index)
            return STATUS_MEMORY;
        scene->index = index;
        to = scene->tri_count++;
        memset(index + 3 * (size_t)to, 0, 12);
        *changed = true;
    }
    for (uint32_t c = 0; c < 3; c++)
        put_index(&scene->index[3 * (size_t)to + c], scene->index[3 * (size_t)from + c], changed);
    return STATUS_OK;
}

/* All triangles in another order: which of equals is found, and slots. */
enum status edit_permute(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    for (uint32_t i = trial->scene.tri_count; i > 1; i--) {
        uint32_t *a = trial->scene.index + 3 * (size_t)(i - 1);
        uint32_t *b = trial->scene.index + 3 * (size_t)rng_below(rng, i);
        for (int c = 0; c < 3; c++) {
            uint32_t kept = a[c];
            put_index(&a[c], b[c], changed);
            put_index(&b[c], kept, changed);
        }
    }
    return STATUS_OK;
}

/* Two corners of one triangle change places, or of all: the other side is in front. */
enum status edit_turn(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t count = trial->scene.tri_count, a = rng_below(rng, 3);
    uint32_t first = count ? rng_below(rng, count) : 0;
    bool all = rng_below(rng, 2);
    for (uint32_t i = all ? 0 : first; i < count && (all || i == first); i++) {
        uint32_t *index = trial->scene.index + 3 * (size_t)i, kept = index[a];
        put_index(&index[a], index[(a + 1) % 3], changed);
        put_index(&index[(a + 1) % 3], kept, changed);
    }
    return STATUS_OK;
}

/* One corner takes another triangle's vertex. */
enum status edit_weld(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    if (trial->scene.tri_count == 0)
        return STATUS_OK;
    uint32_t corners = 3 * trial->scene.tri_count;
    uint32_t to = rng_below(rng, corners), from = rng_below(rng, corners);
    put_index(&trial->scene.index[to], trial->scene.index[from], changed);
    return STATUS_OK;
}

/* One corner gets a vertex of its own, a step of a float away in half of the cases: a crack. */
enum status edit_unweld(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct scene *scene = &trial->scene;
    if (scene->tri_count == 0 || scene->vertex_count >= 3 * GROWN_MOST)
        return STATUS_OK;
    uint32_t corner = rng_below(rng, 3 * scene->tri_count), k = rng_below(rng, 3);
    int step = (int)rng_below(rng, 4) - 1;
    float *vertex = realloc(scene->vertex, 12 * ((size_t)scene->vertex_count + 1));
    if (!vertex)
        return STATUS_MEMORY;
    scene->vertex = vertex;
    float *own = vertex + 3 * (size_t)scene->vertex_count;
    memcpy(own, vertex + 3 * (size_t)scene->index[corner], 12);
    own[k] = float_step(own[k], step < 2 ? step : 0);
    scene->index[corner] = scene->vertex_count++;
    *changed = true;
    return STATUS_OK;
}

/* One triangle goes; the last takes its place. */
enum status edit_drop(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct scene *scene = &trial->scene;
    if (scene->tri_count < 2)
        return STATUS_OK;
    uint32_t gone = rng_below(rng, scene->tri_count);
    scene->tri_count--;
    memmove(scene->index + 3 * (size_t)gone, scene->index + 3 * (size_t)scene->tri_count, 12);
    *changed = true;
    return STATUS_OK;
}
