/* Schedulers: orders in which machines of the literature trace rays. Each is a file sched_NAME.c
 * and a row of the table. */
#ifndef SCHEDULERS_H
#define SCHEDULERS_H

#include "bench/traffic/traffic_paths.h"
#include "bench/traffic/traffic_walk.h"
#include "ref/kd/kd.h"

#define TRAFFIC_RAY_BYTES 32u
#define TRAFFIC_HIT_BYTES 16u

#define TRAFFIC_UNITS_MOST  64
#define TRAFFIC_LANES_MOST  256
#define TRAFFIC_PACKET_MOST 64

/* Of a machine. */
struct traffic_machine {
    struct traffic_memory_size memory; /* units 1 to TRAFFIC_UNITS_MOST */
    uint32_t lanes;                    /* rays that a unit traces in turn, a node each */
    uint32_t packet;                   /* rays of a packet */
    uint64_t treelet;                  /* most bytes of a treelet */
    uint64_t queue;                    /* rays that wait in queues at a time, of each chip */
};

/* A run of one scheduler. */
struct traffic_run {
    const struct traffic_machine *machine;
    const struct traffic_paths *paths;
    uint32_t depth;                /* waves that are traced, at most paths->depth */
    struct traffic_walker *walker; /* of the packed tree */
    const struct kd_tree *kd;      /* of schedulers with `kd` */
    struct traffic_memory memory;
    struct hit *hit[TRAFFIC_DEPTH_MOST]; /* answers of each wave */
    bool *answered[TRAFFIC_DEPTH_MOST];  /* whether there is one */
    uint64_t loads;                      /* of treelets: taken up, or streamed in */
    uint64_t twice;                      /* rays that were answered again */
    uint64_t reloads;                    /* segments streamed to a unit twice in a wavefront */
};

struct scheduler {
    const char *name, *summary;
    const char *uses; /* options of the machine, the layout and the storage, separated by blanks */
    bool streams;     /* needs the runs of treelets; accesses may pass caches */
    bool reorders;    /* rays visit nodes in another order than engine cpu's */
    bool kd;          /* traces the k-d tree in place of the packed one */
    /* Answers every ray of the waves. Errors: STATUS_MEMORY; STATUS_LIMIT a ray was not
     * finished. */
    enum status (*play)(struct traffic_run *run, struct reason *reason);
};

/* NULL-terminated. The first is what the others are compared with. */
extern const struct scheduler *const schedulers[];

/* Returns the scheduler of that name, or NULL. */
const struct scheduler *scheduler_find(const char *name);

/* What came of a run. */
struct traffic_result {
    struct traffic_count count[TRAFFIC_LEVELS];
    uint64_t row_hits, row_misses;
    uint64_t working_set; /* bytes */
    uint64_t rays;        /* of all waves */
    uint64_t visits, loads;
    uint64_t ties;  /* another triangle at the same t */
    uint64_t wrong; /* answers that are neither the expected hit nor a tie, or missing, or given
                       twice */
    /* Other answers of a scheduler with `reorders` in a layout that has RTRS's faults: its leaves
     * name triangles outside their boxes, so that an answer depends on the order of visits. */
    uint64_t other;
    uint64_t reloads;
    bool conserved; /* traffic_conserved */
};

/* Returns STATUS_OK, or STATUS_INPUT with the first rule that the machine breaks. */
enum status traffic_machine_check(const struct traffic_machine *machine,
                                  struct reason *reason) MUST_USE;

/* Bytes that a scheduler may need for `rays` rays in flight, the paths apart. */
uint64_t traffic_run_bytes(const struct traffic_machine *machine, uint32_t stack_need, size_t rays);

/* Runs a scheduler on the first `depth` waves and compares its answers with the waves', or for a
 * scheduler with `kd` with kd_closest's. run->machine, paths, depth, walker and kd are set by the
 * caller. Errors: those of play() and traffic_memory_make. */
enum status traffic_play(const struct scheduler *scheduler, struct traffic_run *run,
                         struct traffic_result *out, struct reason *reason) MUST_USE;

/* --- for schedulers --------------------------------------------------------------------------- */

/* Reads a ray of a wave from memory. */
void traffic_take_ray(struct traffic_run *run, uint32_t unit, uint32_t wave, uint32_t ray);

/* Writes the answer of a ray to memory. */
void traffic_answer(struct traffic_run *run, uint32_t unit, uint32_t wave, uint32_t ray,
                    const struct hit *hit);

/* The same without a write. */
void traffic_note_answer(struct traffic_run *run, uint32_t wave, uint32_t ray,
                         const struct hit *hit);

/* Traces the rays of a wave in the given order (NULL: as they are), machine->lanes at a time by
 * each unit. */
enum status traffic_in_order(struct traffic_run *run, uint32_t wave, const uint32_t *order,
                             struct reason *reason) MUST_USE;

/* Traces a wave with rays that wait at treelets. `on_chip`: rays, hits and queues are in the unit,
 * and a ray has a restart trail in place of a stack. */
enum status traffic_by_treelet(struct traffic_run *run, uint32_t wave, bool on_chip,
                               struct reason *reason) MUST_USE;

/* How segments are streamed. */
struct traffic_streaming {
    uint32_t pools; /* of rays; each traces every segment that it has rays for */
    bool on_chip;   /* queues and hit records are in the pool's unit */
    /* Segments are read from here: DRAM, or level 2, which all pools share. */
    enum traffic_level from;
};

/* Traces rays `first` to `end` of a wave as one wavefront: segments, which are treelets, in
 * ascending order, each with all rays that wait for it. */
enum status traffic_stream(struct traffic_run *run, uint32_t wave, size_t first, size_t end,
                           const struct traffic_streaming *how, struct reason *reason) MUST_USE;

#endif
