/* An engine traces rays. All engines are used the same way: open, prepare a job, trace. */
#ifndef ENGINE_H
#define ENGINE_H

#include "ref/layout.h"
#include "ref/primitives/primitives.h"

struct model; /* ref/twin/model.h */

struct engine_options {
    uint32_t threads;   /* CPU engines; 0: all */
    const char *driver; /* Vulkan: part of the driver or device name, or NULL */
    int device;         /* Vulkan: index as `raydiff doctor` lists them, -1: first that matches */
    uint32_t workgroup; /* Vulkan: 0 is ABI_WORKGROUP */
    bool unguarded;     /* Embree: asks it rays that it does not promise to survive, too; only in a
                           process that may die */
    bool compact;       /* Embree: the scene's flag of that name */
    bool avx512;        /* Embree: with AVX-512, too, where there is some; by default up to AVX2 */
    bool alone;         /* fast: never two rays at once, whatever the size of the tree */
    uint32_t peer_ms;   /* pipe: the longest that a peer may take for a request; 0: PEER_MS */
    uint32_t peer_mb;   /* pipe: address space of a peer in MB; 0: PEER_MB, UINT32_MAX: no limit */
};

#define PEER_MS 60000u
#define PEER_MB 8192u

/* Input of a trace. Everything is borrowed and must stay valid until the next prepare or close. */
struct job {
    const struct scene *scene;
    const struct packed *packed; /* NULL for engines without needs_packed */
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query;
    const uint32_t *parent; /* packed_links: trace without a stack; or NULL */
};

/* Whether a triangle test that is watertight stays so in the tree of a job. Not unless the box test
 * lets no box go that has a part of a triangle which such a test can hit; and not in a split tree,
 * whose boxes end at planes within triangles: a ray that meets a shared edge exactly on the side of
 * the one triangle may be accepted by the test of the other alone, at a point beside it that no
 * box has which lists it. How far beside grows with the ray's distance, so no padding of the boxes
 * would do. Exact hits are found in split trees, too (ref/tree/cover.h). */
static inline bool job_keeps_watertight(const struct job *job)
{
    return !job->packed || (job->box->watertight && !job->packed->split);
}

/* What one trace call cost. */
struct trace_report {
    uint64_t ns;                     /* time of the tracing alone */
    bool device_clock;               /* ns comes from GPU timestamps, else from the host's clock */
    uint64_t boxes, tris;            /* tests done, 0 if not counted */
    uint64_t node_bytes, item_bytes; /* of an engine with own_tree: its own; else 0 */
    uint64_t memory_bytes;           /* scene, tree and buffers the engine holds */
    uint32_t flags; /* ABI_FLAG_* of the first ray not finished, if known; else 0 */
};

/* One of many small jobs that are traced together. The caller sets the members before `hit`. */
struct engine_task {
    struct job job; /* closest or any */
    const struct ray *ray;
    size_t ray_count;
    struct hit *hit; /* room for ray_count; of a ray that was not finished it is undefined */
    uint32_t *flag;  /* likewise: ABI_FLAG_DONE of a ray that was finished, else others too */
    uint32_t *work;  /* NULL, or room for ray_count: what each ray took, as trace_rays says
                        it, if the engine tells */
    const uint32_t *expected; /* NULL, or what each ray may take: an engine that traces rays side by
                                 side puts those together that will end together */
    enum status status;       /* of this task: as prepare's and trace's */
    struct reason reason;     /* if it is not STATUS_OK */
};

/* How an engine in a process of its own failed. */
enum engine_fault {
    ENGINE_FINE,
    ENGINE_ENDED,   /* its process ended */
    ENGINE_LATE,    /* it exceeded its time limit */
    ENGINE_NONSENSE /* its reply was invalid */
};

struct frame_job; /* ref/frame.h */
struct view;
struct frame;

/* Rendering by the engine itself. */
struct frame_renderer {
    /* As engine.prepare, of which it is independent. */
    enum status (*prepare)(void *self, const struct frame_job *job, struct reason *reason);
    /* Draws the prepared job as seen from `view`. report->ns is the time of the drawing alone,
     * without reading back. Errors: STATUS_DEVICE a path was not finished (the reason names pixel
     * and cause), lost; STATUS_LIMIT more pixels than buffers hold; STATUS_MEMORY. */
    enum status (*draw)(void *self, const struct view *view, struct frame *out,
                        struct trace_report *report, struct reason *reason);
};

struct engine {
    const char *name;
    const char *summary;
    bool reference;    /* the C that all others are compared with, on a tree and without one */
    bool library;      /* a tracer of another project, linked in */
    bool needs_packed; /* false: sees the scene alone (brute, Embree) */
    bool brute;   /* tests every triangle: asked for no more rays than match_options.brute_budget
                     pays for */
    bool own_tri; /* has a triangle test of its own, whatever job.tri is; traces no trees as
                     published */
    const char *tri_name; /* own_tri: the triangle test that it runs, if it is of the table */
    bool own_tree;        /* makes a tree of its own from the packed one, and tests its boxes so */
    bool tells_work;      /* its trace_tasks fills in task.work */
    bool binary;          /* traces trees of binary layouts only: STATUS_UNSUPPORTED else */
    bool gpu;             /* runs on a Vulkan driver */
    bool compiles; /* a program for each layout, storage and tests: the first trial is slow */
    bool recorded; /* its results are a recording: it can trace no other rays */
    /* Errors: STATUS_UNSUPPORTED cannot run here (reason), STATUS_DEVICE, STATUS_MEMORY. */
    enum status (*open)(const struct engine_options *options, void **self, struct reason *reason);
    /* Uploads, builds, compiles. May be called again with another job.
     * Errors: STATUS_LIMIT too large for the engine, STATUS_UNSUPPORTED, _DEVICE, _MEMORY. */
    enum status (*prepare)(void *self, const struct job *job, struct reason *reason);
    /* Traces ray_count rays (0 is fine). Errors: STATUS_DEVICE lost, or a ray was not finished
     * (stack or loop exhausted: the reason says which ray and why); STATUS_MEMORY. */
    enum status (*trace)(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason);
    /* Traces `count` jobs with all their rays, to the same bits as prepare and trace of one after
     * the other; nothing is prepared afterwards. A job that cannot be traced, or has a ray that was
     * not finished, reports it in its own status and does not stop the others.
     * Errors, after which the tasks hold nothing: STATUS_DEVICE lost; STATUS_MEMORY. NULL: the
     * engine does one job at a time. */
    enum status (*trace_tasks)(void *self, struct engine_task *task, size_t count,
                               struct reason *reason);
    /* All triangles that each ray hits in its range, for a job prepared with QUERY_ALL (trace is
     * for the other queries), in no order; ray i's are hit[i * capacity .. + hit_count[i] - 1]. A
     * count over capacity is the full number; then only the first `capacity` hits are written. A
     * triangle may be listed twice if the engine finds it twice; the judge checks that. The
     * caller keeps ray_count * capacity in bounds (ref/trace/all_hits.h does). Errors: as trace;
     * STATUS_LIMIT capacity hits of one ray are more than a buffer can hold. NULL: cannot (rows
     * skip). An engine whose traversal is not ours, such as a ray query, can list candidates and
     * confirm none. */
    enum status (*trace_all)(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason);
    const struct frame_renderer *renderer; /* NULL: driven ray by ray (scenes/render/render.h) */
    /* What the last prepare or trace with STATUS_DEVICE was, and how many of its rays were answered
     * before (*ray). The engine stays usable: the next call starts its process again. NULL: it has
     * none; after STATUS_DEVICE it may have to be opened again. */
    enum engine_fault (*fault)(void *self, size_t *ray);
    /* What the judge may assume of an opened engine's arithmetic with `tri`. */
    struct model (*model)(void *self, const struct tri_test *tri);
    void (*close)(void *self); /* NULL is fine */
    /* Prints the text of `raydiff doctor`: versions, limits, or why it cannot run. */
    void (*describe)(const struct engine_options *options, char *text, size_t text_bytes);
};

/* False if the engine, which needs trees, traces none of that layout: STATUS_UNSUPPORTED. */
static inline bool engine_takes(const struct engine *engine, const struct layout *layout)
{
    return !(engine->binary && layout_is_wide(layout)) && !(engine->own_tri && layout->faithful);
}

/* NULL-terminated: the program's own, then what engine_add added. */
extern const struct engine *const *const engines;

#define ENGINES_ADDED_MOST 4

/* Adds an engine at the end of the table; borrowed until the program ends. For programs, while no
 * other thread looks at the table. Errors: STATUS_LIMIT more than ENGINES_ADDED_MOST. */
enum status engine_add(const struct engine *engine, struct reason *reason) MUST_USE;

/* Returns the engine of that name, or NULL. */
const struct engine *engine_find(const char *name);

/* The engine of the table that is the reference on packed trees, or without them. */
const struct engine *engine_reference(bool packed);

#endif
