/* What the files of Embree's engines share, for them only. */
#ifndef EMBREE_INNER_H
#define EMBREE_INNER_H

#include "ref/engines/embree_device.h"
#include "ref/engines/embree_library.h"

#include <stdatomic.h>

#if HAVE_EMBREE == 4
typedef struct RTCRayQueryContext embree_context;
#else
typedef struct RTCIntersectContext embree_context;
#endif

struct embree_world; /* embree_worlds.c */

struct embree {
    RTCDevice device;
    RTCScene scene;             /* of the last prepare; else NULL */
    struct embree_world *world; /* of the last prepare_world; else NULL */
    struct embree_mode mode;
    bool unguarded;
    bool masks; /* the library was built with masks of rays */
    unsigned threads;
    enum query query;
    void *rays; /* the structures of a batch of rays (embree_rays.c), or NULL */
    size_t rays_bytes;
    atomic_llong bytes; /* currently allocated by Embree */
};

/* Rays whose origin or direction reaches this are out of contract: Embree asserts from 1.844e18
 * on. */
#define EMBREE_MOST 1e18f

#define EMBREE_BATCH ((size_t)1 << 17) /* rays filled at once */

/* Makes room in `rays` for the structures of so many rays, or of a batch. Errors:
 * STATUS_MEMORY. */
enum status embree_room(struct embree *embree, size_t rays, struct reason *reason) MUST_USE;

/* Traces the first `count` structures of `rays` through a scene, and adds the time to the
 * report. */
void embree_time_spans(const struct embree *embree, RTCScene scene, size_t count,
                       struct trace_report *report);

/* Packets of mode.packet rays in `rays`, of which embree_packet_bytes gives the bytes of `count`
 * rays: filled with rays, traced from the first-th ray on, read. Lanes beyond the last ray, and
 * lanes of rays that embree_takes rejects, are switched off. */
size_t embree_packet_bytes(const struct embree *embree, size_t count);
void embree_packets_fill(const struct embree *embree, const struct ray *ray, size_t count);
void embree_packets_trace(const struct embree *embree, RTCScene scene, size_t first, size_t count);
void embree_packets_read(const struct embree *embree, size_t count, struct hit *hit);

/* Lists the hits of `count` rays, at most a packet of them, as engine.trace_all does. */
void embree_packet_list(const struct embree *embree, const struct ray *ray, size_t count,
                        uint32_t capacity, struct hit *hit, uint32_t *hit_count);

/* The lists of QUERY_ALL: the context that Embree passes to the filter, and where the list of the
 * ray with id i is. */
struct embree_lists {
    embree_context context; /* first: Embree passes its address to the filter */
    struct hit *hit;        /* capacity of each ray */
    uint32_t capacity;
    uint32_t *found; /* of each ray */
    bool twice;      /* a triangle may be met twice: one that is listed is not listed again */
};

/* Adds each hit to its ray's list and rejects it, so that the ray keeps its length and is traced
 * on. */
void embree_list_filter(const struct RTCFilterFunctionNArguments *args);

/* Takes the device's error. Returns STATUS_OK if there is none. */
enum status embree_error(struct embree *embree, const char *doing, struct reason *reason) MUST_USE;

/* Makes an empty scene with the mode's flags; the caller releases it. */
RTCScene embree_scene(const struct embree *embree);

/* Builds a scene and leaves this thread's handling of subnormals as it was. Errors: as
 * embree_error. */
enum status embree_commit(struct embree *embree, RTCScene scene, struct reason *reason) MUST_USE;

/* True if Embree survives the ray in a scene, or need not. */
bool embree_takes(const struct embree *embree, const struct ray *ray);

/* The ray as Embree reads it, with no hit yet. */
struct RTCRayHit embree_query(const struct ray *ray);

/* Makes a context of rays, with no filter. */
void embree_start(embree_context *context);

/* Traces one ray with the caller's context. */
void embree_intersect(RTCScene scene, embree_context *context, struct RTCRayHit *query);

/* Whether anything blocks the ray. */
bool embree_occluded(RTCScene scene, embree_context *context, struct RTCRay *ray);

/* Frees what prepare and prepare_world made. */
void embree_drop(struct embree *embree);

/* Frees the world of an engine; NULL is fine. */
void embree_world_free(struct embree_world *world);

#endif
