/* Embree's shared library, which is opened when an engine of it is: a process that uses none does
 * not load it. The one header of the library that includes Embree's. */
#ifndef EMBREE_LIBRARY_H
#define EMBREE_LIBRARY_H

#include "ref/engine.h"

#if HAVE_EMBREE == 4
#include <embree4/rtcore.h>
#define EMBREE_LIBRARY "libembree4.so.4"
#else
#include <embree3/rtcore.h>
#define EMBREE_LIBRARY "libembree3.so.3"
#endif

/* Every function of it that is called, without "rtc". */
#define EMBREE_FUNCTIONS(X)                                                                        \
    X(AttachGeometry)                                                                              \
    X(AttachGeometryByID)                                                                          \
    X(CommitGeometry)                                                                              \
    X(CommitScene)                                                                                 \
    X(DetachGeometry)                                                                              \
    X(GetBufferData)                                                                               \
    X(GetDeviceError)                                                                              \
    X(GetDeviceProperty)                                                                           \
    X(GetGeometry)                                                                                 \
    X(GetGeometryBufferData)                                                                       \
    X(Intersect1)                                                                                  \
    X(Intersect4)                                                                                  \
    X(Intersect8)                                                                                  \
    X(Intersect16)                                                                                 \
    X(NewBuffer)                                                                                   \
    X(NewDevice)                                                                                   \
    X(NewGeometry)                                                                                 \
    X(NewScene)                                                                                    \
    X(Occluded1)                                                                                   \
    X(Occluded4)                                                                                   \
    X(Occluded8)                                                                                   \
    X(Occluded16)                                                                                  \
    X(ReleaseBuffer)                                                                               \
    X(ReleaseDevice)                                                                               \
    X(ReleaseGeometry)                                                                             \
    X(ReleaseScene)                                                                                \
    X(SetDeviceMemoryMonitorFunction)                                                              \
    X(SetGeometryBuffer)                                                                           \
    X(SetGeometryBuildQuality)                                                                     \
    X(SetGeometryInstancedScene)                                                                   \
    X(SetGeometryIntersectFilterFunction)                                                          \
    X(SetGeometryMask)                                                                             \
    X(SetGeometryOccludedFilterFunction)                                                           \
    X(SetGeometryTransform)                                                                        \
    X(SetNewGeometryBuffer)                                                                        \
    X(SetSceneBuildQuality)                                                                        \
    X(SetSceneFlags)                                                                               \
    X(UpdateGeometryBuffer)

struct embree_functions {
#define EMBREE_MEMBER(name) __typeof__(rtc##name) *name;
    EMBREE_FUNCTIONS(EMBREE_MEMBER)
#undef EMBREE_MEMBER
};

/* rtc.NewDevice is rtcNewDevice. All are NULL before embree_load() has returned STATUS_OK; then
 * only tests change them. */
extern struct embree_functions rtc;

/* Opens the library: that in EMBREE_FOLDER, where a build has one; else the system's. It stays open
 * until the process ends, and so does the answer: later calls return it again. Any thread may call.
 * Errors: STATUS_UNSUPPORTED it cannot be opened, or lacks a function; the reason names it. */
enum status embree_load(struct reason *reason) MUST_USE;

#endif
