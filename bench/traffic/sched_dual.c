/* Dual streaming (Shkurko et al. 2017): the scene is read in segments, which are treelets, parents
 * first, and the rays that reach a segment are read beside it. A ray waits at every segment that it
 * reaches, so that each segment is read at most once for a wavefront. The nearest hit is in
 * memory. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

#define COPY_BYTES (TRAFFIC_RAY_BYTES + 4) /* of a ray in a queue: the ray and its number */

struct segment_queue {
    struct segment_ray {
        uint32_t ray, ref;
    } * ray;
    size_t count, capacity;
};

struct streaming {
    struct traffic_run *run;
    uint32_t wave;
    size_t first, end;
    const struct traffic_streaming *how;
    struct segment_queue *queue; /* pools of each treelet */
    bool *loaded;                /* likewise */
    struct hit *best;            /* of the rays */
    uint64_t written;            /* bytes of queues: where the next one lies */
    struct traffic_lane lane;
};

/* Rays are dealt to the pools in equal runs, neighbours together. */
static uint32_t pool_of(const struct streaming *s, size_t ray)
{
    return (uint32_t)((ray - s->first) * s->how->pools / (s->end - s->first));
}

static void move_hit(struct streaming *s, uint32_t ray, bool write)
{
    uint64_t half = (s->wave % 2) * (uint64_t)s->run->paths->wave[0].count;
    if (s->how->on_chip)
        traffic_on_chip(&s->run->memory, TRAFFIC_AT_HITS, TRAFFIC_HIT_BYTES, write);
    else
        traffic_access(&s->run->memory, 0, TRAFFIC_L2, TRAFFIC_AT_HITS,
                       (half + ray) * TRAFFIC_HIT_BYTES, TRAFFIC_HIT_BYTES, write);
}

/* A whole queue is written and read in order, or kept on the chip. The first one is the wave's own
 * array of rays. */
static void move_queue(struct streaming *s, uint32_t segment, size_t count)
{
    struct traffic_memory *memory = &s->run->memory;
    uint64_t half = (s->wave % 2) * (uint64_t)s->run->paths->wave[0].count;
    uint64_t bytes = count * COPY_BYTES;
    if (segment == 0) {
        traffic_access(memory, 0, TRAFFIC_DRAM, TRAFFIC_AT_RAYS, (half + s->first) * 32,
                       count * TRAFFIC_RAY_BYTES, false);
        return;
    }
    for (int write = 1; write >= 0; write--)
        if (s->how->on_chip)
            traffic_on_chip(memory, TRAFFIC_AT_QUEUES, bytes, write);
        else
            traffic_access(memory, 0, TRAFFIC_DRAM, TRAFFIC_AT_QUEUES, s->written, bytes, write);
    s->written += (bytes + TRAFFIC_BURST - 1) / TRAFFIC_BURST * TRAFFIC_BURST;
}

static void load_segment(struct streaming *s, uint32_t segment, uint32_t pool)
{
    const struct scene_treelets *t = &s->run->walker->treelets;
    size_t at = (size_t)segment * s->how->pools + pool;
    s->run->loads++;
    s->run->reloads += s->loaded[at];
    s->loaded[at] = true;
    for (size_t i = t->first[segment]; i < t->first[segment + 1]; i++)
        traffic_access(&s->run->memory, pool, s->how->from, (enum traffic_array)t->run[i].array,
                       t->run[i].offset, t->run[i].bytes, false);
}

static enum status enqueue(struct streaming *s, uint32_t segment, uint32_t pool, uint32_t ray,
                           uint32_t ref)
{
    struct segment_queue *q = &s->queue[(size_t)segment * s->how->pools + pool];
    if (array_reserve(&q->ray, &q->capacity, q->count + 1, sizeof *q->ray))
        return STATUS_MEMORY;
    q->ray[q->count++] = (struct segment_ray){ray, ref};
    return STATUS_OK;
}

/* Lets a ray walk through a segment. Where it would leave it, a copy waits at the next segment. */
static enum status walk_through(struct streaming *s, uint32_t segment, uint32_t pool,
                                const struct segment_ray *from)
{
    struct traffic_walker *walker = s->run->walker;
    struct hit *best = &s->best[from->ray - s->first];
    enum traffic_end end = TRAFFIC_MORE;
    enum status status = STATUS_OK;
    s->lane.ray = from->ray;
    s->lane.slot = pool;
    move_hit(s, from->ray, false);
    traffic_enter(walker, &s->lane, &s->run->paths->wave[s->wave].ray[from->ray], from->ref, best);
    while (end == TRAFFIC_MORE && !status) {
        uint32_t next = traffic_treelet(walker, &s->lane);
        if (next == segment) {
            end = traffic_step(walker, &s->lane);
        } else {
            status = enqueue(s, next, pool, from->ray, s->lane.at);
            end = traffic_skip(walker, &s->lane);
        }
    }
    if (s->lane.walk.best.prim != best->prim) {
        *best = s->lane.walk.best;
        move_hit(s, from->ray, true);
    }
    return end == TRAFFIC_LIMIT ? STATUS_LIMIT : status;
}

static enum status play_segment(struct streaming *s, uint32_t segment, uint32_t pool)
{
    struct segment_queue *q = &s->queue[(size_t)segment * s->how->pools + pool];
    enum status status = STATUS_OK;
    if (q->count == 0)
        return STATUS_OK;
    load_segment(s, segment, pool);
    if (segment > 0)
        move_queue(s, segment, q->count);
    for (size_t i = 0; i < q->count && !status; i++)
        status = walk_through(s, segment, pool, &q->ray[i]);
    free(q->ray);
    *q = (struct segment_queue){NULL, 0, 0};
    return status;
}

/* All rays come to the first segment if they meet its box, which is read with it. */
static enum status start(struct streaming *s)
{
    struct traffic_walker *walker = s->run->walker;
    enum status status = STATUS_OK;
    move_queue(s, 0, s->end - s->first);
    walker->source = TRAFFIC_RESIDENT;
    walker->trail = TRAFFIC_STACK_ON_CHIP;
    for (size_t i = s->first; i < s->end && !status; i++) {
        s->best[i - s->first] = (struct hit){.prim = ABI_NO_PRIM};
        move_hit(s, (uint32_t)i, true);
        if (traffic_begin(walker, &s->lane, &s->run->paths->wave[s->wave].ray[i]) == TRAFFIC_MORE)
            status = enqueue(s, 0, pool_of(s, i), (uint32_t)i, s->lane.at);
    }
    return status;
}

static enum status stream_all(struct streaming *s, struct reason *reason)
{
    uint32_t segments = s->run->walker->treelets.count;
    enum status status = start(s);
    for (uint32_t segment = 0; segment < segments && !status; segment++)
        for (uint32_t pool = 0; pool < s->how->pools && !status; pool++)
            status = play_segment(s, segment, pool);
    for (size_t i = s->first; i < s->end && !status; i++) {
        if (s->how->on_chip) /* the hit leaves the chip at the end */
            traffic_answer(s->run, pool_of(s, i), s->wave, (uint32_t)i, &s->best[i - s->first]);
        else
            traffic_note_answer(s->run, s->wave, (uint32_t)i, &s->best[i - s->first]);
    }
    if (status == STATUS_LIMIT)
        return fail(reason, status, "a ray was not finished");
    return status ? fail(reason, status, "no memory for the queues of %u segments", segments)
                  : STATUS_OK;
}

enum status traffic_stream(struct traffic_run *run, uint32_t wave, size_t first, size_t end,
                           const struct traffic_streaming *how, struct reason *reason)
{
    size_t queues = (size_t)run->walker->treelets.count * how->pools;
    struct streaming *s = alloc_zeroed(1, sizeof *s);
    if (!s)
        return fail(reason, STATUS_MEMORY, "no memory for queues");
    *s = (struct streaming){.run = run, .wave = wave, .first = first, .end = end, .how = how};
    s->queue = alloc_zeroed(queues, sizeof *s->queue);
    s->loaded = alloc_zeroed(queues, sizeof *s->loaded);
    s->best = alloc_zeroed(end - first, sizeof *s->best);
    enum status status = STATUS_OK;
    if (!s->queue || !s->loaded || !s->best)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu queues", queues);
    if (!status && end > first)
        status = stream_all(s, reason);
    for (size_t i = 0; i < queues && s->queue; i++)
        free(s->queue[i].ray);
    free(s->queue);
    free(s->loaded);
    free(s->best);
    free(s);
    return status;
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    static const struct traffic_streaming how = {.pools = 1, .from = TRAFFIC_DRAM};
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++)
        status = traffic_stream(run, k, 0, run->paths->wave[k].count, &how, reason);
    return status;
}

const struct scheduler sched_dual = {.name = "dual",
                                     .summary = "scene and rays are streamed; hits are in memory",
                                     .uses = "treelet layout store",
                                     .streams = true,
                                     .reorders = true,
                                     .play = play};
