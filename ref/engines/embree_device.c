/* Embree 3 or 4: devices, scenes, and rays through them. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/cpu_rays.h"
#include "ref/engines/embree_inner.h"
#include "ref/engines/embree_isa.h"

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
    enum RTCError error = rtc.GetDeviceError(embree->device);
    if (error == RTC_ERROR_NONE)
        return STATUS_OK;
    enum status status = error == RTC_ERROR_OUT_OF_MEMORY ? STATUS_MEMORY : STATUS_DEVICE;
    return fail(reason, status, "Embree: error %d while %s", (int)error, doing);
}

void embree_drop(struct embree *embree)
{
    if (embree->scene)
        rtc.ReleaseScene(embree->scene);
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
        rtc.ReleaseDevice(embree->device);
    free(embree->rays);
    free(embree);
}

enum status embree_open_mode(const struct engine_options *options, const struct embree_mode *mode,
                             void **self, struct reason *reason)
{
    *self = NULL;
    enum status status = embree_load(reason);
    if (!status)
        status = embree_isa_check(mode->isa, reason);
    if (status)
        return status;
    struct embree *embree = alloc_zeroed(1, sizeof *embree);
    if (!embree)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    embree->mode = *mode;
    embree->mode.compact = mode->compact || options->compact;
    embree->unguarded = options->unguarded;
    embree->threads = cpu_rays_threads(options);
    const char *isa = mode->isa         ? embree_isa_configs[mode->isa]
                      : options->avx512 ? ",frequency_level=simd512"
                                        : "";
    char config[sizeof "threads=4294967295,isa=sse4.2,frequency_level=simd512"];
    snprintf(config, sizeof config, "threads=%u%s", embree->threads, isa);
    embree->device = rtc.NewDevice(config);
    if (!embree->device) {
        free(embree);
        return fail(reason, STATUS_UNSUPPORTED, "Embree: no device for this processor (error %d)",
                    (int)rtc.GetDeviceError(NULL));
    }
    embree->masks = rtc.GetDeviceProperty(embree->device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED);
    rtc.SetDeviceMemoryMonitorFunction(embree->device, embree_memory, embree);
    *self = embree;
    return STATUS_OK;
}

/* Whether the list of a ray has the triangle. */
static bool is_listed(const struct embree_lists *lists, size_t ray, unsigned prim)
{
    const struct hit *hit = lists->hit + ray * lists->capacity;
    for (uint32_t i = 0; i < lists->found[ray] && i < lists->capacity; i++)
        if (hit[i].prim == prim)
            return true;
    return false;
}

/* Embree calls a group of N as it is built of arrays of N, in the order of the single structures;
 * C has no accessors for them. A packet may come in pieces, so ids tell the rays. */
void embree_list_filter(const struct RTCFilterFunctionNArguments *args)
{
    enum { RAY_TFAR = 8, RAY_ID = 10, HIT_U = 3, HIT_V = 4, HIT_PRIM = 5 };
    struct embree_lists *lists = (struct embree_lists *)args->context;
    const float *ray = (const float *)args->ray, *hit = (const float *)args->hit;
    const unsigned *ray_word = (const unsigned *)args->ray, *hit_word = (const unsigned *)args->hit;
    const size_t n = args->N;
    for (size_t i = 0; i < n; i++) {
        if (args->valid[i] != -1)
            continue;
        args->valid[i] = 0;
        const size_t id = ray_word[RAY_ID * n + i];
        const unsigned prim = hit_word[HIT_PRIM * n + i];
        if (lists->twice && is_listed(lists, id, prim))
            continue;
        if (lists->found[id] < lists->capacity)
            lists->hit[id * lists->capacity + lists->found[id]] =
                (struct hit){ray[RAY_TFAR * n + i], hit[HIT_U * n + i], hit[HIT_V * n + i], prim};
        lists->found[id]++;
    }
}

static enum status embree_add_mesh(struct embree *embree, const struct scene *scene,
                                   struct reason *reason)
{
    RTCGeometry mesh = rtc.NewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertex = rtc.SetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             3 * sizeof(float), scene->vertex_count);
    unsigned *index = rtc.SetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                               3 * sizeof(unsigned), scene->tri_count);
    if (!vertex || !index) {
        rtc.ReleaseGeometry(mesh);
        return fail(reason, STATUS_MEMORY, "Embree: no memory for %u triangles", scene->tri_count);
    }
    memcpy(vertex, scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count);
    memcpy(index, scene->index, 3 * sizeof(unsigned) * (size_t)scene->tri_count);
    if (embree->mode.refit)
        rtc.SetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_REFIT);
    if (embree->query == QUERY_ALL)
        rtc.SetGeometryIntersectFilterFunction(mesh, embree_list_filter);
    rtc.CommitGeometry(mesh);
    rtc.AttachGeometry(embree->scene, mesh);
    rtc.ReleaseGeometry(mesh);
    return STATUS_OK;
}

RTCScene embree_scene(const struct embree *embree)
{
    RTCScene scene = rtc.NewScene(embree->device);
    rtc.SetSceneFlags(scene,
                      (embree->mode.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE) |
                          (embree->mode.compact ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE) |
                          (embree->mode.dynamic ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE));
    if (embree->mode.quality == EMBREE_HIGH)
        rtc.SetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    if (embree->mode.quality == EMBREE_LOW)
        rtc.SetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    return scene;
}

enum status embree_commit(struct embree *embree, RTCScene scene, struct reason *reason)
{
    /* The build sets flush-to-zero on this thread; restore the mode for the reference. */
    fenv_t environment;
    fegetenv(&environment);
    rtc.CommitScene(scene);
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

enum status embree_move(void *self, const struct job *job, struct reason *reason)
{
    struct embree *embree = self;
    const struct scene *scene = job->scene;
    if (scene->tri_count == 0)
        return STATUS_OK;
    RTCGeometry mesh = rtc.GetGeometry(embree->scene, 0);
    float *vertex = rtc.GetGeometryBufferData(mesh, RTC_BUFFER_TYPE_VERTEX, 0);
    memcpy(vertex, scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count);
    rtc.UpdateGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0);
    rtc.CommitGeometry(mesh);
    return embree_commit(embree, embree->scene, reason);
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
    rtc.Intersect1(scene, query, &arguments);
#else
    rtc.Intersect1(scene, context, query);
#endif
}

bool embree_occluded(RTCScene scene, embree_context *context, struct RTCRay *ray)
{
    embree_start(context);
#if HAVE_EMBREE == 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    rtc.Occluded1(scene, ray, &arguments);
#else
    rtc.Occluded1(scene, context, ray);
#endif
    return ray->tfar < 0.0f;
}

static void list_one(const struct embree *embree, const struct ray *ray, uint32_t capacity,
                     struct hit *hit, uint32_t *hit_count)
{
    struct RTCRayHit query = embree_query(ray);
    struct embree_lists lists = {.hit = hit,
                                 .capacity = capacity,
                                 .found = hit_count,
                                 .twice = embree->mode.quality == EMBREE_HIGH};
    *hit_count = 0;
    if (embree_takes(embree, ray))
        embree_intersect(embree->scene, &lists.context, &query);
}

enum status embree_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    struct embree *embree = self;
    const size_t step = embree->mode.packet ? embree->mode.packet : 1;
#pragma omp parallel for schedule(dynamic, 64) num_threads(embree->threads) if (ray_count > 64)
    for (long long i = 0; i < (long long)ray_count; i += (long long)step) {
        const size_t first = (size_t)i, left = ray_count - first;
        struct hit *lists = hit ? hit + first * capacity : NULL;
        if (embree->mode.packet)
            embree_packet_list(embree, ray + first, left < step ? left : step, capacity, lists,
                               hit_count + first);
        else
            list_one(embree, &ray[i], capacity, lists, &hit_count[i]);
    }
    return embree_error(embree, "tracing", reason);
}

void embree_describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine;
    struct reason reason;
    if (embree_load(&reason)) {
        snprintf(text, text_bytes, "%s", reason.text);
        return;
    }
    RTCDevice device = rtc.NewDevice("threads=1");
    if (!device) {
        snprintf(text, text_bytes, "no device for this processor");
        return;
    }
    bool masks = rtc.GetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED);
    snprintf(text, text_bytes, "Embree %lld.%lld.%lld, %u threads%s",
             (long long)rtc.GetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
             (long long)rtc.GetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
             (long long)rtc.GetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_PATCH),
             cpu_rays_threads(options), masks ? "" : ", without masks of rays");
    rtc.ReleaseDevice(device);
}

#endif
