#include "ref/trace/all_hits.h"

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
static enum status retry_some(const struct engine *engine, void *self, size_t from, size_t to,
                              uint32_t room, struct all_hits *all, struct reason *reason)
{
    size_t rays = to - from;
    enum status status = RESERVE(all->scratch, all->scratch_capacity, rays * (size_t)room, reason);
    uint32_t *count = all->count + ALL_HITS_RAYS; /* the second half, for second counts */
    if (!status)
        status =
            engine->trace_all(self, all->retry + from, rays, room, all->scratch, count, reason);
    for (size_t k = 0; k < rays && !status; k++) {
        size_t i = all->retry_of[from + k];
        if (count[k] != all->count[i])
            status = fail(reason, STATUS_DEVICE, "%s: a ray hit %u triangles, traced again %u",
                          engine->name, (unsigned)all->count[i], (unsigned)count[k]);
        else
            memcpy(all->hit + all->first[i], all->scratch + k * room, count[k] * sizeof *all->hit);
    }
    return status;
}

/* Traces again, in groups that fit, the rays that had more than ROOM hits. */
static enum status retry_all(const struct engine *engine, void *self, size_t retries,
                             struct all_hits *all, struct reason *reason)
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
        status = retry_some(engine, self, from, to, room, all, reason);
    }
    return status;
}

/* Puts the hits of rays with at most ROOM in place and lists the others; returns how many. */
static size_t place_hits(const struct ray *ray, struct all_hits *all)
{
    size_t retries = 0;
    for (size_t i = 0; i < all->done; i++) {
        if (all->count[i] <= ROOM) {
            memcpy(all->hit + all->first[i], all->scratch + i * ROOM,
                   all->count[i] * sizeof *all->hit);
        } else {
            all->retry[retries] = ray[i];
            all->retry_of[retries++] = i;
        }
    }
    return retries;
}

/* Keeps one of equal hits of each ray. A triangle is tested by the same operations wherever it is
 * listed; hits of one triangle that nevertheless differ in a bit are all kept. */
static void remove_repeats(struct all_hits *all)
{
    size_t kept = 0;
    for (size_t i = 0; i < all->done; i++) {
        struct hit *hit = all->hit + all->first[i];
        size_t count = all->first[i + 1] - all->first[i];
        all_hits_sort(hit, count);
        all->first[i] = kept;
        for (size_t k = 0; k < count; k++) {
            bool repeat = k > 0 && memcmp(&all->hit[kept - 1], &hit[k], sizeof *hit) == 0;
            if (!repeat)
                all->hit[kept++] = hit[k];
        }
    }
    all->first[all->done] = kept;
}

enum status all_hits_next(const struct engine *engine, void *self, const struct ray *ray,
                          size_t ray_count, struct all_hits *out, struct reason *reason)
{
    size_t rays = ray_count < ALL_HITS_RAYS ? ray_count : ALL_HITS_RAYS;
    out->done = 0;
    if (!engine->trace_all)
        return fail(reason, STATUS_UNSUPPORTED, "%s cannot list all hits", engine->name);
    enum status status = RESERVE(out->scratch, out->scratch_capacity, rays * ROOM, reason);
    if (!status)
        status = RESERVE(out->count, out->count_capacity, 2 * (size_t)ALL_HITS_RAYS, reason);
    if (!status)
        status = RESERVE(out->first, out->first_capacity, rays + 1, reason);
    if (!status)
        status = RESERVE(out->retry, out->retry_capacity, rays, reason);
    if (!status)
        status = RESERVE(out->retry_of, out->retry_of_capacity, rays, reason);
    if (!status)
        status = engine->trace_all(self, ray, rays, ROOM, out->scratch, out->count, reason);
    if (status)
        return status;
    out->done = rays_that_fit(out->count, rays);
    out->first[0] = 0;
    for (size_t i = 0; i < out->done; i++)
        out->first[i + 1] = out->first[i] + out->count[i];
    status = RESERVE(out->hit, out->hit_capacity, out->first[out->done] + 1, reason);
    if (!status) {
        size_t retries = place_hits(ray, out);
        out->again += retries;
        status = retry_all(engine, self, retries, out, reason);
    }
    if (status)
        out->done = 0;
    else if (out->once)
        remove_repeats(out);
    return status;
}

void all_hits_free(struct all_hits *all)
{
    free(all->first);
    free(all->hit);
    free(all->scratch);
    free(all->count);
    free(all->retry);
    free(all->retry_of);
    *all = (struct all_hits){0};
}

static int by_distance(const void *left, const void *right)
{
    const struct hit *a = left, *b = right;
    if (a->t != b->t)
        return (a->t > b->t) - (a->t < b->t);
    return (a->prim > b->prim) - (a->prim < b->prim);
}

void all_hits_sort(struct hit *hit, size_t count)
{
    qsort(hit, count, sizeof *hit, by_distance);
}
