/* Passes over what only worlds have: fewer instances, meshes and geometries; plainer masks, flags,
 * custom indices and filters. Where transforms are made plainer: fuzz/shrink/shrink_places.c. */
#include "fuzz/shrink/shrink_inner.h"

#include <string.h>

uint32_t shrink_instances_of(const struct fuzz_trial *trial)
{
    return trial->world.instance_count;
}

static uint32_t geometries_of(const struct fuzz_trial *trial)
{
    return trial->world.geometry_count;
}

static uint32_t world_one(const struct fuzz_trial *trial)
{
    return trial->world.is;
}

static uint32_t modes_of(const struct fuzz_trial *trial)
{
    return trial->world.is ? trial->ray_count : 0;
}

void shrink_cut_geometries(struct trial_world *world, uint32_t first, uint32_t count, bool keep)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++) {
        struct trial_geometry *one = &world->geometry[i];
        uint32_t end = at + one->count, low = at > first ? at : first;
        uint32_t high = end < first + count ? end : first + count;
        uint32_t inside = high > low ? high - low : 0;
        at = end;
        one->count = keep ? inside : one->count - inside;
    }
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Removes a geometry with its triangles. A mesh without any goes, too, and instances of it have
 * none. */
static void remove_geometry(struct fuzz_trial *trial, uint32_t gone)
{
    struct trial_world *world = &trial->world;
    uint32_t mesh = world->geometry[gone].mesh, first = 0, others = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++) {
        first += i < gone ? world->geometry[i].count : 0;
        others += i != gone && world->geometry[i].mesh == mesh;
    }
    if (world->geometry[gone].count > 0)
        shrink_cut_triangles(trial, first, world->geometry[gone].count);
    memmove(&world->geometry[gone], &world->geometry[gone + 1],
            sizeof *world->geometry * (--world->geometry_count - gone));
    if (others > 0)
        return;
    for (uint32_t i = 0; i < world->geometry_count; i++)
        world->geometry[i].mesh -= world->geometry[i].mesh > mesh;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        uint32_t *of = &world->instance[i].mesh;
        if (*of == mesh)
            *of = WORLD_NO_MESH;
        else if (*of != WORLD_NO_MESH)
            *of -= *of > mesh;
    }
}

static bool is_used(const struct trial_world *world, uint32_t mesh)
{
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world->instance[i].mesh == mesh)
            return true;
    return false;
}

static void drop_unused_meshes(struct fuzz_trial *trial)
{
    for (uint32_t i = trial->world.geometry_count; i-- > 0;)
        if (!is_used(&trial->world, trial->world.geometry[i].mesh))
            remove_geometry(trial, i);
}

/* KEEP_NAMED: those that stay have the custom index 1, since their numbers may have mattered. */
enum { KEEP, REMOVE, KEEP_TIDY, REMOVE_TIDY, KEEP_NAMED, CUTS };

static bool cut_instances(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                          uint32_t variant)
{
    struct trial_world *world = &trial->world;
    uint32_t behind = world->instance_count - first - count;
    if (variant == KEEP || variant == KEEP_TIDY || variant == KEEP_NAMED) {
        memmove(world->instance, world->instance + first, sizeof *world->instance * count);
        world->instance_count = count;
    } else {
        memmove(world->instance + first, world->instance + first + count,
                sizeof *world->instance * behind);
        world->instance_count -= count;
    }
    for (uint32_t i = 0; i < world->instance_count && variant == KEEP_NAMED; i++)
        world->instance[i].custom = 1;
    if (variant >= KEEP_TIDY)
        drop_unused_meshes(trial);
    return true;
}

enum { GEOMETRY_GONE, GEOMETRY_JOINED, MESHES_JOINED, OPAQUE, GEOMETRIES };

static bool change_geometry(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                            uint32_t variant)
{
    struct trial_world *world = &trial->world;
    struct trial_geometry *one = &world->geometry[first], *before = first ? one - 1 : NULL;
    (void)count;
    if (variant == OPAQUE) {
        one->opaque = true;
        return true;
    }
    if (variant == GEOMETRY_GONE) {
        remove_geometry(trial, first);
        return true;
    }
    if (!before || (variant == GEOMETRY_JOINED) != (before->mesh == one->mesh))
        return false;
    if (variant == MESHES_JOINED) { /* its instances are of both */
        uint32_t mesh = one->mesh;
        for (uint32_t i = first; i < world->geometry_count; i++)
            world->geometry[i].mesh--;
        for (uint32_t i = 0; i < world->instance_count; i++) {
            uint32_t *of = &world->instance[i].mesh;
            if (*of != WORLD_NO_MESH)
                *of -= *of >= mesh;
        }
        return true;
    }
    before->count += one->count;
    memmove(one, one + 1, sizeof *one * (--world->geometry_count - first));
    return true;
}

/* --- masks, flags, indices -------------------------------------------------------------------- */

static uint32_t lowest_bit(uint32_t bits)
{
    return bits & (0u - bits);
}

enum {
    MASK_ALL,
    MASK_BIT,
    MASK_ONE,
    FLAGS_NONE,
    CUSTOM_NONE,
    CUSTOM_ONE,
    CUSTOM_HALF,
    CUSTOM_TOP_BIT,
    MESH_FIRST,
    MESH_NONE,
    MESH_FIRST_TIDY,
    MESH_NONE_TIDY,
    FLAG_CLEARED,
    MEMBERS = FLAG_CLEARED + 4
};

static uint32_t top_bit(uint32_t bits)
{
    while (bits & (bits - 1))
        bits &= bits - 1;
    return bits;
}

static void change_member(struct instance *one, uint32_t variant)
{
    switch (variant) {
    case MASK_ALL:
        one->mask = 0xFF;
        break;
    case MASK_BIT:
        one->mask = lowest_bit(one->mask);
        break;
    case MASK_ONE:
        one->mask = 1;
        break;
    case FLAGS_NONE:
        one->flags = 0;
        break;
    case CUSTOM_NONE:
    case CUSTOM_ONE:
        one->custom = variant == CUSTOM_ONE;
        break;
    case CUSTOM_HALF:
        one->custom /= 2;
        break;
    case CUSTOM_TOP_BIT:
        one->custom = top_bit(one->custom);
        break;
    case MESH_FIRST:
    case MESH_FIRST_TIDY:
        one->mesh = 0;
        break;
    case MESH_NONE:
    case MESH_NONE_TIDY:
        one->mesh = WORLD_NO_MESH;
        break;
    default:
        one->flags &= ~(1u << (variant - FLAG_CLEARED));
        break;
    }
}

static bool change_members(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                           uint32_t variant)
{
    for (uint32_t i = first; i < first + count; i++)
        change_member(&trial->world.instance[i], variant);
    if (variant == MESH_FIRST_TIDY || variant == MESH_NONE_TIDY)
        drop_unused_meshes(trial);
    return true;
}

enum {
    MODE_MASK_ALL,
    MODE_MASK_BIT,
    MODE_FLAGS_NONE,
    MODE_FLAG_CLEARED,
    MODES = MODE_FLAG_CLEARED + 9
};

static bool change_modes(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    for (uint32_t i = first; i < first + count; i++) {
        struct ray_mode *mode = &trial->world.mode[i];
        if (variant == MODE_MASK_ALL)
            mode->mask = 0xFF;
        else if (variant == MODE_MASK_BIT)
            mode->mask = lowest_bit(mode->mask);
        else if (variant == MODE_FLAGS_NONE)
            mode->flags = 0;
        else
            mode->flags &= ~(1u << (variant - MODE_FLAG_CLEARED));
    }
    return true;
}

enum {
    FILTER_OFF,
    FILTER_PASSES_NONE,
    FILTER_SEED_0,
    FILTER_SEED_1,
    FILTER_SEED_HALF,
    FILTER_SHARE,
    FILTER_SHARE_ALL,
    FILTER_SHARE_NONE,
    ALL_OPAQUE,
    FILTERS
};

static bool change_filter(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                          uint32_t variant)
{
    struct trial_world *world = &trial->world;
    struct filter_rule *filter = &world->filter;
    (void)first, (void)count;
    switch (variant) {
    case FILTER_OFF:
        *filter = (struct filter_rule){FILTER_ALL, 0, 128};
        break;
    case FILTER_PASSES_NONE:
        *filter = (struct filter_rule){FILTER_NONE, 0, 128};
        break;
    case FILTER_SEED_0:
    case FILTER_SEED_1:
        filter->seed = variant == FILTER_SEED_1;
        break;
    case FILTER_SEED_HALF:
        filter->seed /= 2;
        break;
    case FILTER_SHARE:
        filter->share = 128;
        break;
    case FILTER_SHARE_ALL:
    case FILTER_SHARE_NONE:
        filter->share = variant == FILTER_SHARE_ALL ? 256 : 0;
        break;
    default:
        for (uint32_t i = 0; i < world->geometry_count; i++)
            world->geometry[i].opaque = true;
        break;
    }
    return true;
}

const struct shrink_pass shrink_instances = {"instances", SHRINK_CHUNKS, shrink_instances_of, CUTS,
                                             cut_instances};
const struct shrink_pass shrink_geometries = {"geometries", SHRINK_SINGLY, geometries_of,
                                              GEOMETRIES, change_geometry};
const struct shrink_pass shrink_instance_members = {"instance members", SHRINK_CHUNKS,
                                                    shrink_instances_of, MEMBERS, change_members};
const struct shrink_pass shrink_modes = {"modes", SHRINK_CHUNKS, modes_of, MODES, change_modes};
const struct shrink_pass shrink_filter = {"filter", SHRINK_SINGLY, world_one, FILTERS,
                                          change_filter};
