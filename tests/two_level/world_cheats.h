/* An engine that traces worlds without trees and cheats in one way. Written apart from ref/trace
 * but for the sign of a side, the triangle tests and the filter, which are contracts. Include after
 * cmocka.h. */
#ifndef TWO_LEVEL_WORLD_CHEATS_H
#define TWO_LEVEL_WORLD_CHEATS_H

#include "ref/engines/cpu_rays.h"
#include "ref/primitives/test_run.h"
#include "ref/world/candidate.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/object_ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum world_cheat {
    CHEAT_NONE,
    CHEAT_NO_MASK,         /* every instance is met */
    CHEAT_MASK_EQUAL,      /* masks must be equal */
    CHEAT_NO_SKIP,         /* triangles are not skipped */
    CHEAT_NO_CULL,         /* facing culls nothing */
    CHEAT_NO_DISABLE,      /* facing culls in instances that disable it, too */
    CHEAT_NO_FLIP,         /* facing is not flipped */
    CHEAT_MIRROR,          /* a mirror exchanges front and back */
    CHEAT_OTHER_FACE,      /* front is reported for back */
    CHEAT_NO_OPACITY_CULL, /* opacity culls nothing */
    CHEAT_NO_FORCE,        /* instances do not change opacity */
    CHEAT_NO_RAY_OPACITY,  /* rays do not */
    CHEAT_NO_FILTER,       /* every candidate counts */
    CHEAT_PASS_OVER,       /* none that is not opaque does */
    CHEAT_FIRST_PASSED,    /* a ray that ends at its first hit ends at the first candidate */
    CHEAT_NO_FIRST,       /* ... goes on: no cheat, since the nearest hit is one of those allowed */
    CHEAT_INSTANCE_0,     /* hits of instance 0 are none */
    CHEAT_INDEX,          /* the custom index reported is the instance's number */
    CHEAT_EXCHANGE,       /* and the instance is that of the custom index */
    CHEAT_CUT,            /* custom indices have 16 bits */
    CHEAT_MISS_TAG,       /* misses have the tag of the last candidate */
    CHEAT_NOT_CARRIED,    /* each instance begins with the whole range */
    CHEAT_LAST_TRANSFORM, /* each has the transform of the one before */
    CHEAT_LENGTH,         /* t counts in units of length */
    CHEAT_COUNT,
    /* Found by hard cases alone, whose worlds are made for them. */
    CHEAT_CORNERS = CHEAT_COUNT, /* boxes of eight corners placed in float32 */
    CHEAT_STALE,                 /* boxes of the world before, if it has as many instances */
    CHEAT_FLOAT_INVERSE,         /* inverses computed in float32 */
    CHEAT_FORTH_AND_BACK,        /* the ray is taken back from an instance to the next */
    CHEAT_EMPTY,                 /* where no instance is active, those of the world before are */
    CHEAT_COMPACT,               /* instances are numbered without those that are not active */
    CHEAT_GEOMETRY,              /* triangles are numbered within their geometries */
    CHEAT_NORMALS,               /* normals are transformed by M */
    CHEAT_HARD_COUNT
};

static struct {
    enum world_cheat cheat;
    struct world_job job;
    struct instance_record *record;
    struct box *stale; /* of the world before, `stale_count` of them */
    struct box *box;
    uint32_t stale_count, box_count;
    struct ray carried;    /* from instance to instance */
    const struct ray *ray; /* whose hit, of a list the farthest, is spoilt; NULL: none */
    unsigned spoilt;       /* how often */
    void (*spoil)(unsigned spoilt, struct hit *hit, uint32_t *tag);
} cheater;

static inline bool cheats(enum world_cheat cheat)
{
    return cheater.cheat == cheat;
}

#include "tests/two_level/cheat_parts.h"

static bool cheat_meets(const struct instance *in, struct ray_mode mode)
{
    if (in->mesh == WORLD_NO_MESH)
        return false;
    if ((mode.flags & ABI_RAY_SKIP_TRIANGLES) && !cheats(CHEAT_NO_SKIP))
        return false;
    if (cheats(CHEAT_MASK_EQUAL))
        return in->mask == mode.mask;
    return (in->mask & mode.mask) != 0 || cheats(CHEAT_NO_MASK);
}

static bool cheat_opaque(const struct instance *in, bool opaque, struct ray_mode mode)
{
    if ((in->flags & ABI_INSTANCE_FORCE_OPAQUE) && !cheats(CHEAT_NO_FORCE))
        opaque = true;
    if ((in->flags & ABI_INSTANCE_FORCE_NO_OPAQUE) && !cheats(CHEAT_NO_FORCE))
        opaque = false;
    if ((mode.flags & ABI_RAY_OPAQUE) && !cheats(CHEAT_NO_RAY_OPACITY))
        opaque = true;
    if ((mode.flags & ABI_RAY_NO_OPAQUE) && !cheats(CHEAT_NO_RAY_OPACITY))
        opaque = false;
    return opaque;
}

static bool cheat_front(const struct instance *in, float side)
{
    bool front = side < 0.0f;
    if ((in->flags & ABI_INSTANCE_FLIP_FACING) && !cheats(CHEAT_NO_FLIP))
        front = !front;
    if (cheats(CHEAT_MIRROR) && instance_det_sign(in->m) < 0)
        front = !front;
    return front;
}

static bool cheat_culls(const struct instance *in, bool opaque, bool front, struct ray_mode mode)
{
    const uint32_t by_opacity = opaque ? ABI_RAY_CULL_OPAQUE : ABI_RAY_CULL_NO_OPAQUE;
    const uint32_t by_facing = front ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK;
    const bool disabled = in->flags & ABI_INSTANCE_CULL_DISABLE;
    if ((mode.flags & by_opacity) && !cheats(CHEAT_NO_OPACITY_CULL))
        return true;
    return (mode.flags & by_facing) && !cheats(CHEAT_NO_CULL) &&
           (!disabled || cheats(CHEAT_NO_DISABLE));
}

/* Whether a hit counts. hit->prim is a triangle of the mesh, then of the world. */
static bool cheat_counts(uint32_t index, const struct ray *inside, struct ray_mode mode,
                         struct hit *hit, uint32_t *tag)
{
    const struct world *world = cheater.job.world;
    const struct instance *in = &world->instance[index];
    const struct place place = world_place_in(world, index, hit->prim);
    float v[3][3];
    scene_tri(world_scene(world, index), hit->prim, v);
    bool front = cheat_front(in, cheats(CHEAT_NORMALS) ? side_by_m(in, inside->dir, v)
                                                       : candidate_side(inside->dir, v));
    bool opaque = cheat_opaque(in, world->mesh[in->mesh].geometry[place.geometry].opaque, mode);
    uint32_t custom = cheats(CHEAT_INDEX) || cheats(CHEAT_EXCHANGE) ? index : in->custom;
    uint32_t shown = index;
    if (cheats(CHEAT_EXCHANGE) && in->custom < world->instance_count)
        shown = in->custom;
    if (cheats(CHEAT_COMPACT))
        shown = compact_number(world, index);
    if (cheats(CHEAT_GEOMETRY))
        hit->prim = place.tri;
    custom = cheats(CHEAT_CUT) ? custom & 0xFFFF : custom;
    *tag = custom | ((front != cheats(CHEAT_OTHER_FACE)) ? ABI_TAG_FRONT : 0);
    hit->prim += world->first[shown];
    if (cheat_culls(in, opaque, front, mode))
        return false;
    if (opaque || cheats(CHEAT_NO_FILTER))
        return true;
    return !cheats(CHEAT_PASS_OVER) && filter_passes(&world->filter, &place, hit->u, hit->v);
}

static struct ray cheat_inside(uint32_t index, const struct ray *ray)
{
    bool last = cheats(CHEAT_LAST_TRANSFORM) && index > 0 &&
                cheater.record[index - 1].mesh != WORLD_NO_MESH;
    struct instance_record record = cheater.record[index];
    if (cheats(CHEAT_FLOAT_INVERSE))
        float_inverse(cheater.job.world->instance[index].m, record.w);
    if (cheats(CHEAT_FLOAT_INVERSE))
        return transform_ray(&record, ray);
    if (cheats(CHEAT_FORTH_AND_BACK)) {
        const struct ray inside = transform_ray(&record, &cheater.carried);
        cheater.carried = ray_back(&cheater.job.world->instance[index], &inside);
        return inside;
    }
    return transform_ray(&cheater.record[last ? index - 1 : index], ray);
}

/* What a ray has found. */
struct cheat_found {
    struct hit best;
    float nearest; /* t of it, in units of the direction */
    uint32_t tag, listed, capacity;
    struct hit *list;
    uint32_t *tags;
    bool all, any;
};

/* Goes through one instance; true if the ray ends there. */
static bool cheat_enter(uint32_t index, const struct ray *ray, struct ray_mode mode,
                        struct cheat_found *f)
{
    const struct scene *scene = world_scene(cheater.job.world, index);
    const struct ray inside = cheat_inside(index, ray);
    const struct tri_ray tri = tri_ray_make(&inside);
    if (cheats(CHEAT_NOT_CARRIED) || f->best.prim == ABI_NO_PRIM)
        f->nearest = INFINITY;
    for (uint32_t k = 0; k < scene->tri_count; k++) {
        struct hit hit;
        uint32_t tag;
        float v[3][3];
        scene_tri(scene, k, v);
        if (!tri_test_run(cheater.job.tri->id, &tri, v, &hit) || (!f->all && hit.t >= f->nearest))
            continue;
        hit.prim = k;
        bool counts = cheat_counts(index, &inside, mode, &hit, &tag);
        if (cheats(CHEAT_MISS_TAG) && f->best.prim == ABI_NO_PRIM)
            f->tag = tag;
        if (!counts && cheats(CHEAT_FIRST_PASSED) && f->any)
            return true;
        if (!counts || (index == 0 && cheats(CHEAT_INSTANCE_0)))
            continue;
        f->nearest = hit.t;
        if (cheats(CHEAT_LENGTH))
            hit.t *= sqrtf(ray->dir[0] * ray->dir[0] + ray->dir[1] * ray->dir[1] +
                           ray->dir[2] * ray->dir[2]);
        if (f->all && f->listed < f->capacity) {
            f->list[f->listed] = hit;
            f->tags[f->listed] = tag;
        }
        f->listed++;
        f->best = hit;
        f->tag = tag;
        if (f->any)
            return true;
    }
    return false;
}

static void cheat_ray(const struct ray *ray, struct ray_mode mode, struct cheat_found *f)
{
    const struct world *world = cheater.job.world;
    bool ends = false;
    cheater.carried = *ray;
    f->best = hit_none();
    f->tag = f->listed = 0;
    f->any = !f->all && (cheater.job.query == QUERY_ANY ||
                         ((mode.flags & ABI_RAY_FIRST) && !cheats(CHEAT_NO_FIRST)));
    for (uint32_t i = 0; i < world->instance_count && !ends; i++)
        if (cheat_meets(&world->instance[i], mode) && cheat_box_is_met(i, ray))
            ends = cheat_enter(i, ray, mode, f);
}

static void cheat_spoil(const struct ray *ray, struct hit *hit, uint32_t *tag)
{
    if (cheater.ray && memcmp(ray, cheater.ray, sizeof *ray) == 0)
        cheater.spoil(cheater.spoilt++, hit, tag);
}

static enum status cheat_open(const struct engine *engine, const struct engine_options *options,
                              void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &cheater;
    return STATUS_OK;
}

static enum status cheat_prepare_world(void *self, const struct world_job *job,
                                       struct reason *reason)
{
    (void)self;
    if (cheats(CHEAT_EMPTY) && cheater.record && !any_is_active(job->world))
        return STATUS_OK;
    if (!keep_boxes(job->world))
        return STATUS_MEMORY;
    free(cheater.record);
    cheater.record = NULL;
    cheater.job = *job;
    return world_records_make(job->world, &cheater.record, reason);
}

static enum status cheat_trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                                     size_t ray_count, struct hit *hit, uint32_t *tag,
                                     struct trace_report *report, struct reason *reason)
{
    (void)self, (void)reason;
    *report = (struct trace_report){.ns = 1000};
    for (size_t i = 0; i < ray_count; i++) {
        struct cheat_found f = {.all = false};
        cheat_ray(&ray[i], mode ? mode[i] : ray_mode_all(), &f);
        hit[i] = f.best;
        tag[i] = f.tag;
        cheat_spoil(&ray[i], &hit[i], &tag[i]);
    }
    return STATUS_OK;
}

static enum status cheat_trace_world_all(void *self, const struct ray *ray,
                                         const struct ray_mode *mode, size_t ray_count,
                                         uint32_t capacity, struct hit *hit, uint32_t *tag,
                                         uint32_t *hit_count, struct reason *reason)
{
    (void)self, (void)reason;
    for (size_t i = 0; i < ray_count; i++) {
        struct cheat_found f = {.all = true,
                                .capacity = capacity,
                                .list = hit + i * capacity,
                                .tags = tag + i * capacity};
        cheat_ray(&ray[i], mode ? mode[i] : ray_mode_all(), &f);
        hit_count[i] = f.listed;
        uint32_t farthest = 0;
        for (uint32_t k = 1; k < f.listed && k < capacity; k++)
            farthest = f.list[k].t > f.list[farthest].t ? k : farthest;
        cheat_spoil(&ray[i], &f.list[farthest], &f.tags[farthest]);
    }
    return STATUS_OK;
}

static void cheat_close(void *self)
{
    (void)self;
    free(cheater.record);
    free(cheater.box);
    free(cheater.stale);
    cheater.record = NULL;
    cheater.box = cheater.stale = NULL;
    cheater.box_count = cheater.stale_count = 0;
}

static const struct world_tracer cheat_worlds = {
    .prepare_world = cheat_prepare_world,
    .trace_world = cheat_trace_world,
    .trace_world_all = cheat_trace_world_all,
};

/* Judged by the bounds of its formula, not by bits. */
static const struct engine cheating = {
    .name = "cheating",
    .open = cheat_open,
    .model = cpu_rays_model,
    .worlds = &cheat_worlds,
    .close = cheat_close,
};

/* What a tracer with the cheat answers, without trees. */
static inline void cheat_answers(enum world_cheat cheat, const struct world *world,
                                 enum query query, const struct ray *ray,
                                 const struct ray_mode *mode, size_t count, struct hit *hit,
                                 uint32_t *tag)
{
    const struct world_job job = {.world = world,
                                  .box = box_test_find("watertight"),
                                  .tri = tri_test_find("mt"),
                                  .query = query};
    struct trace_report report;
    struct reason reason = {""};
    cheater.cheat = cheat;
    assert_int_equal(cheat_prepare_world(&cheater, &job, &reason), STATUS_OK);
    assert_int_equal(cheat_trace_world(&cheater, ray, mode, count, hit, tag, &report, &reason),
                     STATUS_OK);
    cheat_close(&cheater);
}

#endif
