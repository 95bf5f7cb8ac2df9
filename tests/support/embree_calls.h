/* Embree's functions as a test sees them: each is counted and then does what it does, unless the
 * test wants a failure or answers for it. Define _GNU_SOURCE before the first include; for one
 * thread and one file of a program. */
#ifndef TESTS_EMBREE_CALLS_H
#define TESTS_EMBREE_CALLS_H

#include "ref/engines/embree_inner.h"

#include <dlfcn.h>
#include <fenv.h>
#include <stdio.h>

#define CALLS_MASKS 64

static struct {
    int devices, scenes, geometries, buffers; /* made and not yet released */
    unsigned made;                            /* all of them */
    size_t bytes;                             /* of the last buffer */
    char config[64];                          /* of the last device */
    unsigned flags[4], qualities[3];          /* scenes with each flag, and with each quality */
    unsigned filters[2];                      /* geometries with one: closest, any */
    RTCFilterFunctionN filter;                /* the last of them */
    unsigned mask[CALLS_MASKS], masks;        /* of geometries, in order */
    unsigned closest, any;                    /* rays */
    unsigned packets[2];                      /* the same in packets of 16 */
    unsigned of4[2], of8[2];                  /* of 4, of 8 */
    struct RTCRay ray;                        /* the last single one */
    int valid[16];                            /* of the last packet */
    struct RTCRay16 packet;

    bool no_device, no_ray_masks;
    const char *other;  /* what devices are made with instead; NULL: with what they are to be */
    bool rude;          /* a build leaves another rounding mode */
    ssize_t version[3]; /* unless 0 */
    unsigned no_memory; /* counts down to the memory that is not there; 0: all is */
    enum RTCError error;
    /* In place of Embree. */
    void (*answer)(embree_context *context, struct RTCRayHit *query);
    void (*answer16)(struct RTCRayHit16 *query);
} calls;

#define CALLS_REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static bool calls_memory_is_there(void)
{
    return calls.no_memory == 0 || --calls.no_memory > 0;
}

/* Forgets all that is counted and wanted. */
static void calls_forget(void)
{
    memset(&calls, 0, sizeof calls);
}

/* False, with the reason, where Embree cannot run. */
static bool calls_can_run(void)
{
    RTCDevice device = CALLS_REAL(rtcNewDevice)("threads=1");
    if (device)
        CALLS_REAL(rtcReleaseDevice)(device);
    else
        puts("SKIP Embree has no device for this processor");
    return device;
}

/* --- objects ---------------------------------------------------------------------------------- */

RTCDevice rtcNewDevice(const char *config)
{
    snprintf(calls.config, sizeof calls.config, "%s", config);
    if (calls.no_device)
        return NULL;
    calls.devices++;
    calls.made++;
    return CALLS_REAL(rtcNewDevice)(calls.other ? calls.other : config);
}

void rtcReleaseDevice(RTCDevice device)
{
    calls.devices--;
    CALLS_REAL(rtcReleaseDevice)(device);
}

RTCScene rtcNewScene(RTCDevice device)
{
    calls.scenes++;
    calls.made++;
    return CALLS_REAL(rtcNewScene)(device);
}

void rtcReleaseScene(RTCScene scene)
{
    calls.scenes--;
    CALLS_REAL(rtcReleaseScene)(scene);
}

RTCGeometry rtcNewGeometry(RTCDevice device, enum RTCGeometryType type)
{
    calls.geometries++;
    calls.made++;
    return CALLS_REAL(rtcNewGeometry)(device, type);
}

void rtcReleaseGeometry(RTCGeometry geometry)
{
    calls.geometries--;
    CALLS_REAL(rtcReleaseGeometry)(geometry);
}

RTCBuffer rtcNewBuffer(RTCDevice device, size_t bytes)
{
    if (!calls_memory_is_there())
        return NULL;
    calls.buffers++;
    calls.made++;
    calls.bytes = bytes;
    return CALLS_REAL(rtcNewBuffer)(device, bytes);
}

void rtcReleaseBuffer(RTCBuffer buffer)
{
    calls.buffers--;
    CALLS_REAL(rtcReleaseBuffer)(buffer);
}

void *rtcGetBufferData(RTCBuffer buffer)
{
    return calls_memory_is_there() ? CALLS_REAL(rtcGetBufferData)(buffer) : NULL;
}

void *rtcSetNewGeometryBuffer(RTCGeometry geometry, enum RTCBufferType type, unsigned slot,
                              enum RTCFormat format, size_t stride, size_t count)
{
    if (!calls_memory_is_there())
        return NULL;
    return CALLS_REAL(rtcSetNewGeometryBuffer)(geometry, type, slot, format, stride, count);
}

enum RTCError rtcGetDeviceError(RTCDevice device)
{
    enum RTCError error = CALLS_REAL(rtcGetDeviceError)(device);
    return calls.error ? calls.error : error;
}

ssize_t rtcGetDeviceProperty(RTCDevice device, enum RTCDeviceProperty which)
{
    if (which == RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED && calls.no_ray_masks)
        return 0;
    if (which == RTC_DEVICE_PROPERTY_VERSION_MAJOR && calls.version[0])
        return calls.version[0];
    if (which == RTC_DEVICE_PROPERTY_VERSION_MINOR && calls.version[1])
        return calls.version[1];
    if (which == RTC_DEVICE_PROPERTY_VERSION_PATCH && calls.version[2])
        return calls.version[2];
    return CALLS_REAL(rtcGetDeviceProperty)(device, which);
}

/* --- what they are set to --------------------------------------------------------------------- */

void rtcSetSceneFlags(RTCScene scene, enum RTCSceneFlags flags)
{
    calls.flags[((flags & RTC_SCENE_FLAG_ROBUST) ? 1 : 0) |
                ((flags & RTC_SCENE_FLAG_COMPACT) ? 2 : 0)]++;
    CALLS_REAL(rtcSetSceneFlags)(scene, flags);
}

void rtcSetSceneBuildQuality(RTCScene scene, enum RTCBuildQuality quality)
{
    calls.qualities[quality]++;
    CALLS_REAL(rtcSetSceneBuildQuality)(scene, quality);
}

void rtcSetGeometryIntersectFilterFunction(RTCGeometry geometry, RTCFilterFunctionN filter)
{
    calls.filters[0]++;
    calls.filter = filter;
    CALLS_REAL(rtcSetGeometryIntersectFilterFunction)(geometry, filter);
}

void rtcSetGeometryOccludedFilterFunction(RTCGeometry geometry, RTCFilterFunctionN filter)
{
    calls.filters[1]++;
    CALLS_REAL(rtcSetGeometryOccludedFilterFunction)(geometry, filter);
}

void rtcSetGeometryMask(RTCGeometry geometry, unsigned mask)
{
    if (calls.masks < CALLS_MASKS)
        calls.mask[calls.masks++] = mask;
    CALLS_REAL(rtcSetGeometryMask)(geometry, mask);
}

void rtcCommitScene(RTCScene scene)
{
    CALLS_REAL(rtcCommitScene)(scene);
    if (calls.rude)
        fesetround(FE_UPWARD);
}

/* --- rays ------------------------------------------------------------------------------------- */

#if HAVE_EMBREE == 4
#define CALLS_CLOSEST  RTCScene scene, struct RTCRayHit *query, struct RTCIntersectArguments *with
#define CALLS_ANY      RTCScene scene, struct RTCRay *ray, struct RTCOccludedArguments *with
#define CALLS_CONTEXT  with->context
#define CALLS_PASS(it) scene, it, with
#define CALLS_CLOSEST16                                                                            \
    const int *valid, RTCScene scene, struct RTCRayHit16 *query, struct RTCIntersectArguments *with
#define CALLS_ANY16                                                                                \
    const int *valid, RTCScene scene, struct RTCRay16 *ray, struct RTCOccludedArguments *with
#define CALLS_CLOSEST_OF(W)                                                                        \
    const int *valid, RTCScene scene, struct RTCRayHit##W *query, struct RTCIntersectArguments *with
#define CALLS_ANY_OF(W)                                                                            \
    const int *valid, RTCScene scene, struct RTCRay##W *ray, struct RTCOccludedArguments *with
#else
#define CALLS_CLOSEST  RTCScene scene, embree_context *with, struct RTCRayHit *query
#define CALLS_ANY      RTCScene scene, embree_context *with, struct RTCRay *ray
#define CALLS_CONTEXT  with
#define CALLS_PASS(it) scene, with, it
#define CALLS_CLOSEST16                                                                            \
    const int *valid, RTCScene scene, embree_context *with, struct RTCRayHit16 *query
#define CALLS_ANY16 const int *valid, RTCScene scene, embree_context *with, struct RTCRay16 *ray
#define CALLS_CLOSEST_OF(W)                                                                        \
    const int *valid, RTCScene scene, embree_context *with, struct RTCRayHit##W *query
#define CALLS_ANY_OF(W)                                                                            \
    const int *valid, RTCScene scene, embree_context *with, struct RTCRay##W *ray
#endif

void rtcIntersect1(CALLS_CLOSEST)
{
    calls.closest++;
    calls.ray = query->ray;
    if (calls.answer)
        calls.answer(CALLS_CONTEXT, query);
    else
        CALLS_REAL(rtcIntersect1)(CALLS_PASS(query));
}

void rtcOccluded1(CALLS_ANY)
{
    calls.any++;
    calls.ray = *ray;
    if (!calls.answer)
        CALLS_REAL(rtcOccluded1)(CALLS_PASS(ray));
}

void rtcIntersect16(CALLS_CLOSEST16)
{
    calls.packets[0]++;
    memcpy(calls.valid, valid, sizeof calls.valid);
    calls.packet = query->ray;
    if (calls.answer16)
        calls.answer16(query);
    else
        CALLS_REAL(rtcIntersect16)(valid, CALLS_PASS(query));
}

void rtcOccluded16(CALLS_ANY16)
{
    calls.packets[1]++;
    memcpy(calls.valid, valid, sizeof calls.valid);
    calls.packet = *ray;
    CALLS_REAL(rtcOccluded16)(valid, CALLS_PASS(ray));
}

#define CALLS_NARROW(W)                                                                            \
    void rtcIntersect##W(CALLS_CLOSEST_OF(W))                                                      \
    {                                                                                              \
        calls.of##W[0]++;                                                                          \
        memcpy(calls.valid, valid, W * sizeof *valid);                                             \
        CALLS_REAL(rtcIntersect##W)(valid, CALLS_PASS(query));                                     \
    }                                                                                              \
    void rtcOccluded##W(CALLS_ANY_OF(W))                                                           \
    {                                                                                              \
        calls.of##W[1]++;                                                                          \
        memcpy(calls.valid, valid, W * sizeof *valid);                                             \
        CALLS_REAL(rtcOccluded##W)(valid, CALLS_PASS(ray));                                        \
    }
CALLS_NARROW(4)
CALLS_NARROW(8)

#endif
