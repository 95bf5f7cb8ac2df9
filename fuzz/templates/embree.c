#include <fenv.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef EMBREE
#if __has_include(<embree4/rtcore.h>)
#define EMBREE 4
#else
#define EMBREE 3
#endif
#endif
#if EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "types.c"

#include "finding.h"

#include "check.c"

static void fail(RTCDevice device, const char *what)
{
    printf("cannot run: %s (Embree's error %d)\n", what, (int)rtcGetDeviceError(device));
    exit(2);
}

static RTCScene build(RTCDevice device)
{
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertex = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof vertices[0], VERTICES);
    uint32_t *index = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof indices[0], TRIANGLES);
    if (!vertex || !index)
        fail(device, "no buffers for the triangles");
    memcpy(vertex, vertices, sizeof vertices);
    memcpy(index, indices, sizeof indices);
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(scene, mesh, 0);
    rtcReleaseGeometry(mesh);
#if EXPORT_ROBUST
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
#endif
    /* Embree leaves flush-to-zero on: rays are traced without it, as they were by raydiff. */
    fenv_t environment;
    fegetenv(&environment);
    rtcCommitScene(scene);
    fesetenv(&environment);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
        fail(device, "the scene cannot be built");
    return scene;
}

#if EXPORT_ANY
/* Embree does not say what blocks a ray: a hit is triangle 0 at t = 0. */
static struct hit trace(RTCScene scene, const struct ray *ray)
{
    struct RTCRay query = {.org_x = ray->org[0],
                           .org_y = ray->org[1],
                           .org_z = ray->org[2],
                           .tnear = ray->tmin,
                           .dir_x = ray->dir[0],
                           .dir_y = ray->dir[1],
                           .dir_z = ray->dir[2],
                           .tfar = ray->tmax,
                           .mask = 0xFFFFFFFFu};
#if EMBREE == 4
    rtcOccluded1(scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &query);
#endif
    return (struct hit){.prim = query.tfar < 0.0f ? 0 : MISS};
}
#else
static struct hit trace(RTCScene scene, const struct ray *ray)
{
    struct RTCRayHit query = {
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
#if EMBREE == 4
    rtcIntersect1(scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return (struct hit){.prim = MISS};
    return (struct hit){query.ray.tfar, query.hit.u, query.hit.v, query.hit.primID};
}
#endif

int main(void)
{
    static struct hit hits[RAYS];
    static unsigned char finished[RAYS];
    setvbuf(stdout, NULL, _IOLBF, 0); /* what is said before a crash is seen */
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device)
        fail(NULL, "no Embree device for this processor");
    printf("Embree %d.%d.%d\n",
           (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
           (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
           (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_PATCH));
    RTCScene scene = build(device);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct ray ray;
        memcpy(&ray, rays[i], sizeof ray);
        hits[i] = trace(scene, &ray);
        finished[i] = 1;
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return check(hits, finished);
}
