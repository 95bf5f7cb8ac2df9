#include "scenes/rays/rays_stage.h"

#include <stdlib.h>
#include <string.h>

extern const struct ray_set ray_set_primary, ray_set_random, ray_set_vertices, ray_set_edges,
    ray_set_corners, ray_set_axis, ray_set_bounce, ray_set_ranges;

static enum status make_mixed(const struct scene *scene, uint64_t seed, size_t count,
                              struct ray *out, struct reason *reason);

static const struct ray_set ray_set_mixed = {
    .name = "mixed",
    .summary = "all other sets by turns; where nothing can be bounced from, random instead",
    .all = make_mixed,
};

const struct ray_set *const ray_sets[] = {
    &ray_set_mixed,   &ray_set_primary, &ray_set_random, &ray_set_vertices, &ray_set_edges,
    &ray_set_corners, &ray_set_axis,    &ray_set_bounce, &ray_set_ranges,   NULL};

#define PART_COUNT (ARRAY_COUNT(ray_sets) - 2)

/* Makes the rays of one set. If no camera ray hits the scene (all slivers), random rays replace
 * bounces. */
static enum status make_part(const struct ray_set *set, const struct scene *scene, uint64_t seed,
                             size_t count, struct ray *out, struct reason *reason)
{
    enum status status = ray_set_make(set, scene, seed, count, out, reason);
    if (set == &ray_set_bounce && status == STATUS_INPUT)
        status = ray_set_make(&ray_set_random, scene, ~seed, count, out, reason);
    return status;
}

static enum status make_mixed(const struct scene *scene, uint64_t seed, size_t count,
                              struct ray *out, struct reason *reason)
{
    struct ray *part = alloc_zeroed(count / PART_COUNT + 1, sizeof *part);
    enum status status = STATUS_OK;
    if (!part)
        return fail(reason, STATUS_MEMORY, "mixed: no memory for %zu rays", count);
    for (size_t k = 0; k < PART_COUNT && !status; k++) {
        size_t part_count = (count + PART_COUNT - 1 - k) / PART_COUNT;
        status = make_part(ray_sets[k + 1], scene, seed, part_count, part, reason);
        for (size_t i = 0; i < part_count && !status; i++)
            out[i * PART_COUNT + k] = part[i];
    }
    free(part);
    return status;
}

const struct ray_set *ray_set_find(const char *name)
{
    for (size_t i = 0; ray_sets[i]; i++)
        if (strcmp(ray_sets[i]->name, name) == 0)
            return ray_sets[i];
    return NULL;
}

enum status ray_set_make(const struct ray_set *set, const struct scene *scene, uint64_t seed,
                         size_t count, struct ray *out, struct reason *reason)
{
    if (!set->one)
        return set->all(scene, seed, count, out, reason);
    struct stage stage = stage_make(scene, seed, set->tag);
    for (size_t i = 0; i < count; i++) {
        struct rng rng = stage_rng(&stage, i);
        set->one(&stage, &rng, i, &out[i]);
    }
    return STATUS_OK;
}

enum status ray_set_new(const struct ray_set *set, const struct scene *scene, uint64_t seed,
                        size_t count, struct ray **out, struct reason *reason)
{
    *out = alloc_zeroed(count, sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    return ray_set_make(set, scene, seed, count, *out, reason);
}
