/* Rays of scenes through Embree as its own users trace them: its ray structures are filled before
 * the tracing is timed, and read behind it. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_inner.h"

#include <stdlib.h>

#define SPAN 64u /* rays that a thread takes at once */

/* Embree's packets are aligned to this. */
#define ALIGNED 64u

/* --- single rays ------------------------------------------------------------------------------ */

/* Fills in the rays that embree_takes; returns their number. */
static size_t fill_singles(const struct embree *embree, const struct ray *ray, size_t count)
{
    struct RTCRayHit *closest = embree->rays;
    struct RTCRay *any = embree->rays;
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        if (!embree_takes(embree, &ray[i]))
            continue;
        if (embree->query == QUERY_ANY)
            any[taken++] = embree_query(&ray[i]).ray;
        else
            closest[taken++] = embree_query(&ray[i]);
    }
    return taken;
}

static void closest_span(RTCScene scene, struct RTCRayHit *ray, size_t count)
{
    embree_context context;
    embree_start(&context);
#if HAVE_EMBREE == 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    for (size_t i = 0; i < count; i++)
        rtc.Intersect1(scene, &ray[i], &arguments);
#else
    for (size_t i = 0; i < count; i++)
        rtc.Intersect1(scene, &context, &ray[i]);
#endif
}

static void any_span(RTCScene scene, struct RTCRay *ray, size_t count)
{
    embree_context context;
    embree_start(&context);
#if HAVE_EMBREE == 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    for (size_t i = 0; i < count; i++)
        rtc.Occluded1(scene, &ray[i], &arguments);
#else
    for (size_t i = 0; i < count; i++)
        rtc.Occluded1(scene, &context, &ray[i]);
#endif
}

/* Embree does not return what blocked a ray, so a hit of QUERY_ANY is triangle 0 at t = 0. */
static void read_singles(const struct embree *embree, const struct ray *ray, size_t count,
                         struct hit *hit)
{
    const struct RTCRayHit *closest = embree->rays;
    const struct RTCRay *any = embree->rays;
    for (size_t i = 0; i < count; i++) {
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        if (!embree_takes(embree, &ray[i]))
            continue;
        if (embree->query == QUERY_ANY) {
            hit[i].prim = any++->tfar < 0.0f ? 0 : ABI_NO_PRIM;
            continue;
        }
        if (closest->hit.geomID != RTC_INVALID_GEOMETRY_ID)
            hit[i] = (struct hit){closest->ray.tfar, closest->hit.u, closest->hit.v,
                                  closest->hit.primID};
        closest++;
    }
}

/* --- batches ---------------------------------------------------------------------------------- */

static void trace_span(const struct embree *embree, RTCScene scene, size_t first, size_t count)
{
    if (embree->mode.packet)
        embree_packets_trace(embree, scene, first, count);
    else if (embree->query == QUERY_ANY)
        any_span(scene, (struct RTCRay *)embree->rays + first, count);
    else
        closest_span(scene, (struct RTCRayHit *)embree->rays + first, count);
}

void embree_time_spans(const struct embree *embree, RTCScene scene, size_t count,
                       struct trace_report *report)
{
    const uint64_t start = time_ns(), core = core_time_ns();
#pragma omp parallel for schedule(dynamic) num_threads(embree->threads) if (count > SPAN)
    for (long long i = 0; i < (long long)count; i += SPAN)
        trace_span(embree, scene, (size_t)i, count - (size_t)i < SPAN ? count - (size_t)i : SPAN);
    report->core_ns += core_time_ns() - core;
    report->ns += time_ns() - start;
}

static void trace_batch(struct embree *embree, const struct ray *ray, size_t count, struct hit *hit,
                        struct trace_report *report)
{
    size_t traced = count;
    if (embree->mode.packet)
        embree_packets_fill(embree, ray, count);
    else
        traced = fill_singles(embree, ray, count);
    embree_time_spans(embree, embree->scene, traced, report);
    if (embree->mode.packet)
        embree_packets_read(embree, count, hit);
    else
        read_singles(embree, ray, count, hit);
}

enum status embree_room(struct embree *embree, size_t rays, struct reason *reason)
{
    const size_t count = rays < EMBREE_BATCH ? rays : EMBREE_BATCH;
    const size_t bytes =
        embree->mode.packet ? embree_packet_bytes(embree, count) : count * sizeof(struct RTCRayHit);
    if (embree->rays_bytes >= bytes)
        return STATUS_OK;
    free(embree->rays);
    embree->rays_bytes = (bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
    embree->rays = aligned_alloc(ALIGNED, embree->rays_bytes);
    if (embree->rays)
        return STATUS_OK;
    embree->rays_bytes = 0;
    return fail(reason, STATUS_MEMORY, "Embree: no memory for %zu rays", count);
}

enum status embree_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct embree *embree = self;
    *report = (struct trace_report){.memory_bytes = (uint64_t)atomic_load(&embree->bytes)};
    enum status status = embree_room(embree, ray_count, reason);
    for (size_t first = 0; first < ray_count && !status; first += EMBREE_BATCH) {
        const size_t left = ray_count - first;
        const size_t part = left < EMBREE_BATCH ? left : EMBREE_BATCH;
        trace_batch(embree, ray + first, part, hit + first, report);
    }
    return status ? status : embree_error(embree, "tracing", reason);
}

#endif
