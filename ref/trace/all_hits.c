#include "ref/trace/all_hits.h"

#include "ref/abi_world.h"

#include <stdlib.h>
#include <string.h>

/* Room a ray at first. */
#define ROOM 8u

static enum status reserve(void **array, size_t *capacity, size_t need, size_t size,
                           struct reason *reason)
{
    if (array_reserve(array, capacity, need, size))
        return fail(reason, STATUS_MEMORY, "no memory for %zu hits", need);
    return STATUS_OK;
}

#define RESERVE(array, capacity, need, reason)                                                     \
    reserve((void **)&(array), &(capacity), (need), sizeof *(array), (reason))

/* What is asked: rays of a scene or of a world. */
struct listed_by {
    const struct engine *engine;
    void *self;
    const struct ray_mode *mode; /* of a world: one per ray, or NULL */
    bool world;
};

/* Lists into all->scratch; modes and tags of a world alone. */
static enum status list(const struct listed_by *q, const struct ray *ray,
                        const struct ray_mode *mode, size_t rays, uint32_t room, uint32_t *count,
                        struct all_hits *all, struct reason *reason)
{
    enum status status = RESERVE(all->scratch, all->scratch_capacity, rays * (size_t)room, reason);
    if (!status && q->world)
        status = RESERVE(all->scratch_tag, all->scratch_tag_capacity, rays * (size_t)room, reason);
    if (status)
        return status;
    if (!q->world)
        return q->engine->trace_all(q->self, ray, rays, room, all->scratch, count, reason);
    return q->engine->worlds->trace_world_all(q->self, ray, mode, rays, room, all->scratch,
                                              all->scratch_tag, count, reason);
}

/* Puts the hits of ray i in place, from `from` of the scratch on. */
static void place_one(const struct listed_by *q, size_t i, size_t from, struct all_hits *all)
{
    memcpy(all->hit + all->first[i], all->scratch + from, all->count[i] * sizeof *all->hit);
    if (q->world)
        memcpy(all->tag + all->first[i], all->scratch_tag + from, all->count[i] * sizeof *all->tag);
}

/* Rays whose hits all fit together, from the counts of `rays` rays; at least one. */
static size_t rays_that_fit(const uint32_t *count, size_t rays)
{
    size_t total = 0, fit = 0;
    while (fit < rays && (fit == 0 || total + count[fit] <= ALL_HITS_MOST))
        total += count[fit++];
    return fit;
}

/* Traces the rays retry_of[from .. to - 1] with room for `room` hits each, and puts their hits in
 * place. */
static enum status retry_some(const struct listed_by *q, size_t from, size_t to, uint32_t room,
                              struct all_hits *all, struct reason *reason)
{
    size_t rays = to - from;
    uint32_t *count = all->count + ALL_HITS_RAYS; /* the second half, for second counts */
    enum status status = list(q, all->retry + from, q->mode ? all->retry_mode + from : NULL, rays,
                              room, count, all, reason);
    for (size_t k = 0; k < rays && !status; k++) {
        size_t i = all->retry_of[from + k];
        if (count[k] != all->count[i])
            status = fail(reason, STATUS_DEVICE, "%s: a ray hit %u triangles, traced again %u",
                          q->engine->name, (unsigned)all->count[i], (unsigned)count[k]);
        else
            place_one(q, i, k * room, all);
    }
    return status;
}

/* Traces again, in groups that fit, the rays that had more than ROOM hits. */
static enum status retry_all(const struct listed_by *q, size_t retries, struct all_hits *all,
                             struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t from = 0, to = 0; from < retries && !status; from = to) {
        uint32_t room = 0;
        while (to < retries) {
            uint32_t need = all->count[all->retry_of[to]];
            need = need > room ? need : room;
            if (to > from && (to - from + 1) * (size_t)need > ALL_HITS_MOST)
                break;
            room = need;
            to++;
        }
        status = retry_some(q, from, to, room, all, reason);
    }
    return status;
}

/* Puts the hits of rays with at most ROOM in place and lists the others; returns how many. */
static size_t place_hits(const struct listed_by *q, const struct ray *ray, struct all_hits *all)
{
    size_t retries = 0;
    for (size_t i = 0; i < all->done; i++) {
        if (all->count[i] <= ROOM) {
            place_one(q, i, i * ROOM, all);
            continue;
        }
        all->retry[retries] = ray[i];
        if (q->mode)
            all->retry_mode[retries] = q->mode[i];
        all->retry_of[retries++] = i;
    }
    return retries;
}

/* Keeps one of equal hits of each ray. A triangle is tested by the same operations wherever it is
 * listed; hits of one triangle that nevertheless differ in a bit or in their tags are kept. */
static void remove_repeats(const struct listed_by *q, struct all_hits *all)
{
    size_t kept = 0;
    for (size_t i = 0; i < all->done; i++) {
        struct hit *hit = all->hit + all->first[i];
        uint32_t *tag = q->world ? all->tag + all->first[i] : NULL;
        size_t count = all->first[i + 1] - all->first[i];
        if (tag)
            all_hits_sort_tagged(hit, tag, count);
        else
            all_hits_sort(hit, count);
        all->first[i] = kept;
        for (size_t k = 0; k < count; k++) {
            bool repeat = k > 0 && memcmp(&all->hit[kept - 1], &hit[k], sizeof *hit) == 0;
            if (repeat && (!tag || all->tag[kept - 1] == tag[k]))
                continue;
            if (tag)
                all->tag[kept] = tag[k];
            all->hit[kept++] = hit[k];
        }
    }
    all->first[all->done] = kept;
}

static enum status reserve_rays(const struct listed_by *q, size_t rays, struct all_hits *out,
                                struct reason *reason)
{
    enum status status =
        RESERVE(out->count, out->count_capacity, 2 * (size_t)ALL_HITS_RAYS, reason);
    if (!status)
        status = RESERVE(out->first, out->first_capacity, rays + 1, reason);
    if (!status)
        status = RESERVE(out->retry, out->retry_capacity, rays, reason);
    if (!status && q->mode)
        status = RESERVE(out->retry_mode, out->retry_mode_capacity, rays, reason);
    if (!status)
        status = RESERVE(out->retry_of, out->retry_of_capacity, rays, reason);
    return status;
}

static enum status next(const struct listed_by *q, const struct ray *ray, size_t ray_count,
                        struct all_hits *out, struct reason *reason)
{
    size_t rays = ray_count < ALL_HITS_RAYS ? ray_count : ALL_HITS_RAYS;
    enum status status = reserve_rays(q, rays, out, reason);
    if (!status)
        status = list(q, ray, q->mode, rays, ROOM, out->count, out, reason);
    if (status)
        return status;
    out->done = rays_that_fit(out->count, rays);
    out->first[0] = 0;
    for (size_t i = 0; i < out->done; i++)
        out->first[i + 1] = out->first[i] + out->count[i];
    status = RESERVE(out->hit, out->hit_capacity, out->first[out->done] + 1, reason);
    if (!status && q->world)
        status = RESERVE(out->tag, out->tag_capacity, out->first[out->done] + 1, reason);
    if (!status) {
        size_t retries = place_hits(q, ray, out);
        out->again += retries;
        status = retry_all(q, retries, out, reason);
    }
    if (status)
        out->done = 0;
    else if (out->once)
        remove_repeats(q, out);
    return status;
}

enum status all_hits_next(const struct engine *engine, void *self, const struct ray *ray,
                          size_t ray_count, struct all_hits *out, struct reason *reason)
{
    const struct listed_by q = {.engine = engine, .self = self};
    out->done = 0;
    if (!engine->trace_all)
        return fail(reason, STATUS_UNSUPPORTED, "%s cannot list all hits", engine->name);
    return next(&q, ray, ray_count, out, reason);
}

enum status all_hits_next_world(const struct engine *engine, void *self, const struct ray *ray,
                                const struct ray_mode *mode, size_t ray_count, struct all_hits *out,
                                struct reason *reason)
{
    const struct listed_by q = {.engine = engine, .self = self, .mode = mode, .world = true};
    out->done = 0;
    if (!engine->worlds)
        return fail(reason, STATUS_UNSUPPORTED, "%s traces scenes, not worlds", engine->name);
    if (!engine->worlds->trace_world_all)
        return fail(reason, STATUS_UNSUPPORTED, "%s cannot list all hits of a world", engine->name);
    return next(&q, ray, ray_count, out, reason);
}

void all_hits_free(struct all_hits *all)
{
    free(all->first);
    free(all->hit);
    free(all->tag);
    free(all->scratch);
    free(all->scratch_tag);
    free(all->count);
    free(all->retry);
    free(all->retry_mode);
    free(all->retry_of);
    *all = (struct all_hits){0};
}

static int by_distance(const void *left, const void *right)
{
    const struct hit *a = left, *b = right;
    int order = order_doubles((double)a->t, (double)b->t);
    return order ? order : order_numbers(a->prim, b->prim);
}

void all_hits_sort(struct hit *hit, size_t count)
{
    qsort(hit, count, sizeof *hit, by_distance);
}

/* --- with tags -------------------------------------------------------------------------------- */

static int by_all(const struct hit *a, uint32_t a_tag, const struct hit *b, uint32_t b_tag)
{
    int order = by_distance(a, b);
    order = order ? order : order_numbers(float_bits(a->t), float_bits(b->t)); /* zeros */
    order = order ? order : order_numbers(float_bits(a->u), float_bits(b->u));
    order = order ? order : order_numbers(float_bits(a->v), float_bits(b->v));
    return order ? order : order_numbers(a_tag, b_tag);
}

static void exchange(struct hit *hit, uint32_t *tag, size_t i, size_t k)
{
    struct hit one = hit[i];
    uint32_t its = tag[i];
    hit[i] = hit[k];
    tag[i] = tag[k];
    hit[k] = one;
    tag[k] = its;
}

/* Lets the entry `at` of a heap, the largest on top, sink to where it belongs. */
static void sink(struct hit *hit, uint32_t *tag, size_t at, size_t count)
{
    for (size_t child = 2 * at + 1; child < count; at = child, child = 2 * at + 1) {
        if (child + 1 < count &&
            by_all(&hit[child], tag[child], &hit[child + 1], tag[child + 1]) < 0)
            child++;
        if (by_all(&hit[at], tag[at], &hit[child], tag[child]) >= 0)
            return;
        exchange(hit, tag, at, child);
    }
}

/* A heap sort, since qsort moves one array alone. */
void all_hits_sort_tagged(struct hit *hit, uint32_t *tag, size_t count)
{
    for (size_t i = count / 2; i > 0; i--) /* those behind have nothing below them */
        sink(hit, tag, i - 1, count);
    for (size_t end = count; end > 1; end--) {
        exchange(hit, tag, 0, end - 1);
        sink(hit, tag, 0, end - 1);
    }
}
