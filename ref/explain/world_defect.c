#include "ref/explain/world_defect.h"

#include "ref/primitives/test_run.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/candidate.h"
#include "ref/world/object_ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- names ------------------------------------------------------------------------------------ */

static const char *const cause_names[WORLD_CAUSE_COUNT] = {
    "none", "transform", "world_box", "mask", "cull", "opacity", "instance_index", "unknown"};

const char *world_cause_name(enum world_cause cause)
{
    return cause_names[cause];
}

static const struct world_defect_about about[WORLD_DEFECT_COUNT] = {
    [WORLD_DEFECT_NONE] = {"keeps the rules", WORLD_CAUSE_NONE},
    [WORLD_DEFECT_MASK_IGNORED] = {"does not compare masks", WORLD_CAUSE_MASK},
    [WORLD_DEFECT_MASK_EQUAL] = {"compares masks by ==, not by a bit in common", WORLD_CAUSE_MASK},
    [WORLD_DEFECT_MASK_ANY_BIT] = {"takes any mask but 0 for all bits", WORLD_CAUSE_MASK},
    [WORLD_DEFECT_SKIP_IGNORED] = {"ignores the flag that skips triangles", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_CULL_IGNORED] = {"culls neither side", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_CULLS_IGNORED] = {"culls nothing", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_CULL_OTHER] = {"culls the front for the back", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_DISABLE_IGNORED] = {"culls where the instance disables it", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_FLIP_IGNORED] = {"ignores the flag that flips facing", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_MIRROR] = {"exchanges the sides in a mirror", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_FRONT_IS_BACK] = {"takes the front for the back", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_SIDE] = {"reports the other side", WORLD_CAUSE_CULL},
    [WORLD_DEFECT_OPACITY_CULL_IGNORED] = {"culls nothing by opacity", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_FORCE_IGNORED] = {"ignores the force flags of instances", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_RAY_OPACITY_IGNORED] = {"ignores the opacity flags of rays", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_RAY_BEFORE_INSTANCE] = {"lets instances override opacity flags of rays",
                                          WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_GEOMETRY_OPAQUE] = {"takes every geometry for opaque", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_GEOMETRY_OF_FIRST] = {"takes geometries for as opaque as the first one",
                                        WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_FILTER_IGNORED] = {"confirms every candidate", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_FILTER_NONE] = {"confirms no candidate", WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_ENDS_AT_CANDIDATE] = {"ends a ray at a candidate that is passed over",
                                        WORLD_CAUSE_OPACITY},
    [WORLD_DEFECT_INSTANCE_ZERO] = {"takes hits of instance 0 for none", WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_CUSTOM_IS_NUMBER] = {"reports an instance's number as custom index",
                                       WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_CUSTOM_16] = {"keeps 16 bits of the custom index", WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_CUSTOM_8] = {"keeps 8 bits of the custom index", WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_NUMBER_10] = {"keeps 10 bits of an instance's number", WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_CUSTOM_OF_BEFORE] = {"reports the custom index of the instance before",
                                       WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_INACTIVE_COUNT_NOT] = {"numbers instances without the inactive ones",
                                         WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_MESH_NUMBERS] = {"names triangles of meshes, not of instances",
                                   WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_GEOMETRY_FIRST] = {"numbers triangles anew in each geometry", WORLD_CAUSE_INDEX},
    [WORLD_DEFECT_LAST_TRANSFORM] = {"enters an instance by the transform of the one before",
                                     WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_FIRST_TRANSFORM] = {"enters all instances by the first one's transform",
                                      WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_NO_TRANSFORM] = {"transforms no ray", WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_NO_TRANSLATION] = {"leaves the translation out", WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_TRANSPOSED] = {"transposes the matrix", WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_NOT_INVERTED] = {"takes the matrix for its inverse", WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_LENGTH] = {"counts t in units of length", WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_OBJECT_LENGTH] = {"counts t in units of length in the space of the mesh",
                                    WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_LENGTH_KEPT] = {"gives directions in meshes the length of those in the world",
                                  WORLD_CAUSE_TRANSFORM},
    [WORLD_DEFECT_NOT_CARRIED] = {"forgets the nearest hit in the next instance",
                                  WORLD_CAUSE_TRANSFORM},
};

const struct world_defect_about *world_defect_about(enum world_defect defect)
{
    return &about[defect];
}

/* --- the world -------------------------------------------------------------------------------- */

enum status world_look_make(const struct world *world, const struct tri_test *tri,
                            struct world_look *out, struct reason *reason)
{
    *out = (struct world_look){.world = world, .tri = tri};
    enum status status = world_records_make(world, &out->record, reason);
    if (status)
        return status;
    out->bent = alloc_zeroed(world->instance_count, sizeof *out->bent);
    out->mesh_box = alloc_zeroed(world->mesh_count, sizeof *out->mesh_box);
    if (!out->bent || !out->mesh_box) {
        world_look_free(out);
        return fail(reason, STATUS_MEMORY, "no memory to explain %u instances",
                    world->instance_count);
    }
    for (uint32_t i = 0; i < world->mesh_count; i++)
        out->mesh_box[i] = scene_bounds(world->mesh[i].scene);
    world_look_bend(out, WORLD_DEFECT_NONE);
    return STATUS_OK;
}

void world_look_free(struct world_look *look)
{
    free(look->record);
    free(look->bent);
    free(look->mesh_box);
    *look = (struct world_look){.world = NULL};
}

/* The record of instance `i` as the tracer with the defect has it. */
static struct instance_record bent(const struct world_look *look, uint32_t i)
{
    struct instance_record out = look->record[i];
    const struct instance *instance = &look->world->instance[i];
    const struct instance_record *of = &look->record[i];
    if (look->defect == WORLD_DEFECT_LAST_TRANSFORM)
        of = &look->record[i > 0 ? i - 1 : 0];
    if (look->defect == WORLD_DEFECT_FIRST_TRANSFORM)
        of = &look->record[0];
    if (of->mesh != WORLD_NO_MESH) {
        memcpy(out.w, of->w, sizeof out.w);
        memcpy(out.t, of->t, sizeof out.t);
        out.flags = (out.flags & ~ABI_INSTANCE_IDENTITY) | (of->flags & ABI_INSTANCE_IDENTITY);
    }
    if (look->defect == WORLD_DEFECT_NO_TRANSFORM)
        out.flags |= ABI_INSTANCE_IDENTITY;
    for (int k = 0; k < 3; k++) {
        if (look->defect == WORLD_DEFECT_NO_TRANSLATION)
            out.t[k] = 0;
        for (int j = 0; j < 3; j++) {
            if (look->defect == WORLD_DEFECT_TRANSPOSED)
                out.w[3 * k + j] = look->record[i].w[3 * j + k];
            if (look->defect == WORLD_DEFECT_NOT_INVERTED)
                out.w[3 * k + j] = instance->m[k][j];
        }
    }
    return out;
}

void world_look_bend(struct world_look *look, enum world_defect defect)
{
    look->defect = defect;
    for (uint32_t i = 0; i < look->world->instance_count; i++)
        look->bent[i] = bent(look, i);
}

/* --- rays ------------------------------------------------------------------------------------- */

static bool has(const struct world_look *look, enum world_defect defect)
{
    return look->defect == defect;
}

static bool meets(const struct world_look *look, uint32_t i, struct ray_mode mode)
{
    const struct instance *instance = &look->world->instance[i];
    if (instance->mesh == WORLD_NO_MESH || look->record[i].mesh == WORLD_NO_MESH)
        return false;
    if ((mode.flags & ABI_RAY_SKIP_TRIANGLES) && !has(look, WORLD_DEFECT_SKIP_IGNORED))
        return false;
    if (has(look, WORLD_DEFECT_MASK_EQUAL))
        return instance->mask == mode.mask;
    if (has(look, WORLD_DEFECT_MASK_ANY_BIT))
        return instance->mask != 0 && mode.mask != 0;
    return (instance->mask & mode.mask) != 0 || has(look, WORLD_DEFECT_MASK_IGNORED);
}

static bool opaque_of(const struct world_look *look, const struct instance *instance, bool opaque,
                      struct ray_mode mode)
{
    struct instance as = *instance;
    if (has(look, WORLD_DEFECT_FORCE_IGNORED))
        as.flags &= ~(ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE);
    if (has(look, WORLD_DEFECT_RAY_OPACITY_IGNORED) ||
        (has(look, WORLD_DEFECT_RAY_BEFORE_INSTANCE) &&
         (as.flags & (ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE))))
        mode.flags &= ~(ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE);
    return world_is_opaque(&as, opaque || has(look, WORLD_DEFECT_GEOMETRY_OPAQUE), mode);
}

static bool front_of(const struct world_look *look, const struct instance *instance, float side)
{
    struct instance as = *instance;
    if (has(look, WORLD_DEFECT_FLIP_IGNORED))
        as.flags &= ~ABI_INSTANCE_FLIP_FACING;
    bool front = world_is_front(&as, side < 0.0f ? -1 : 1);
    if (has(look, WORLD_DEFECT_MIRROR) && instance_det_sign(instance->m) < 0)
        front = !front;
    return front != has(look, WORLD_DEFECT_FRONT_IS_BACK);
}

static bool culls(const struct world_look *look, const struct instance *instance, bool opaque,
                  bool front, struct ray_mode mode)
{
    struct instance as = *instance;
    if (has(look, WORLD_DEFECT_CULLS_IGNORED))
        return false;
    if (has(look, WORLD_DEFECT_CULL_IGNORED))
        mode.flags &= ~(ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT);
    if (has(look, WORLD_DEFECT_OPACITY_CULL_IGNORED))
        mode.flags &= ~(ABI_RAY_CULL_OPAQUE | ABI_RAY_CULL_NO_OPAQUE);
    if (has(look, WORLD_DEFECT_DISABLE_IGNORED))
        as.flags &= ~ABI_INSTANCE_CULL_DISABLE;
    return world_culls(&as, opaque, front != has(look, WORLD_DEFECT_CULL_OTHER), mode);
}

static uint32_t custom_of(const struct world_look *look, uint32_t i)
{
    const struct instance *instance = look->world->instance;
    switch (look->defect) {
    case WORLD_DEFECT_CUSTOM_IS_NUMBER:
        return i & ABI_TAG_CUSTOM;
    case WORLD_DEFECT_CUSTOM_16:
        return instance[i].custom & 0xFFFF;
    case WORLD_DEFECT_CUSTOM_8:
        return instance[i].custom & 0xFF;
    case WORLD_DEFECT_CUSTOM_OF_BEFORE:
        return instance[i > 0 ? i - 1 : 0].custom;
    default:
        return instance[i].custom;
    }
}

/* The number of a placed triangle. */
static uint32_t number_of(const struct world_look *look, uint32_t i, const struct place *place)
{
    uint32_t shown = i;
    if (has(look, WORLD_DEFECT_MESH_NUMBERS))
        return place->prim;
    if (has(look, WORLD_DEFECT_GEOMETRY_FIRST))
        return look->world->first[i] + place->tri;
    for (uint32_t k = 0; k < i && has(look, WORLD_DEFECT_INACTIVE_COUNT_NOT); k++)
        shown -= look->record[k].mesh == WORLD_NO_MESH;
    if (has(look, WORLD_DEFECT_NUMBER_10))
        shown &= 1023;
    return look->world->first[shown] + place->prim;
}

/* Decides about a candidate; returns whether it counts. */
static bool counts(const struct world_look *look, uint32_t i, const struct ray *inside,
                   struct ray_mode mode, struct hit *hit, uint32_t *tag)
{
    const struct world *world = look->world;
    const struct instance *instance = &world->instance[i];
    const struct place place = world_place_in(world, i, hit->prim);
    float v[3][3];
    scene_tri(world_scene(world, i), hit->prim, v);
    const struct geometry *geometry = world->mesh[place.mesh].geometry;
    bool stated = geometry[has(look, WORLD_DEFECT_GEOMETRY_OF_FIRST) ? 0 : place.geometry].opaque;
    bool opaque = opaque_of(look, instance, stated, mode);
    bool front = front_of(look, instance, candidate_side(inside->dir, v));
    *tag = custom_of(look, i) | (front != has(look, WORLD_DEFECT_SIDE) ? ABI_TAG_FRONT : 0);
    hit->prim = number_of(look, i, &place);
    if (culls(look, instance, opaque, front, mode))
        return false;
    if (opaque || has(look, WORLD_DEFECT_FILTER_IGNORED))
        return true;
    return filter_passes(&world->filter, &place, hit->u, hit->v) &&
           !has(look, WORLD_DEFECT_FILTER_NONE);
}

static float length_of(const float d[3])
{
    return sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static struct ray inside_of(const struct world_look *look, uint32_t i, const struct ray *ray)
{
    struct ray out = transform_ray(&look->bent[i], ray);
    const float by = length_of(ray->dir) / length_of(out.dir);
    for (int k = 0; k < 3 && has(look, WORLD_DEFECT_LENGTH_KEPT); k++)
        out.dir[k] *= by;
    return out;
}

/* What a ray has found so far. */
struct found {
    struct hit best;
    float nearest; /* t of it, in units of the direction */
    uint32_t tag;
    bool any, ended;
    bool open; /* a tracer may have ended before */
};

static void enter(const struct world_look *look, uint32_t i, const struct ray *ray,
                  struct ray_mode mode, struct found *f)
{
    const struct scene *scene = world_scene(look->world, i);
    const struct ray inside = inside_of(look, i, ray);
    struct slab_ray slab = slab_ray_make(&inside);
    const struct box *box = &look->mesh_box[look->record[i].mesh];
    const struct tri_ray tri = tri_ray_make(&inside);
    float at;
    slab_ray_place(&slab, box);
    if (!slab_watertight(&slab, box, ray->tmax, &at))
        return;
    for (uint32_t k = 0; k < scene->tri_count && !f->ended; k++) {
        struct hit hit;
        uint32_t tag;
        float v[3][3];
        scene_tri(scene, k, v);
        if (!tri_test_run(look->tri->id, &tri, v, &hit) || hit.t >= f->nearest)
            continue;
        hit.prim = k;
        bool hits = counts(look, i, &inside, mode, &hit, &tag);
        f->open = f->open || !hits;
        if (!hits || (i == 0 && has(look, WORLD_DEFECT_INSTANCE_ZERO)))
            continue;
        f->nearest = hit.t;
        if (has(look, WORLD_DEFECT_LENGTH))
            hit.t *= length_of(ray->dir);
        if (has(look, WORLD_DEFECT_OBJECT_LENGTH))
            hit.t *= length_of(inside.dir);
        f->best = hit;
        f->tag = tag;
        f->ended =
            f->any && !has(look, WORLD_DEFECT_ENDS_AT_CANDIDATE); /* to see what it may meet */
    }
}

/* Whether a tracer that forgets the nearest hit may have come upon instance `i` last. */
static bool is_last(const struct world_look *look, uint32_t i, const struct hit *given)
{
    return !has(look, WORLD_DEFECT_NOT_CARRIED) || given->prim >= world_tri_count(look->world) ||
           world_instance_of(look->world, given->prim) == i;
}

void world_look_trace(const struct world_look *look, enum query query, const struct ray *ray,
                      struct ray_mode mode, const struct hit *given, struct hit *hit, uint32_t *tag)
{
    struct found f = {.best = hit_none(),
                      .nearest = INFINITY,
                      .any = query == QUERY_ANY || (mode.flags & ABI_RAY_FIRST)};
    for (uint32_t i = 0; i < look->world->instance_count && !f.ended; i++)
        if (meets(look, i, mode) && is_last(look, i, given))
            enter(look, i, ray, mode, &f);
    bool ends = has(look, WORLD_DEFECT_ENDS_AT_CANDIDATE) && f.any && f.open;
    bool none = ends && given->prim == ABI_NO_PRIM;
    *hit = none ? hit_none() : f.best;
    *tag = none ? 0 : f.tag;
}
