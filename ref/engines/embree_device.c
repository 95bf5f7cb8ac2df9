/* Embree 3 or 4: devices, scenes, and rays through them. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/cpu_rays.h"
#include "ref/engines/embree_inner.h"

#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool embree_memory(void *user, ssize_t bytes, bool post)
{
    struct embree *embree = user;
    (void)post;
    atomic_fetch_add(&embree->bytes, (long long)bytes);
    return true;
}

enum status embree_error(struct embree *embree, const char *doing, struct reason *reason)
{
    enum RTCError error = rtcGetDeviceError(embree->device);
    if (error == RTC_ERROR_NONE)
        return STATUS_OK;
    enum status status = error == RTC_ERROR_OUT_OF_MEMORY ? STATUS_MEMORY : STATUS_DEVICE;
    return fail(reason, status, "Embree: error %d while %s", (int)error, doing);
}

void embree_drop(struct embree *embree)
{
    if (embree->scene)
        rtcReleaseScene(embree->scene);
    embree->scene = NULL;
    embree_world_free(embree->world);
    embree->world = NULL;
}

void embree_close(void *self)
{
    struct embree *embree = self;
    if (!embree)
        return;
    embree_drop(embree);
    if (embree->device)
        rtcReleaseDevice(embree->device);
    free(embree->rays);
    free(embree);
}

enum status embree_open_mode(const struct engine_options *options, enum embree_mode mode,
                             void **self, struct reason *reason)
{
    struct embree *embree = alloc_zeroed(1, sizeof *embree);
    *self = NULL;
    if (!embree)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    embree->mode = mode;
    embree->compact = options->compact;
    embree->unguarded = options->unguarded;
    embree->threads = cpu_rays_threads(options);
    char config[sizeof "threads=4294967295,frequency_level=simd512"];
    snprintf(config, sizeof config, "threads=%u%s", embree->threads,
             options->avx512 ? ",frequency_level=simd512" : "");
    embree->device = rtcNewDevice(config);
    if (!embree->device) {
        free(embree);
        return fail(reason, STATUS_UNSUPPORTED, "Embree: no device for this processor (error %d)",
                    (int)rtcGetDeviceError(NULL));
    }
    embree->masks = rtcGetDeviceProperty(embree->device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED);
    rtcSetDeviceMemoryMonitorFunction(embree->device, embree_memory, embree);
    *self = embree;
    return STATUS_OK;
}

/* One ray of QUERY_ALL: the context that Embree passes to the filter, and the list of hits. */
struct embree_list {
    embree_context context; /* first: Embree passes its address to the filter */
    struct hit *hit;
    uint32_t capacity, found;
};

/* Adds the hit to the list and rejects it, so that the ray keeps its length and is traced on. Rays
 * are traced one by one: only a group of one has the layout of the single structs, and C has no
 * accessors for others. */
static void embree_list_filter(const struct RTCFilterFunctionNArguments *args)
{
    struct embree_list *list = (struct embree_list *)args->context;
    const struct RTCRay *ray = (const struct RTCRay *)args->ray;
    const struct RTCHit *hit = (const struct RTCHit *)args->hit;
    if (args->N != 1 || args->valid[0] != -1)
        return;
    if (list->found < list->capacity)
        list->hit[list->found] = (struct hit){ray->tfar, hit->u, hit->v, hit->primID};
    list->found++;
    args->valid[0] = 0;
}

static enum status embree_add_mesh(struct embree *embree, const struct scene *scene,
                                   struct reason *reason)
{
    RTCGeometry mesh = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertex = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            3 * sizeof(float), scene->vertex_count);
    unsigned *index = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(unsigned), scene->tri_count);
    if (!vertex || !index) {
        rtcReleaseGeometry(mesh);
        return fail(reason, STATUS_MEMORY, "Embree: no memory for %u triangles", scene->tri_count);
    }
    memcpy(vertex, scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count);
    memcpy(index, scene->index, 3 * sizeof(unsigned) * (size_t)scene->tri_count);
    if (embree->query == QUERY_ALL)
        rtcSetGeometryIntersectFilterFunction(mesh, embree_list_filter);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(embree->scene, mesh);
    rtcReleaseGeometry(mesh);
    return STATUS_OK;
}

RTCScene embree_scene(const struct embree *embree)
{
    RTCScene scene = rtcNewScene(embree->device);
    rtcSetSceneFlags(scene,
                     (embree->mode == EMBREE_ROBUST ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE) |
                         (embree->compact ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE));
    if (embree->mode == EMBREE_HIGH)
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    return scene;
}

enum status embree_commit(struct embree *embree, RTCScene scene, struct reason *reason)
{
    /* The build sets flush-to-zero on this thread; restore the mode for the reference. */
    fenv_t environment;
    fegetenv(&environment);
    rtcCommitScene(scene);
    fesetenv(&environment);
    return embree_error(embree, "building", reason);
}

enum status embree_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct embree *embree = self;
    embree_drop(embree);
    embree->query = job->query;
    embree->scene = embree_scene(embree);
    enum status status = STATUS_OK;
    if (job->scene->tri_count > 0)
        status = embree_add_mesh(embree, job->scene, reason);
    return status ? status : embree_commit(embree, embree->scene, reason);
}

bool embree_takes(const struct embree *embree, const struct ray *ray)
{
    if (embree->unguarded)
        return true;
    for (int k = 0; k < 3; k++)
        if (!(ray->org[k] < EMBREE_MOST && ray->org[k] > -EMBREE_MOST) ||
            !(ray->dir[k] < EMBREE_MOST && ray->dir[k] > -EMBREE_MOST))
            return false;
    return ray->tmin >= 0.0f && ray->tmax >= ray->tmin;
}

struct RTCRayHit embree_query(const struct ray *ray)
{
    return (struct RTCRayHit){
        .ray = {.org_x = ray->org[0],
                .org_y = ray->org[1],
                .org_z = ray->org[2],
                .tnear = ray->tmin,
                .dir_x = ray->dir[0],
                .dir_y = ray->dir[1],
                .dir_z = ray->dir[2],
                .tfar = ray->tmax,
                .mask = 0xFFFFFFFFu},
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID},
    };
}

void embree_start(embree_context *context)
{
#if HAVE_EMBREE == 4
    rtcInitRayQueryContext(context);
#else
    rtcInitIntersectContext(context);
#endif
}

void embree_intersect(RTCScene scene, embree_context *context, struct RTCRayHit *query)
{
    embree_start(context);
#if HAVE_EMBREE == 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    rtcIntersect1(scene, query, &arguments);
#else
    rtcIntersect1(scene, context, query);
#endif
}

bool embree_occluded(RTCScene scene, embree_context *context, struct RTCRay *ray)
{
    embree_start(context);
#if HAVE_EMBREE == 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    rtcOccluded1(scene, ray, &arguments);
#else
    rtcOccluded1(scene, context, ray);
#endif
    return ray->tfar < 0.0f;
}

static uint32_t embree_all(struct embree *embree, const struct ray *ray, uint32_t capacity,
                           struct hit *hit)
{
    struct RTCRayHit query = embree_query(ray);
    struct embree_list list = {.hit = hit, .capacity = capacity};
    embree_intersect(embree->scene, &list.context, &query);
    return list.found;
}

enum status embree_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    struct embree *embree = self;
#pragma omp parallel for schedule(dynamic, 64) num_threads(embree->threads) if (ray_count > 64)
    for (long long i = 0; i < (long long)ray_count; i++)
        hit_count[i] = embree_takes(embree, &ray[i])
                           ? embree_all(embree, &ray[i], capacity, hit + (size_t)i * capacity)
                           : 0;
    return embree_error(embree, "tracing", reason);
}

void embree_describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device) {
        snprintf(text, text_bytes, "no device for this processor");
        return;
    }
    bool masks = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED);
    snprintf(text, text_bytes, "Embree %lld.%lld.%lld, %u threads%s",
             (long long)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
             (long long)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
             (long long)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_PATCH),
             cpu_rays_threads(options), masks ? "" : ", without masks of rays");
    rtcReleaseDevice(device);
}

#endif
