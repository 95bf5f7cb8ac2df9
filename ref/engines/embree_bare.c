/* Worlds in Embree without any test of candidates, as a race traces them. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_world_inner.h"

/* Fills in the rays that Embree is asked; returns their number. */
static size_t fill(const struct embree *embree, const struct ray *ray, size_t count)
{
    struct RTCRayHit *closest = embree->rays;
    struct RTCRay *any = embree->rays;
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        struct RTCRayHit query = embree_query(&ray[i]);
        query.ray.mask = embree_mask_for(embree, &ray[i], ray_mode_all());
        if (!query.ray.mask)
            continue;
        if (embree->query == QUERY_ANY)
            any[taken++] = query.ray;
        else
            closest[taken++] = query;
    }
    return taken;
}

/* Embree does not return what blocked a ray, so a hit of QUERY_ANY is triangle 0 at t = 0. */
static void read(const struct embree *embree, const struct ray *ray, size_t count, struct hit *hit,
                 uint32_t *tag)
{
    struct RTCRayHit *closest = embree->rays;
    const struct RTCRay *any = embree->rays;
    for (size_t i = 0; i < count; i++) {
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        tag[i] = 0;
        if (!embree_mask_for(embree, &ray[i], ray_mode_all()))
            continue;
        if (embree->query == QUERY_ANY) {
            hit[i].prim = any++->tfar < 0.0f ? 0 : ABI_NO_PRIM;
            continue;
        }
        if (closest->hit.geomID != RTC_INVALID_GEOMETRY_ID)
            embree_read_hit(embree->world, closest, &hit[i], &tag[i]);
        closest++;
    }
}

enum status embree_trace_bare(struct embree *embree, const struct ray *ray, size_t count,
                              struct hit *hit, uint32_t *tag, struct trace_report *report,
                              struct reason *reason)
{
    *report = (struct trace_report){.memory_bytes = (uint64_t)atomic_load(&embree->bytes)};
    enum status status = embree_room(embree, count, reason);
    for (size_t first = 0; first < count && !status; first += EMBREE_BATCH) {
        const size_t left = count - first, part = left < EMBREE_BATCH ? left : EMBREE_BATCH;
        const size_t taken = fill(embree, ray + first, part);
        embree_time_spans(embree, embree->world->top, taken, report);
        read(embree, ray + first, part, hit + first, tag + first);
    }
    return status ? status : embree_error(embree, "tracing", reason);
}

#endif
