/* Rays of scenes through Embree in packets of 4, 8 or 16. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_inner.h"

#include <stddef.h>

#define ALIGNED 64u /* at least what Embree wants of packets of 16 */

/* A packet of any width, with its valid lanes. Narrow ones in a row end before the widest does. */
struct embree_packet {
    _Alignas(ALIGNED) int valid[EMBREE_PACKET_MOST];
    union {
        _Alignas(ALIGNED) struct RTCRayHit4 of4;
        _Alignas(ALIGNED) struct RTCRayHit8 of8;
        _Alignas(ALIGNED) struct RTCRayHit16 of16;
    } rays;
};

/* --- what Embree is called with, by width ----------------------------------------------------- */

#if HAVE_EMBREE == 4
#define CALLS(W)                                                                                   \
    static void closest_##W(struct embree_packet *p, RTCScene scene, embree_context *context)      \
    {                                                                                              \
        struct RTCIntersectArguments arguments;                                                    \
        rtcInitIntersectArguments(&arguments);                                                     \
        arguments.context = context;                                                               \
        rtc.Intersect##W(p->valid, scene, &p->rays.of##W, &arguments);                             \
    }                                                                                              \
    static void any_##W(struct embree_packet *p, RTCScene scene, embree_context *context)          \
    {                                                                                              \
        struct RTCOccludedArguments arguments;                                                     \
        rtcInitOccludedArguments(&arguments);                                                      \
        arguments.context = context;                                                               \
        rtc.Occluded##W(p->valid, scene, &p->rays.of##W.ray, &arguments);                          \
    }
#else
#define CALLS(W)                                                                                   \
    static void closest_##W(struct embree_packet *p, RTCScene scene, embree_context *context)      \
    {                                                                                              \
        rtc.Intersect##W(p->valid, scene, context, &p->rays.of##W);                                \
    }                                                                                              \
    static void any_##W(struct embree_packet *p, RTCScene scene, embree_context *context)          \
    {                                                                                              \
        rtc.Occluded##W(p->valid, scene, context, &p->rays.of##W.ray);                             \
    }
#endif

/* Writes a ray to lane `i`, and reads what became of it. Embree does not return what blocked a ray,
 * so a hit of QUERY_ANY is triangle 0 at t = 0. */
#define LANES(W)                                                                                   \
    static void fill_##W(struct embree_packet *p, const struct ray *ray, unsigned i)               \
    {                                                                                              \
        struct RTCRay##W *to = &p->rays.of##W.ray;                                                 \
        to->org_x[i] = ray->org[0];                                                                \
        to->org_y[i] = ray->org[1];                                                                \
        to->org_z[i] = ray->org[2];                                                                \
        to->tnear[i] = ray->tmin;                                                                  \
        to->dir_x[i] = ray->dir[0];                                                                \
        to->dir_y[i] = ray->dir[1];                                                                \
        to->dir_z[i] = ray->dir[2];                                                                \
        to->time[i] = 0;                                                                           \
        to->tfar[i] = ray->tmax;                                                                   \
        to->mask[i] = 0xFFFFFFFFu;                                                                 \
        to->id[i] = i;                                                                             \
        to->flags[i] = 0;                                                                          \
        p->rays.of##W.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;                                     \
        p->rays.of##W.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;                                     \
    }                                                                                              \
    static void read_##W(const struct embree_packet *p, bool any, unsigned i, struct hit *out)     \
    {                                                                                              \
        const struct RTCRayHit##W *from = &p->rays.of##W;                                          \
        if (any)                                                                                   \
            out->prim = from->ray.tfar[i] < 0.0f ? 0 : ABI_NO_PRIM;                                \
        else if (from->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)                                   \
            *out = (struct hit){from->ray.tfar[i], from->hit.u[i], from->hit.v[i],                 \
                                from->hit.primID[i]};                                              \
    }

CALLS(4)
CALLS(8)
CALLS(16)
LANES(4)
LANES(8)
LANES(16)

static const struct form {
    void (*closest)(struct embree_packet *p, RTCScene scene, embree_context *context);
    void (*any)(struct embree_packet *p, RTCScene scene, embree_context *context);
    void (*fill)(struct embree_packet *p, const struct ray *ray, unsigned i);
    void (*read)(const struct embree_packet *p, bool any, unsigned i, struct hit *out);
    size_t bytes; /* of the rays */
} forms[] = {{closest_4, any_4, fill_4, read_4, sizeof(struct RTCRayHit4)},
             {closest_8, any_8, fill_8, read_8, sizeof(struct RTCRayHit8)},
             {closest_16, any_16, fill_16, read_16, sizeof(struct RTCRayHit16)}};

static const struct form *form_of(const struct embree *embree)
{
    return &forms[embree->mode.packet == 4 ? 0 : embree->mode.packet == 8 ? 1 : 2];
}

/* --- rays ------------------------------------------------------------------------------------- */

/* From a packet to the next. */
static size_t stride_of(const struct embree *embree)
{
    return offsetof(struct embree_packet, rays) +
           (form_of(embree)->bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
}

size_t embree_packet_bytes(const struct embree *embree, size_t count)
{
    const size_t wide = embree->mode.packet;
    return (count + wide - 1) / wide * stride_of(embree);
}

static struct embree_packet *packet_at(const struct embree *embree, size_t i)
{
    return (struct embree_packet *)((char *)embree->rays + i * stride_of(embree));
}

/* Fills one packet; `count` may be less than its width. */
static void fill(const struct embree *embree, struct embree_packet *packet, const struct ray *ray,
                 size_t count)
{
    const struct ray nothing = {.dir = {0, 0, 1}};
    const struct form *form = form_of(embree);
    for (unsigned i = 0; i < embree->mode.packet; i++) {
        const bool on = i < count && embree_takes(embree, &ray[i]);
        packet->valid[i] = on ? -1 : 0;
        form->fill(packet, on ? &ray[i] : &nothing, i);
    }
}

void embree_packets_fill(const struct embree *embree, const struct ray *ray, size_t count)
{
    const size_t wide = embree->mode.packet;
    for (size_t i = 0; i < count; i += wide)
        fill(embree, packet_at(embree, i / wide), ray + i, count - i);
}

void embree_packets_trace(const struct embree *embree, RTCScene scene, size_t first, size_t count)
{
    const size_t wide = embree->mode.packet;
    const struct form *form = form_of(embree);
    embree_context context;
    embree_start(&context);
    for (size_t i = first; i < first + count; i += wide)
        if (embree->query == QUERY_ANY)
            form->any(packet_at(embree, i / wide), scene, &context);
        else
            form->closest(packet_at(embree, i / wide), scene, &context);
}

void embree_packets_read(const struct embree *embree, size_t count, struct hit *hit)
{
    const size_t wide = embree->mode.packet;
    const struct form *form = form_of(embree);
    for (size_t i = 0; i < count; i++) {
        const struct embree_packet *from = packet_at(embree, i / wide);
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        if (from->valid[i % wide])
            form->read(from, embree->query == QUERY_ANY, (unsigned)(i % wide), &hit[i]);
    }
}

void embree_packet_list(const struct embree *embree, const struct ray *ray, size_t count,
                        uint32_t capacity, struct hit *hit, uint32_t *hit_count)
{
    struct embree_packet packet;
    struct embree_lists lists = {.hit = hit,
                                 .capacity = capacity,
                                 .found = hit_count,
                                 .twice = embree->mode.quality == EMBREE_HIGH};
    for (size_t i = 0; i < count; i++)
        hit_count[i] = 0;
    embree_start(&lists.context);
    fill(embree, &packet, ray, count);
    form_of(embree)->closest(&packet, embree->scene, &lists.context);
}

#endif
