/* All hits of many rays in bounded memory: calls an engine's trace_all or trace_world_all with
 * little room per ray, then again with enough for the rays whose hits did not fit. */
#ifndef ALL_HITS_H
#define ALL_HITS_H

#include "ref/engine.h"

#define ALL_HITS_RAYS 16384u     /* most rays of one call */
#define ALL_HITS_MOST (1u << 22) /* most hits of one call, 64 MiB; a ray alone may have more */

/* Owns its arrays; zero it before the first call, use it again for the next. */
struct all_hits {
    bool once;     /* set it for a split tree (packed.split): a triangle that a ray finds several
                      times is listed once; the hits are then sorted as by all_hits_sort */
    size_t done;   /* rays of the last call */
    size_t *first; /* ray i's hits are hit[first[i] .. first[i + 1] - 1], in the engine's order */
    struct hit *hit;
    uint32_t *tag; /* of a world: of each hit; else unused */
    size_t again;  /* rays that were traced twice because they had more hits than room */
    struct hit *scratch;
    uint32_t *scratch_tag;
    uint32_t *count;
    struct ray *retry; /* rays traced again, what they may meet, and which they are */
    struct ray_mode *retry_mode;
    size_t *retry_of;
    size_t first_capacity, hit_capacity, tag_capacity, scratch_capacity, scratch_tag_capacity,
        count_capacity, retry_capacity, retry_mode_capacity, retry_of_capacity;
};

/* Finds all hits of the first rays of `ray`, at least one and as many as the limits above allow;
 * the caller continues after the first out->done. `self` was prepared with QUERY_ALL and ray_count
 * is not 0. Errors: STATUS_UNSUPPORTED the engine has no trace_all; those of trace_all;
 * STATUS_DEVICE also if a ray's second tracing found another number of hits than its first;
 * STATUS_MEMORY. */
enum status all_hits_next(const struct engine *engine, void *self, const struct ray *ray,
                          size_t ray_count, struct all_hits *out, struct reason *reason) MUST_USE;

/* The same in a world: `self` was prepared by prepare_world, mode[i] belongs to ray[i]; NULL:
 * ray_mode_all() for each. out->tag[k] belongs to out->hit[k]. Errors: those above, of
 * trace_world_all; STATUS_UNSUPPORTED also an engine that traces no worlds. */
enum status all_hits_next_world(const struct engine *engine, void *self, const struct ray *ray,
                                const struct ray_mode *mode, size_t ray_count, struct all_hits *out,
                                struct reason *reason) MUST_USE;
void all_hits_free(struct all_hits *all); /* a zero one is fine */

/* Sorts by t, then by prim: the order in which all hits are shown. */
void all_hits_sort(struct hit *hit, size_t count);

/* The same; tag[i] stays with hit[i]. Those of equal t and prim are sorted by the bits of u, v and
 * tag, so that equal ones become neighbours. */
void all_hits_sort_tagged(struct hit *hit, uint32_t *tag, size_t count);

#endif
