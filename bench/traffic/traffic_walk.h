/* Engine cpu's walk of a ray through a packed tree, one node at a time: it can stop before any node
 * and go on later. What it reads goes to a modelled memory. */
#ifndef TRAFFIC_WALK_H
#define TRAFFIC_WALK_H

#include "bench/traffic/traffic_memory.h"
#include "bench/traffic/scene_treelets.h"
#include "ref/trace/trace_walk.h"

#define TRAFFIC_STACK_ENTRY 8u /* bytes: a node and its distance */

/* Where nodes and triangles are read. */
enum traffic_source {
    TRAFFIC_CACHED,   /* in the unit's caches */
    TRAFFIC_RESIDENT, /* in a buffer of the unit, which holds them */
    TRAFFIC_UNSEEN,   /* nowhere: another ray of the packet read them */
};

/* What a ray remembers of the nodes that wait. */
enum traffic_trail {
    TRAFFIC_STACK_CACHED,  /* a stack in memory */
    TRAFFIC_STACK_ON_CHIP, /* a stack in the unit */
    TRAFFIC_RESTART_TRAIL, /* one bit a level, in the ray: the way back leads over the parents */
};

/* A packed tree and the unit that walks through it. Do not move it: `touch` points here. */
struct traffic_walker {
    struct touch touch;
    struct job job; /* with the tree of `touch` */
    struct scene_treelets treelets;
    struct box root_box;
    struct traffic_memory *memory;
    uint32_t unit;
    enum traffic_source source;
    enum traffic_trail trail;
    uint64_t visits; /* nodes that were visited, and parents on the way back */
};

/* A walk in progress. */
struct traffic_lane {
    uint32_t ray;  /* for its owner */
    uint32_t slot; /* of its stack in memory */
    uint32_t at;   /* the node to visit next */
    uint32_t from; /* TRAFFIC_RESTART_TRAIL: the node whose parent is read next, until it is at's */
    bool climbs;   /* from `from` */
    struct walk walk;
};

enum traffic_end { TRAFFIC_MORE, TRAFFIC_DONE, TRAFFIC_LIMIT };

/* What is kept of a lane that waits: it is followed by packed->stack_need references and as many
 * distances. */
struct traffic_waiting {
    struct hit best;
    uint32_t ray, at, from, depth;
    bool climbs;
    uint32_t next; /* for its owner */
    struct traffic_left {
        uint32_t ref;
        float entry;
    } left[];
};

/* Prepares a walker of job->packed, whose treelets have at most `treelet` bytes. `job` and what it
 * points to are borrowed. Errors: STATUS_MEMORY; those of treelets_make. */
enum status traffic_walker_make(const struct job *job, uint64_t treelet, struct traffic_walker *out,
                                struct reason *reason) MUST_USE;

void traffic_walker_free(struct traffic_walker *walker);

/* Starts a walk at the root. Returns TRAFFIC_DONE if the ray misses the root's box. */
enum traffic_end traffic_begin(struct traffic_walker *walker, struct traffic_lane *lane,
                               const struct ray *ray);

/* Starts a walk at `ref`, with a hit that was found before or none. */
void traffic_enter(const struct traffic_walker *walker, struct traffic_lane *lane,
                   const struct ray *ray, uint32_t ref, const struct hit *best);

/* Visits the lane's next node, or reads the next parent on the way to it. TRAFFIC_DONE: the ray's
 * answer is lane->walk.best. */
enum traffic_end traffic_step(struct traffic_walker *walker, struct traffic_lane *lane);

/* Leaves out the lane's next node and goes on to the one that waits, as if it had none below. */
enum traffic_end traffic_skip(struct traffic_walker *walker, struct traffic_lane *lane);

/* Returns the treelet that the next step reads. */
static inline uint32_t traffic_treelet(const struct traffic_walker *walker,
                                       const struct traffic_lane *lane)
{
    const struct scene_treelets *t = &walker->treelets;
    return t->of[lane->climbs ? t->parent[lane->from] : lane->at];
}

static inline size_t traffic_waiting_bytes(const struct traffic_walker *walker)
{
    return sizeof(struct traffic_waiting) +
           (size_t)walker->job.packed->stack_need * sizeof(struct traffic_left);
}

void traffic_save(const struct traffic_lane *lane, struct traffic_waiting *out);

/* The opposite; `ray` is that of traffic_begin. */
void traffic_restore(const struct traffic_walker *walker, const struct traffic_waiting *waiting,
                     const struct ray *ray, struct traffic_lane *lane);

#endif
