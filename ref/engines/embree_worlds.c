/* Worlds in Embree: a scene for each mesh with a geometry for each of its own, and a scene of
 * instances over them. Instances and geometries keep their numbers. What a ray may meet is decided
 * by Embree's masks and by a filter function of every geometry, which Embree calls with the ray in
 * the space of the mesh. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_facing.h"
#include "ref/engines/embree_world_inner.h"
#include "ref/world/world_boxes.h"

#include <stdlib.h>
#include <string.h>

void embree_world_free(struct embree_world *world)
{
    if (!world)
        return;
    if (world->top)
        rtc.ReleaseScene(world->top);
    for (uint32_t i = 0; i < world->mesh_count && world->mesh; i++)
        if (world->mesh[i])
            rtc.ReleaseScene(world->mesh[i]);
    free(world->mesh);
    free(world->placed);
    free(world);
}

/* --- what counts ------------------------------------------------------------------------------ */

/* One ray: the context that Embree passes to the filter. */
struct embree_walk {
    embree_context context; /* first: Embree passes its address */
    const struct embree *embree;
    struct ray_mode mode;
    bool lists;
    struct hit *hit;
    uint32_t *tag;
    uint32_t capacity, found;
    bool nearest; /* the nearest hit is wanted, not lists and not any */
    bool ended;   /* it was a hit whose t is NaN, which is then in *hit and *tag */
};

bool embree_place_of(const struct world *world, const struct RTCHit *hit, struct place *out)
{
    *out = (struct place){.instance = hit->instID[0], .geometry = hit->geomID, .tri = hit->primID};
    if (out->instance >= world->instance_count || !world_scene(world, out->instance))
        return false;
    out->mesh = world->instance[out->instance].mesh;
    const struct world_mesh *mesh = &world->mesh[out->mesh];
    if (out->geometry >= mesh->geometry_count || out->tri >= mesh->geometry[out->geometry].count)
        return false;
    out->prim = mesh->geometry[out->geometry].first + out->tri;
    return true;
}

#define PHANTOM 0xFFFFFFFEu /* a triangle that no world has */

void embree_take_hit(const struct world *world, const struct RTCHit *from, float t, struct hit *hit,
                     uint32_t *tag)
{
    struct place place;
    *hit = (struct hit){t, from->u, from->v, PHANTOM};
    *tag = 0;
    if (!embree_place_of(world, from, &place))
        return;
    hit->prim = world->first[place.instance] + place.prim;
    *tag = world->instance[place.instance].custom | (from->Ng_x > 0.0f ? ABI_TAG_FRONT : 0);
}

void embree_read_hit(const struct embree_world *world, struct RTCRayHit *from, struct hit *hit,
                     uint32_t *tag)
{
    struct place place;
    if (world->bare && embree_place_of(world->world, &from->hit, &place))
        face_from_world(&world->world->instance[place.instance], from);
    embree_take_hit(world->world, &from->hit, from->ray.tfar, hit, tag);
}

/* Decides about one candidate. Rays are traced one by one: only a group of one has the layout of
 * the single structs. Numbers that the world does not have are accepted, so that they are seen. */
static void filter_candidate(const struct RTCFilterFunctionNArguments *args)
{
    struct embree_walk *walk = (struct embree_walk *)args->context;
    const struct world *world = walk->embree->world->world;
    const struct RTCRay *ray = (const struct RTCRay *)args->ray;
    struct RTCHit *hit = (struct RTCHit *)args->hit;
    struct place place;
    if (walk->ended)
        args->valid[0] = 0;
    if (args->N != 1 || args->valid[0] != -1)
        return;
    if (embree_place_of(world, hit, &place)) {
        const struct instance *instance = &world->instance[place.instance];
        bool stated = world->mesh[place.mesh].geometry[place.geometry].opaque;
        bool opaque = world_is_opaque(instance, stated, walk->mode);
        bool front = sees_front(instance, ray, hit);
        if ((!walk->embree->masks && !world_meets(instance, walk->mode)) ||
            world_culls(instance, opaque, front, walk->mode) ||
            (!opaque && !filter_passes(&world->filter, &place, hit->u, hit->v))) {
            args->valid[0] = 0;
            return;
        }
        hit->Ng_x = (float)front;
    }
    /* With a NaN for its length the ray would be invalid in the next instance, and Embree with its
     * assertions aborts. */
    if (walk->nearest && ray->tfar != ray->tfar) {
        embree_take_hit(world, hit, ray->tfar, walk->hit, walk->tag);
        walk->ended = true;
        args->valid[0] = 0;
    }
    if (!walk->lists)
        return;
    if (walk->found < walk->capacity)
        embree_take_hit(world, hit, ray->tfar, &walk->hit[walk->found], &walk->tag[walk->found]);
    walk->found++;
    args->valid[0] = 0; /* the ray keeps its length */
}

/* --- building --------------------------------------------------------------------------------- */

/* A copy of the numbers in a buffer of Embree's; NULL without memory. Embree may read 16 bytes
 * where the last vertex is. */
static RTCBuffer copy_of(const struct embree *embree, const void *data, size_t bytes)
{
    RTCBuffer buffer = rtc.NewBuffer(embree->device, bytes + 16);
    void *to = buffer ? rtc.GetBufferData(buffer) : NULL;
    if (buffer && !to)
        rtc.ReleaseBuffer(buffer);
    return to ? memcpy(to, data, bytes), buffer : NULL;
}

static void add_geometry(const struct embree *embree, RTCScene to, const struct scene *scene,
                         const struct geometry *geometry, uint32_t number, RTCBuffer vertices,
                         RTCBuffer indices)
{
    RTCGeometry mesh = rtc.NewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtc.SetGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0,
                          3 * sizeof(float), scene->vertex_count);
    rtc.SetGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices,
                          3 * sizeof(unsigned) * (size_t)geometry->first, 3 * sizeof(unsigned),
                          geometry->count);
    rtc.SetGeometryMask(mesh, 0xFFFFFFFFu); /* masks of rays apply to it, too */
    if (!embree->world->bare) {
        rtc.SetGeometryIntersectFilterFunction(mesh, filter_candidate);
        rtc.SetGeometryOccludedFilterFunction(mesh, filter_candidate);
    }
    rtc.CommitGeometry(mesh);
    rtc.AttachGeometryByID(to, mesh, number);
    rtc.ReleaseGeometry(mesh);
}

static enum status build_mesh(struct embree *embree, const struct world_mesh *mesh, RTCScene *out,
                              struct reason *reason)
{
    const struct scene *scene = mesh->scene;
    if (scene->tri_count == 0)
        return STATUS_OK;
    RTCBuffer vertices = copy_of(embree, scene->vertex, 12 * (size_t)scene->vertex_count);
    RTCBuffer indices = copy_of(embree, scene->index, 12 * (size_t)scene->tri_count);
    enum status status = STATUS_OK;
    if (!vertices || !indices)
        status =
            fail(reason, STATUS_MEMORY, "Embree: no memory for %u triangles", scene->tri_count);
    if (!status) {
        *out = embree_scene(embree);
        for (uint32_t i = 0; i < mesh->geometry_count; i++)
            if (mesh->geometry[i].count)
                add_geometry(embree, *out, scene, &mesh->geometry[i], i, vertices, indices);
        status = embree_commit(embree, *out, reason);
    }
    if (vertices)
        rtc.ReleaseBuffer(vertices);
    if (indices)
        rtc.ReleaseBuffer(indices);
    return status;
}

enum status embree_add_instance(struct embree *embree, uint32_t number, struct reason *reason)
{
    struct embree_world *world = embree->world;
    const struct instance *instance = &world->world->instance[number];
    uint32_t mask;
    enum status status = embree_instance_mask(embree, number, &mask, reason);
    if (status)
        return status;
    RTCGeometry geometry = rtc.NewGeometry(embree->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtc.SetGeometryInstancedScene(geometry, world->mesh[instance->mesh]);
    rtc.SetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance->m);
    rtc.SetGeometryMask(geometry, mask);
    rtc.CommitGeometry(geometry);
    rtc.AttachGeometryByID(world->top, geometry, number);
    rtc.ReleaseGeometry(geometry);
    return STATUS_OK;
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct embree *embree = self;
    const struct world *from = job->world;
    embree_drop(embree);
    if (embree->mode.quality == EMBREE_LOW && !embree->unguarded)
        return fail(reason, STATUS_UNSUPPORTED,
                    "Embree: its builder of quality low may abort on what is placed and has no "
                    "extent");
    embree->query = job->query;
    struct embree_world *world = embree->world = alloc_zeroed(1, sizeof *world);
    if (!world)
        return fail(reason, STATUS_MEMORY, "no memory for a world");
    world->world = from;
    world->bare = job->bare && from->filter.kind == FILTER_ALL;
    world->mesh_count = from->mesh_count;
    world->mesh = alloc_zeroed(from->mesh_count, sizeof *world->mesh);
    world->placed = alloc_zeroed(from->instance_count, sizeof *world->placed);
    enum status status = STATUS_OK;
    if (!world->mesh || !world->placed)
        status = fail(reason, STATUS_MEMORY, "no memory for %u meshes", from->mesh_count);
    for (uint32_t i = 0; i < from->mesh_count && !status; i++)
        status = build_mesh(embree, &from->mesh[i], &world->mesh[i], reason);
    world->top = embree_scene(embree);
    for (uint32_t i = 0; i < from->instance_count && !status; i++) {
        world->placed[i] = world_is_active(from, i);
        if (world->placed[i])
            status = embree_add_instance(embree, i, reason);
    }
    return status ? status : embree_commit(embree, world->top, reason);
}

/* --- tracing ---------------------------------------------------------------------------------- */

static struct ray_mode mode_at(const struct ray_mode *mode, size_t ray)
{
    return mode ? mode[ray] : ray_mode_all();
}

static void trace_one(const struct embree *embree, const struct ray *ray, struct ray_mode mode,
                      struct hit *hit, uint32_t *tag)
{
    struct embree_walk walk = {.embree = embree, .mode = mode};
    struct RTCRayHit query = embree_query(ray);
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    *tag = 0;
    query.ray.mask = embree_mask_for(embree, ray, mode);
    if (!query.ray.mask)
        return;
    if (embree->query == QUERY_ANY || (mode.flags & ABI_RAY_FIRST)) {
        /* Embree does not return what blocked the ray, so a hit is triangle 0 at t = 0. */
        if (embree_occluded(embree->world->top, &walk.context, &query.ray))
            hit->prim = 0;
        return;
    }
    walk.nearest = true;
    walk.hit = hit;
    walk.tag = tag;
    embree_intersect(embree->world->top, &walk.context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID || walk.ended)
        return;
    embree_read_hit(embree->world, &query, hit, tag);
}

static uint32_t list_one(const struct embree *embree, const struct ray *ray, struct ray_mode mode,
                         uint32_t capacity, struct hit *hit, uint32_t *tag)
{
    struct embree_walk walk = {.embree = embree,
                               .mode = mode,
                               .lists = true,
                               .hit = hit,
                               .tag = tag,
                               .capacity = capacity};
    struct RTCRayHit query = embree_query(ray);
    query.ray.mask = embree_mask_for(embree, ray, mode);
    if (query.ray.mask)
        embree_intersect(embree->world->top, &walk.context, &query);
    return walk.found;
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    struct embree *embree = self;
    if (embree->world->bare && !mode)
        return embree_trace_bare(embree, ray, ray_count, hit, tag, report, reason);
    uint64_t start = time_ns();
#pragma omp parallel for schedule(dynamic, 64) num_threads(embree->threads) if (ray_count > 64)
    for (long long i = 0; i < (long long)ray_count; i++)
        trace_one(embree, &ray[i], mode_at(mode, (size_t)i), &hit[i], &tag[i]);
    *report = (struct trace_report){.ns = time_ns() - start,
                                    .memory_bytes = (uint64_t)atomic_load(&embree->bytes)};
    return embree_error(embree, "tracing", reason);
}

static enum status trace_world_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    struct embree *embree = self;
    if (embree->world->bare)
        return fail(reason, STATUS_UNSUPPORTED, "Embree: hits of a bare world cannot be listed");
#pragma omp parallel for schedule(dynamic, 64) num_threads(embree->threads) if (ray_count > 64)
    for (long long i = 0; i < (long long)ray_count; i++) {
        size_t first = (size_t)i * capacity;
        hit_count[i] = list_one(embree, &ray[i], mode_at(mode, (size_t)i), capacity,
                                capacity ? hit + first : NULL, capacity ? tag + first : NULL);
    }
    return embree_error(embree, "tracing", reason);
}

const struct world_tracer embree_worlds = {
    .prepare_world = prepare_world,
    .move_world = embree_move_world,
    .trace_world = trace_world,
    .trace_world_all = trace_world_all,
};

#endif
