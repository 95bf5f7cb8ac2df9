/* Rays that wait at treelets (Aila and Karras 2010): a unit takes the treelet that most rays wait
 * at, and each of them walks until it leaves the treelet. A queue is a list through the places of
 * its rays. Rays, hit records and stacks are in memory; the nodes come through the caches. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

#define QUEUE_BYTES 8u /* of an entry: the next one, and the node */
#define TRAIL_BYTES 8u /* of a restart trail, a bit a level */
#define NONE        UINT32_MAX

struct treelet_pool {
    struct traffic_run *run;
    uint32_t wave;
    bool on_chip;
    size_t taken;  /* rays of the wave */
    char *waiting; /* `places` of them */
    size_t waiting_bytes, places;
    uint32_t free_place; /* a list */
    struct treelet_queue {
        uint32_t first, last;
    } * queue;        /* of each treelet */
    uint32_t *length; /* a tournament: lengths of the queues are its leaves */
    uint32_t leaves;
    struct traffic_lane lane;
};

static struct traffic_waiting *place(const struct treelet_pool *p, uint32_t i)
{
    return (struct traffic_waiting *)(void *)(p->waiting + i * p->waiting_bytes);
}

/* --- memory ----------------------------------------------------------------------------------- */

static void move(struct treelet_pool *p, enum traffic_array array, uint64_t offset, uint64_t bytes,
                 bool write)
{
    if (p->on_chip)
        traffic_on_chip(&p->run->memory, array, bytes, write);
    else
        traffic_access(&p->run->memory, p->run->walker->unit, TRAFFIC_L1, array, offset, bytes,
                       write);
}

/* A ray in its place: with a trail it goes where the ray goes, a stack stays in memory. */
static void move_ray(struct treelet_pool *p, uint32_t at, uint32_t ray, bool write)
{
    move(p, TRAFFIC_AT_QUEUES, (uint64_t)at * QUEUE_BYTES, QUEUE_BYTES, write);
    if (p->on_chip)
        move(p, TRAFFIC_AT_STACKS, 0, TRAIL_BYTES, write);
    if (p->on_chip)
        move(p, TRAFFIC_AT_RAYS, 0, TRAFFIC_RAY_BYTES, write);
    else if (!write)
        traffic_take_ray(p->run, p->run->walker->unit, p->wave, ray);
}

static void move_hit(struct treelet_pool *p, uint32_t ray, bool write)
{
    uint64_t half = (p->wave % 2) * (uint64_t)p->run->paths->wave[0].count;
    move(p, TRAFFIC_AT_HITS, (half + ray) * TRAFFIC_HIT_BYTES, TRAFFIC_HIT_BYTES, write);
}

/* --- queues ----------------------------------------------------------------------------------- */

static void set_length(struct treelet_pool *p, uint32_t treelet, uint32_t length)
{
    uint32_t at = p->leaves + treelet;
    p->length[at] = length;
    for (at /= 2; at > 0; at /= 2) {
        uint32_t a = p->length[2 * at], b = p->length[2 * at + 1];
        p->length[at] = a > b ? a : b;
    }
}

/* The treelet that most rays wait at, the first of equal ones. */
static uint32_t longest(const struct treelet_pool *p)
{
    uint32_t at = 1;
    while (at < p->leaves)
        at = 2 * at + (p->length[2 * at] < p->length[at]);
    return at - p->leaves;
}

/* Lets the lane wait in a place. */
static void enqueue(struct treelet_pool *p, uint32_t at)
{
    uint32_t treelet = traffic_treelet(p->run->walker, &p->lane);
    struct treelet_queue *queue = &p->queue[treelet];
    traffic_save(&p->lane, place(p, at));
    place(p, at)->next = NONE;
    if (queue->first == NONE)
        queue->first = at;
    else
        place(p, queue->last)->next = at;
    queue->last = at;
    set_length(p, treelet, p->length[p->leaves + treelet] + 1);
    move_ray(p, at, p->lane.ray, true);
}

static void end_ray(struct treelet_pool *p, uint32_t at)
{
    traffic_answer(p->run, p->run->walker->unit, p->wave, p->lane.ray, &p->lane.walk.best);
    place(p, at)->next = p->free_place;
    p->free_place = at;
}

/* Takes new rays while there are places. */
static void refill(struct treelet_pool *p)
{
    const struct traffic_wave *wave = &p->run->paths->wave[p->wave];
    while (p->free_place != NONE && p->taken < wave->count) {
        uint32_t at = p->free_place;
        p->free_place = place(p, at)->next;
        p->lane.ray = (uint32_t)p->taken++;
        p->lane.slot = at;
        traffic_take_ray(p->run, p->run->walker->unit, p->wave, p->lane.ray);
        if (traffic_begin(p->run->walker, &p->lane, &wave->ray[p->lane.ray]) != TRAFFIC_MORE) {
            end_ray(p, at);
            continue;
        }
        move_hit(p, p->lane.ray, true);
        enqueue(p, at);
    }
}

/* Lets one ray walk through the treelet. */
static enum traffic_end walk_on(struct treelet_pool *p, uint32_t at, uint32_t treelet)
{
    struct traffic_walker *walker = p->run->walker;
    const struct traffic_waiting *waiting = place(p, at);
    const struct ray *ray = &p->run->paths->wave[p->wave].ray[waiting->ray];
    enum traffic_end end = TRAFFIC_MORE;
    struct hit before = waiting->best;
    move_ray(p, at, waiting->ray, false);
    move_hit(p, waiting->ray, false);
    traffic_restore(walker, waiting, ray, &p->lane);
    p->lane.slot = at;
    while (end == TRAFFIC_MORE && traffic_treelet(walker, &p->lane) == treelet)
        end = traffic_step(walker, &p->lane);
    if (end != TRAFFIC_MORE) {
        end_ray(p, at);
        return end;
    }
    if (p->lane.walk.best.prim != before.prim)
        move_hit(p, p->lane.ray, true);
    enqueue(p, at);
    return end;
}

static enum status play_all(struct treelet_pool *p, struct reason *reason)
{
    uint64_t turn = 0;
    for (refill(p); p->length[1] > 0; refill(p)) {
        uint32_t treelet = longest(p), at = p->queue[treelet].first;
        p->queue[treelet] = (struct treelet_queue){NONE, NONE};
        set_length(p, treelet, 0);
        p->run->walker->unit = (uint32_t)(turn++ % p->run->machine->memory.units);
        p->run->loads++;
        while (at != NONE) {
            uint32_t next = place(p, at)->next;
            if (walk_on(p, at, treelet) == TRAFFIC_LIMIT)
                return fail(reason, STATUS_LIMIT, "a ray was not finished");
            at = next;
        }
    }
    return STATUS_OK;
}

/* --- the whole -------------------------------------------------------------------------------- */

static enum status open_pool(struct treelet_pool *p, struct reason *reason)
{
    uint32_t treelets = p->run->walker->treelets.count;
    size_t rays = p->run->paths->wave[p->wave].count;
    p->places = p->run->machine->queue < rays ? (size_t)p->run->machine->queue : rays;
    p->waiting_bytes = (traffic_waiting_bytes(p->run->walker) + 7) / 8 * 8;
    for (p->leaves = 1; p->leaves < treelets;)
        p->leaves *= 2;
    p->waiting = alloc_zeroed(p->places, p->waiting_bytes);
    p->queue = alloc_zeroed(treelets, sizeof *p->queue);
    p->length = alloc_zeroed(2 * (size_t)p->leaves, sizeof *p->length);
    if (!p->waiting || !p->queue || !p->length)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays in queues", p->places);
    for (uint32_t i = 0; i < treelets; i++)
        p->queue[i] = (struct treelet_queue){NONE, NONE};
    p->free_place = NONE;
    for (size_t i = p->places; i-- > 0;) {
        place(p, (uint32_t)i)->next = p->free_place;
        p->free_place = (uint32_t)i;
    }
    return STATUS_OK;
}

enum status traffic_by_treelet(struct traffic_run *run, uint32_t wave, bool on_chip,
                               struct reason *reason)
{
    struct treelet_pool *p = alloc_zeroed(1, sizeof *p);
    if (!p)
        return fail(reason, STATUS_MEMORY, "no memory for queues");
    p->run = run;
    p->wave = wave;
    p->on_chip = on_chip;
    run->walker->trail = on_chip ? TRAFFIC_RESTART_TRAIL : TRAFFIC_STACK_CACHED;
    enum status status = open_pool(p, reason);
    if (!status)
        status = play_all(p, reason);
    free(p->waiting);
    free(p->queue);
    free(p->length);
    free(p);
    return status;
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++)
        status = traffic_by_treelet(run, k, false, reason);
    return status;
}

const struct scheduler sched_treelets = {.name = "treelets",
                                         .summary =
                                             "rays wait at treelets, with their stacks in memory",
                                         .uses = "units treelet queue private layout store",
                                         .play = play};
