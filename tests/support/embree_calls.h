/* Embree's functions as a test sees them, once calls_can_run() was called: each is counted and then
 * does what it does, unless the test wants a failure or answers for it. For one thread and one file
 * of a program. */
#ifndef TESTS_EMBREE_CALLS_H
#define TESTS_EMBREE_CALLS_H

#include "ref/engines/embree_inner.h"

#include <fenv.h>
#include <stdio.h>
#include <string.h>

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

static struct embree_functions real; /* Embree's own */

static bool calls_memory_is_there(void)
{
    return calls.no_memory == 0 || --calls.no_memory > 0;
}

/* Forgets all that is counted and wanted. */
static void calls_forget(void)
{
    memset(&calls, 0, sizeof calls);
}

/* --- objects ---------------------------------------------------------------------------------- */

static RTCDevice calls_NewDevice(const char *config)
{
    snprintf(calls.config, sizeof calls.config, "%s", config);
    if (calls.no_device)
        return NULL;
    calls.devices++;
    calls.made++;
    return real.NewDevice(calls.other ? calls.other : config);
}

static void calls_ReleaseDevice(RTCDevice device)
{
    calls.devices--;
    real.ReleaseDevice(device);
}

static RTCScene calls_NewScene(RTCDevice device)
{
    calls.scenes++;
    calls.made++;
    return real.NewScene(device);
}

static void calls_ReleaseScene(RTCScene scene)
{
    calls.scenes--;
    real.ReleaseScene(scene);
}

static RTCGeometry calls_NewGeometry(RTCDevice device, enum RTCGeometryType type)
{
    calls.geometries++;
    calls.made++;
    return real.NewGeometry(device, type);
}

static void calls_ReleaseGeometry(RTCGeometry geometry)
{
    calls.geometries--;
    real.ReleaseGeometry(geometry);
}

static RTCBuffer calls_NewBuffer(RTCDevice device, size_t bytes)
{
    if (!calls_memory_is_there())
        return NULL;
    calls.buffers++;
    calls.made++;
    calls.bytes = bytes;
    return real.NewBuffer(device, bytes);
}

static void calls_ReleaseBuffer(RTCBuffer buffer)
{
    calls.buffers--;
    real.ReleaseBuffer(buffer);
}

static void *calls_GetBufferData(RTCBuffer buffer)
{
    return calls_memory_is_there() ? real.GetBufferData(buffer) : NULL;
}

static void *calls_SetNewGeometryBuffer(RTCGeometry geometry, enum RTCBufferType type,
                                        unsigned slot, enum RTCFormat format, size_t stride,
                                        size_t count)
{
    if (!calls_memory_is_there())
        return NULL;
    return real.SetNewGeometryBuffer(geometry, type, slot, format, stride, count);
}

static enum RTCError calls_GetDeviceError(RTCDevice device)
{
    enum RTCError error = real.GetDeviceError(device);
    return calls.error ? calls.error : error;
}

static ssize_t calls_GetDeviceProperty(RTCDevice device, enum RTCDeviceProperty which)
{
    if (which == RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED && calls.no_ray_masks)
        return 0;
    if (which == RTC_DEVICE_PROPERTY_VERSION_MAJOR && calls.version[0])
        return calls.version[0];
    if (which == RTC_DEVICE_PROPERTY_VERSION_MINOR && calls.version[1])
        return calls.version[1];
    if (which == RTC_DEVICE_PROPERTY_VERSION_PATCH && calls.version[2])
        return calls.version[2];
    return real.GetDeviceProperty(device, which);
}

/* --- what they are set to --------------------------------------------------------------------- */

static void calls_SetSceneFlags(RTCScene scene, enum RTCSceneFlags flags)
{
    calls.flags[((flags & RTC_SCENE_FLAG_ROBUST) ? 1 : 0) |
                ((flags & RTC_SCENE_FLAG_COMPACT) ? 2 : 0)]++;
    real.SetSceneFlags(scene, flags);
}

static void calls_SetSceneBuildQuality(RTCScene scene, enum RTCBuildQuality quality)
{
    calls.qualities[quality]++;
    real.SetSceneBuildQuality(scene, quality);
}

static void calls_SetGeometryIntersectFilterFunction(RTCGeometry geometry,
                                                     RTCFilterFunctionN filter)
{
    calls.filters[0]++;
    calls.filter = filter;
    real.SetGeometryIntersectFilterFunction(geometry, filter);
}

static void calls_SetGeometryOccludedFilterFunction(RTCGeometry geometry, RTCFilterFunctionN filter)
{
    calls.filters[1]++;
    real.SetGeometryOccludedFilterFunction(geometry, filter);
}

static void calls_SetGeometryMask(RTCGeometry geometry, unsigned mask)
{
    if (calls.masks < CALLS_MASKS)
        calls.mask[calls.masks++] = mask;
    real.SetGeometryMask(geometry, mask);
}

static void calls_CommitScene(RTCScene scene)
{
    real.CommitScene(scene);
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

static void calls_Intersect1(CALLS_CLOSEST)
{
    calls.closest++;
    calls.ray = query->ray;
    if (calls.answer)
        calls.answer(CALLS_CONTEXT, query);
    else
        real.Intersect1(CALLS_PASS(query));
}

static void calls_Occluded1(CALLS_ANY)
{
    calls.any++;
    calls.ray = *ray;
    if (!calls.answer)
        real.Occluded1(CALLS_PASS(ray));
}

static void calls_Intersect16(CALLS_CLOSEST16)
{
    calls.packets[0]++;
    memcpy(calls.valid, valid, sizeof calls.valid);
    calls.packet = query->ray;
    if (calls.answer16)
        calls.answer16(query);
    else
        real.Intersect16(valid, CALLS_PASS(query));
}

static void calls_Occluded16(CALLS_ANY16)
{
    calls.packets[1]++;
    memcpy(calls.valid, valid, sizeof calls.valid);
    calls.packet = *ray;
    real.Occluded16(valid, CALLS_PASS(ray));
}

#define CALLS_NARROW(W)                                                                            \
    static void calls_Intersect##W(CALLS_CLOSEST_OF(W))                                            \
    {                                                                                              \
        calls.of##W[0]++;                                                                          \
        memcpy(calls.valid, valid, W * sizeof *valid);                                             \
        real.Intersect##W(valid, CALLS_PASS(query));                                               \
    }                                                                                              \
    static void calls_Occluded##W(CALLS_ANY_OF(W))                                                 \
    {                                                                                              \
        calls.of##W[1]++;                                                                          \
        memcpy(calls.valid, valid, W * sizeof *valid);                                             \
        real.Occluded##W(valid, CALLS_PASS(ray));                                                  \
    }
CALLS_NARROW(4)
CALLS_NARROW(8)

/* --- in Embree's place ------------------------------------------------------------------------ */

#define CALLS_REPLACED(X)                                                                          \
    X(NewDevice)                                                                                   \
    X(ReleaseDevice)                                                                               \
    X(NewScene)                                                                                    \
    X(ReleaseScene)                                                                                \
    X(NewGeometry)                                                                                 \
    X(ReleaseGeometry)                                                                             \
    X(NewBuffer)                                                                                   \
    X(ReleaseBuffer)                                                                               \
    X(GetBufferData)                                                                               \
    X(SetNewGeometryBuffer)                                                                        \
    X(GetDeviceError)                                                                              \
    X(GetDeviceProperty)                                                                           \
    X(SetSceneFlags)                                                                               \
    X(SetSceneBuildQuality)                                                                        \
    X(SetGeometryIntersectFilterFunction)                                                          \
    X(SetGeometryOccludedFilterFunction)                                                           \
    X(SetGeometryMask)                                                                             \
    X(CommitScene)                                                                                 \
    X(Intersect1)                                                                                  \
    X(Occluded1)                                                                                   \
    X(Intersect16)                                                                                 \
    X(Occluded16)                                                                                  \
    X(Intersect4)                                                                                  \
    X(Occluded4)                                                                                   \
    X(Intersect8)                                                                                  \
    X(Occluded8)

/* Puts them in place of Embree's. False, with the reason, where Embree cannot run. */
static bool calls_can_run(void)
{
    struct reason reason;
    if (embree_load(&reason)) {
        printf("SKIP %s\n", reason.text);
        return false;
    }
    real = rtc;
#define CALLS_REPLACE(name) rtc.name = calls_##name;
    CALLS_REPLACED(CALLS_REPLACE)
#undef CALLS_REPLACE
    RTCDevice device = real.NewDevice("threads=1");
    if (device)
        real.ReleaseDevice(device);
    else
        puts("SKIP Embree has no device for this processor");
    return device;
}

#endif
