/* Embree as its own users call it, as a shared object with rays of its own: they are filled before
 * rays_trace is timed, and read behind it.
 *
 *   cc -O2 -shared -fPIC -I RAYDIFF -o embree.so embree_engine.c -lembree3      (or -lembree4)
 *   raydiff bench fast --engine fast,inside:./embree.so
 *
 * `make bench-fair` holds raydiff's own row of Embree to it. */
#include "ref/raydiff_engine.h"

#if defined(EMBREE) && EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct plain {
    RTCDevice device;
    RTCScene scene;
    void *kept; /* memory of rays that were freed, for the next ones: fresh pages cost time */
    size_t kept_bytes;
};

struct rays {
    size_t count, bytes;
    struct RTCRayHit *closest; /* one of the two */
    struct RTCRay *any;
};

static int open_tracer(const struct raydiff_engine_options *options, void **self, char *reason)
{
    struct plain *plain = calloc(1, sizeof *plain);
    (void)options; /* rays_trace runs on the caller's thread */
    if (!plain)
        return RAYDIFF_ENGINE_MEMORY;
    plain->device = rtcNewDevice("threads=1");
    *self = plain;
    if (plain->device)
        return RAYDIFF_ENGINE_OK;
    free(plain);
    *self = NULL;
    snprintf(reason, RAYDIFF_ENGINE_REASON, "no device for this processor");
    return RAYDIFF_ENGINE_REFUSED;
}

static void close_tracer(void *self)
{
    struct plain *plain = self;
    if (plain->scene)
        rtcReleaseScene(plain->scene);
    rtcReleaseDevice(plain->device);
    free(plain->kept);
    free(plain);
}

static int build(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    struct plain *plain = self;
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    if (plain->scene)
        rtcReleaseScene(plain->scene);
    plain->scene = rtcNewScene(plain->device);
    if (triangles > 0) {
        RTCGeometry geometry = rtcNewGeometry(plain->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void *vertex = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices);
        void *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), triangles);
        if (vertex && index) {
            memcpy(vertex, mesh->vertex, 3 * sizeof(float) * vertices);
            memcpy(index, mesh->index, 3 * sizeof(uint32_t) * triangles);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(plain->scene, geometry);
        }
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(plain->scene);
    if (rtcGetDeviceError(plain->device) == RTC_ERROR_NONE)
        return RAYDIFF_ENGINE_OK;
    snprintf(reason, RAYDIFF_ENGINE_REASON, "no memory for %zu triangles", triangles);
    return RAYDIFF_ENGINE_MEMORY;
}

/* --- rays ------------------------------------------------------------------------------------- */

static int rays_make(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                     void **out, char *reason)
{
    struct plain *plain = self;
    struct rays *rays = calloc(1, sizeof *rays);
    const int any = query == RAYDIFF_ENGINE_QUERY_ANY;
    (void)reason;
    *out = rays;
    if (!rays)
        return RAYDIFF_ENGINE_MEMORY;
    rays->count = count;
    rays->bytes = (count + 1) * sizeof *rays->closest;
    if (plain->kept_bytes >= rays->bytes)
        rays->bytes = plain->kept_bytes;
    else
        free(plain->kept), plain->kept = malloc(rays->bytes); /* aligned to 16, as Embree wants */
    if (any)
        rays->any = plain->kept;
    else
        rays->closest = plain->kept;
    plain->kept = NULL;
    plain->kept_bytes = 0;
    if (!rays->any && !rays->closest)
        return RAYDIFF_ENGINE_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const struct RTCRay one = {.org_x = ray[i].origin[0], .org_y = ray[i].origin[1],
                                   .org_z = ray[i].origin[2], .tnear = ray[i].tmin,
                                   .dir_x = ray[i].direction[0], .dir_y = ray[i].direction[1],
                                   .dir_z = ray[i].direction[2], .tfar = ray[i].tmax,
                                   .mask = 0xFFFFFFFFu};
        if (any) {
            rays->any[i] = one;
            continue;
        }
        rays->closest[i].ray = one;
        rays->closest[i].hit = (struct RTCHit){.geomID = RTC_INVALID_GEOMETRY_ID,
                                               .primID = RTC_INVALID_GEOMETRY_ID};
    }
    return RAYDIFF_ENGINE_OK;
}

static int rays_trace(void *self, void *made, char *reason)
{
    const RTCScene scene = ((struct plain *)self)->scene;
    struct rays *rays = made;
    (void)reason;
#if defined(EMBREE) && EMBREE == 4
    for (size_t i = 0; i < rays->count; i++)
        if (rays->any)
            rtcOccluded1(scene, &rays->any[i], NULL);
        else
            rtcIntersect1(scene, &rays->closest[i], NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < rays->count; i++)
        if (rays->any)
            rtcOccluded1(scene, &context, &rays->any[i]);
        else
            rtcIntersect1(scene, &context, &rays->closest[i]);
#endif
    return RAYDIFF_ENGINE_OK;
}

static void hits_read(void *self, const void *made, struct raydiff_engine_hit *hit)
{
    const struct rays *rays = made;
    (void)self;
    for (size_t i = 0; i < rays->count; i++) {
        hit[i] = (struct raydiff_engine_hit){0, 0, 0, RAYDIFF_ENGINE_NONE};
        if (rays->any && rays->any[i].tfar < 0)
            hit[i].triangle = 0; /* Embree does not tell which */
        if (rays->closest && rays->closest[i].hit.geomID != RTC_INVALID_GEOMETRY_ID)
            hit[i] = (struct raydiff_engine_hit){
                rays->closest[i].ray.tfar, rays->closest[i].hit.u, rays->closest[i].hit.v,
                rays->closest[i].hit.primID};
    }
}

static void rays_free(void *self, void *made)
{
    struct plain *plain = self;
    struct rays *rays = made;
    free(plain->kept);
    plain->kept = rays->any ? (void *)rays->any : rays->closest;
    plain->kept_bytes = plain->kept ? rays->bytes : 0;
    free(rays);
}

static int trace(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                 struct raydiff_engine_hit *hit, char *reason)
{
    void *rays;
    int status = rays_make(self, ray, count, query, &rays, reason);
    if (status == RAYDIFF_ENGINE_OK)
        status = rays_trace(self, rays, reason);
    if (status == RAYDIFF_ENGINE_OK)
        hits_read(self, rays, hit);
    if (rays)
        rays_free(self, rays);
    return status;
}

static void model(void *self, struct raydiff_engine_model *out)
{
    (void)self;
    out->formula = RAYDIFF_ENGINE_EMBREE;
    out->rounding = RAYDIFF_ENGINE_EMBREE_ESTIMATES;
    out->flags = RAYDIFF_ENGINE_UNNAMED;
}

const struct raydiff_engine *raydiff_engine(void)
{
    static const struct raydiff_engine engine = {
        .version = RAYDIFF_ENGINE_VERSION, .bytes = sizeof engine,
        .name = "plain_embree", .summary = "a loop of rtcIntersect1",
        .can = RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_NATIVE,
        .open = open_tracer, .close = close_tracer, .build = build, .trace = trace,
        .rays_make = rays_make, .rays_trace = rays_trace, .hits_read = hits_read,
        .rays_free = rays_free, .model = model};
    return &engine;
}
