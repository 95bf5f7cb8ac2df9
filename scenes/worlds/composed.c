#include "scenes/worlds/composed.h"

#include "ref/base/nearest_name.h"
#include "ref/base/text.h"
#include "scenes/worlds/placer.h"

#include <stdlib.h>
#include <string.h>

#define STREAM     0x636F6D70u /* apart from the rays' */
#define GEOMETRIES 4u
#define DRAWN      UINT32_MAX /* a value that is drawn */

/* A member with its value: flags, a kind of filter, a number. */
struct composed_member {
    const char *name;
    uint32_t value;
};

enum composed_mask { MASK_ALL, MASK_BITS, MASK_DRAWN, MASK_IDLE };
enum composed_geometry { GEOMETRY_OPAQUE, GEOMETRY_NOT, GEOMETRY_MIXED };

static const struct composed_member masks[] = {
    {"all", MASK_ALL}, {"bits", MASK_BITS}, {"drawn", MASK_DRAWN}, {"idle", MASK_IDLE}, {NULL, 0}};
static const struct composed_member flags[] = {{"none", 0},
                                               {"cull-disable", ABI_INSTANCE_CULL_DISABLE},
                                               {"flip", ABI_INSTANCE_FLIP_FACING},
                                               {"force-opaque", ABI_INSTANCE_FORCE_OPAQUE},
                                               {"force-no-opaque", ABI_INSTANCE_FORCE_NO_OPAQUE},
                                               {"drawn", DRAWN},
                                               {NULL, 0}};
static const struct composed_member geometries[] = {{"opaque", GEOMETRY_OPAQUE},
                                                    {"not-opaque", GEOMETRY_NOT},
                                                    {"mixed", GEOMETRY_MIXED},
                                                    {NULL, 0}};
static const struct composed_member filters[] = {{"all", FILTER_ALL},
                                                 {"none", FILTER_NONE},
                                                 {"triangles", FILTER_TRIANGLES},
                                                 {"cells", FILTER_CELLS},
                                                 {NULL, 0}};
static const struct composed_member rays[] = {{"none", 0},
                                              {"opaque", ABI_RAY_OPAQUE},
                                              {"no-opaque", ABI_RAY_NO_OPAQUE},
                                              {"first", ABI_RAY_FIRST},
                                              {"skip-closest", ABI_RAY_SKIP_CLOSEST},
                                              {"cull-back", ABI_RAY_CULL_BACK},
                                              {"cull-front", ABI_RAY_CULL_FRONT},
                                              {"cull-opaque", ABI_RAY_CULL_OPAQUE},
                                              {"cull-no-opaque", ABI_RAY_CULL_NO_OPAQUE},
                                              {"skip-triangles", ABI_RAY_SKIP_TRIANGLES},
                                              {"drawn", DRAWN},
                                              {NULL, 0}};
static const struct composed_member counts[] = {
    {"1", 1}, {"3", 3}, {"12", 12}, {"40", 40}, {NULL, 0}};

static const struct composed_member *const axes[COMPOSED_AXES] = {
    [COMPOSED_MASKS] = masks,    [COMPOSED_FLAGS] = flags, [COMPOSED_GEOMETRY] = geometries,
    [COMPOSED_FILTER] = filters, [COMPOSED_RAYS] = rays,   [COMPOSED_COUNT] = counts};

const char *composed_name(enum composed_axis axis, uint32_t member)
{
    uint32_t i = 0;
    if (axis == COMPOSED_TRANSFORM) {
        while (i < member && placed_kinds[i].name)
            i++;
        return placed_kinds[i].name;
    }
    while (i < member && axes[axis][i].name)
        i++;
    return axes[axis][i].name;
}

uint32_t composed_members(enum composed_axis axis)
{
    uint32_t count = 0;
    while (composed_name(axis, count))
        count++;
    return count;
}

enum status composed_find(enum composed_axis axis, const char *name, uint32_t *member,
                          struct reason *reason)
{
    static const char *const titles[COMPOSED_AXES] = {
        "transform", "masks",     "instance flags",     "geometry",
        "filter",    "ray flags", "number of instances"};
    char known[300] = "", hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(name, strlen(name));
    for (*member = 0; composed_name(axis, *member); ++*member) {
        const char *one = composed_name(axis, *member);
        if (strcmp(one, name) == 0)
            return STATUS_OK;
        nearest_try(&nearest, one);
        text_append(known, sizeof known, "%s%s", *member ? ", " : "", one);
    }
    return fail(reason, STATUS_INPUT, "unknown %s '%s'; known are: %s%s", titles[axis], name, known,
                nearest_hint(&nearest, hint));
}

static uint32_t value_of(const struct composition *of, enum composed_axis axis)
{
    return axes[axis][of->member[axis]].value;
}

/* --- the world -------------------------------------------------------------------------------- */

/* Cuts a mesh into geometries, one of them empty. */
static enum status cut(struct world_mesh *mesh, enum composed_geometry kind, struct reason *reason)
{
    const uint32_t all = mesh->scene->tri_count;
    const uint32_t end[GEOMETRIES] = {all / 3, all / 3, all / 2, all};
    struct geometry *geometry = alloc_zeroed(GEOMETRIES, sizeof *geometry);
    if (!geometry)
        return fail(reason, STATUS_MEMORY, "no memory for %u geometries", GEOMETRIES);
    for (uint32_t g = 0; g < GEOMETRIES; g++) {
        const uint32_t first = g ? end[g - 1] : 0;
        geometry[g] = (struct geometry){first, end[g] - first, kind == GEOMETRY_OPAQUE};
        if (kind == GEOMETRY_MIXED)
            geometry[g].opaque = g % 2 == 0;
    }
    free(mesh->geometry);
    mesh->geometry = geometry;
    mesh->geometry_count = GEOMETRIES;
    return STATUS_OK;
}

static uint32_t draw_flags(struct placer *placer)
{
    static const uint32_t forced[] = {0, ABI_INSTANCE_FORCE_OPAQUE, ABI_INSTANCE_FORCE_NO_OPAQUE};
    const uint32_t facing = rng_below(&placer->rng, 4); /* of two bits */
    return facing | forced[rng_below(&placer->rng, ARRAY_COUNT(forced))];
}

/* The mask of instance i: of kind `bits` one bit; of `idle` one instance in three is inactive. */
static uint32_t draw_mask(struct placer *placer, enum composed_mask kind, uint32_t i)
{
    const uint32_t bit = 1u << rng_below(&placer->rng, 8);
    const uint32_t any = 1 + rng_below(&placer->rng, 255);
    if (kind == MASK_IDLE && i % 3 == 1)
        return 0;
    return kind == MASK_BITS ? bit : kind == MASK_DRAWN ? any : 0xFF;
}

static void add_instance(struct placer *placer, const struct composition *of, uint32_t i)
{
    const enum composed_mask mask = (enum composed_mask)value_of(of, COMPOSED_MASKS);
    const uint32_t set = value_of(of, COMPOSED_FLAGS);
    double t[3] = {1.5 * (i % 4), 1.5 * (i / 4 % 4), 1.5 * (i / 16)};
    const struct linear m = placed_kinds[of->member[COMPOSED_TRANSFORM]].draw(placer, i, t);
    struct instance *instance = placer_add(placer, i % 2, &m, t);
    const uint32_t drawn = draw_flags(placer);
    instance->flags = set == DRAWN ? drawn : set;
    instance->mask = draw_mask(placer, mask, i);
    instance->custom = rng_below(&placer->rng, ABI_CUSTOM_MOST + 1);
    if (mask == MASK_IDLE && i % 6 == 5)
        instance->mesh = WORLD_NO_MESH;
}

static enum status add_meshes(struct placer *placer, enum composed_geometry kind,
                              struct reason *reason)
{
    enum status status =
        placer_generated(placer, "sphere", (const double[GENERATOR_PARAMS]){2, 1}, 1, reason);
    if (!status)
        status = placer_box(placer, reason);
    for (uint32_t i = 0; i < 2 && !status; i++)
        status = cut(&placer->world->mesh[i], kind, reason);
    return status;
}

enum status composed_make(const struct composition *of, uint64_t seed, struct world *out,
                          struct reason *reason)
{
    struct placer placer = {.world = out, .rng = rng_make(seed, STREAM)};
    const uint32_t count = value_of(of, COMPOSED_COUNT);
    *out = (struct world){0};
    enum status status = placer_start(&placer, 2, count, reason);
    if (!status)
        status =
            add_meshes(&placer, (enum composed_geometry)value_of(of, COMPOSED_GEOMETRY), reason);
    for (uint32_t i = 0; i < count && !status; i++)
        add_instance(&placer, of, i);
    const uint32_t kind = value_of(of, COMPOSED_FILTER);
    out->filter = (struct filter_rule){(enum filter_kind)kind, (uint32_t)seed, 128};
    if (!status)
        status = world_finish(out, reason);
    if (status)
        world_free(out);
    return status;
}

/* --- rays ------------------------------------------------------------------------------------- */

static uint32_t draw_ray_flags(struct rng *rng)
{
    static const uint32_t opacity[] = {0, ABI_RAY_OPAQUE, ABI_RAY_NO_OPAQUE, ABI_RAY_CULL_OPAQUE,
                                       ABI_RAY_CULL_NO_OPAQUE};
    static const uint32_t facing[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT};
    const uint32_t a = opacity[rng_below(rng, ARRAY_COUNT(opacity))];
    const uint32_t b = facing[rng_below(rng, ARRAY_COUNT(facing))];
    const uint32_t first = rng_below(rng, 4) ? 0 : ABI_RAY_FIRST;
    return a | b | first;
}

void composed_modes(const struct composition *of, uint64_t seed, size_t count, struct ray_mode *out)
{
    const uint32_t set = value_of(of, COMPOSED_RAYS);
    const bool masked = value_of(of, COMPOSED_MASKS) != MASK_ALL;
    for (size_t i = 0; i < count; i++) {
        struct rng rng = rng_make(seed, STREAM + 1 + i);
        const uint32_t bit = 1u << rng_below(&rng, 8), any = rng_below(&rng, 256);
        const uint32_t drawn = draw_ray_flags(&rng);
        out[i] = (struct ray_mode){0xFF, ABI_RAY_OPAQUE};
        if (i % 2 == 0)
            continue;
        out[i].flags = set == DRAWN ? drawn : set;
        if (masked)
            out[i].mask = i % 4 == 1 ? bit : any;
    }
}
