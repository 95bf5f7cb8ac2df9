/* Edits of what only worlds have. */
#include "fuzz/gen/gen_world.h"

#include "fuzz/gen/mutate_inner.h"
#include "scenes/rays/ray_modes.h"

#include <stdlib.h>
#include <string.h>

/* Edits make no world of more instances. */
#define GROWN_INSTANCES 64u

static struct instance *some_instance(struct rng *rng, struct trial_world *world)
{
    uint32_t count = world->instance_count;
    return count ? &world->instance[rng_below(rng, count)] : NULL;
}

static bool differ(const struct instance *a, const struct instance *b)
{
    return memcmp(a, b, sizeof *a) != 0;
}

/* Takes an instance as it was changed, unless its transform became none. */
static void take(struct instance *to, const struct instance *from, bool *changed)
{
    if (!differ(to, from) || !gen_transform_is_good(from))
        return;
    *to = *from;
    *changed = true;
}

static enum status edit_of_place(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct instance *to = some_instance(rng, &trial->world);
    if (!to)
        return STATUS_OK;
    struct instance one = *to;
    const struct box box = gen_mesh_box(trial, to->mesh);
    const struct instance *other = some_instance(rng, &trial->world);
    gen_place(rng, &box, other, &one);
    take(to, &one, changed);
    return STATUS_OK;
}

/* One number of a transform, by some steps of a float, to 0, or to the other sign. */
static enum status edit_of_number(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct instance *to = some_instance(rng, &trial->world);
    uint32_t k = rng_below(rng, 12), how = rng_below(rng, 4);
    int steps = 1 + (int)rng_below(rng, 4);
    if (!to)
        return STATUS_OK;
    struct instance one = *to;
    float *x = &one.m[k / 4][k % 4];
    *x = how == 0 ? 0.0f : how == 1 ? -*x : float_step(*x, how == 2 ? steps : -steps);
    take(to, &one, changed);
    return STATUS_OK;
}

static enum status edit_of_members(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct instance *to = some_instance(rng, &trial->world);
    if (!to)
        return STATUS_OK;
    struct instance one = *to;
    gen_instance_members(rng, rng_below(rng, trial->world.instance_count), &one);
    take(to, &one, changed);
    return STATUS_OK;
}

static enum status edit_of_mesh(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct instance *to = some_instance(rng, &trial->world);
    uint32_t meshes = trial_world_meshes(&trial->world);
    if (!to || meshes == 0)
        return STATUS_OK;
    struct instance one = *to;
    one.mesh = rng_below(rng, meshes);
    take(to, &one, changed);
    return STATUS_OK;
}

/* Once more, at the end: at the same place, touching it, or elsewhere. */
static enum status edit_of_repeat(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct trial_world *world = &trial->world;
    struct instance *from = some_instance(rng, world);
    if (!from || world->instance_count >= GROWN_INSTANCES)
        return STATUS_OK;
    struct instance one = *from;
    const struct box box = gen_mesh_box(trial, one.mesh);
    if (rng_below(rng, 2))
        gen_place(rng, &box, from, &one);
    struct instance *array =
        realloc(world->instance, sizeof *array * ((size_t)world->instance_count + 1));
    if (!array)
        return STATUS_MEMORY;
    world->instance = array;
    array[world->instance_count++] = one;
    *changed = true;
    return STATUS_OK;
}

static enum status edit_of_remove(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct trial_world *world = &trial->world;
    if (world->instance_count < 2)
        return STATUS_OK;
    uint32_t gone = rng_below(rng, world->instance_count), behind = --world->instance_count - gone;
    memmove(&world->instance[gone], &world->instance[gone + 1], sizeof *world->instance * behind);
    *changed = true;
    return STATUS_OK;
}

static enum status edit_of_swap(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct instance *a = some_instance(rng, &trial->world);
    struct instance *b = some_instance(rng, &trial->world);
    if (!a || !differ(a, b))
        return STATUS_OK;
    struct instance one = *a;
    *a = *b;
    *b = one;
    *changed = true;
    return STATUS_OK;
}

static enum status edit_of_opacity(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct trial_world *world = &trial->world;
    if (world->geometry_count == 0)
        return STATUS_OK;
    struct trial_geometry *one = &world->geometry[rng_below(rng, world->geometry_count)];
    one->opaque = !one->opaque;
    *changed = true;
    return STATUS_OK;
}

static enum status edit_of_filter(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct filter_rule filter = gen_filter(rng), *to = &trial->world.filter;
    *changed = filter.kind != to->kind || filter.seed != to->seed || filter.share != to->share;
    *to = filter;
    return STATUS_OK;
}

/* What a run of rays may meet: all, or drawn anew. */
static enum status edit_of_modes(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint64_t seed = rng_u64(rng);
    enum ray_modes which = rng_below(rng, 4) ? RAY_MODES_DRAWN : RAY_MODES_ALL;
    if (trial->ray_count == 0)
        return STATUS_OK;
    uint32_t first = rng_below(rng, trial->ray_count), left = trial->ray_count - first;
    uint32_t count = 1 + rng_below(rng, left);
    struct ray_mode *to = trial->world.mode + first;
    struct ray_mode *drawn = alloc_zeroed(count, sizeof *drawn);
    if (!drawn)
        return STATUS_MEMORY;
    ray_modes_make(which, seed, count, drawn);
    *changed = memcmp(to, drawn, sizeof *to * count) != 0;
    memcpy(to, drawn, sizeof *to * count);
    free(drawn);
    return STATUS_OK;
}

enum status gen_world_edit(struct rng *rng, struct fuzz_trial *trial, bool *changed,
                           const char **name)
{
    static const struct {
        const char *name;
        edit_fn *apply;
    } table[] = {{"place", edit_of_place},     {"transform_step", edit_of_number},
                 {"members", edit_of_members}, {"other_mesh", edit_of_mesh},
                 {"repeat", edit_of_repeat},   {"remove", edit_of_remove},
                 {"swap", edit_of_swap},       {"opacity", edit_of_opacity},
                 {"filter", edit_of_filter},   {"modes", edit_of_modes}};
    uint32_t which = rng_below(rng, ARRAY_COUNT(table));
    *name = table[which].name;
    return table[which].apply(rng, trial, changed);
}

void gen_world_settle(struct fuzz_trial *trial)
{
    struct trial_world *world = &trial->world;
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++)
        count += world->geometry[i].count;
    for (uint32_t i = world->geometry_count; i > 0 && count != trial->scene.tri_count; i--) {
        struct trial_geometry *one = &world->geometry[i - 1];
        uint32_t over = count > trial->scene.tri_count ? count - trial->scene.tri_count : 0;
        uint32_t gone = over < one->count ? over : one->count;
        one->count -= gone;
        count -= gone;
        if (count < trial->scene.tri_count) {
            one->count += trial->scene.tri_count - count;
            count = trial->scene.tri_count;
        }
    }
}
