/* An engine traces rays. All engines are used the same way: open, prepare a job, trace. */
#ifndef ENGINE_H
#define ENGINE_H

#include "ref/layout.h"
#include "ref/primitives/primitives.h"

struct model;       /* ref/twin/model.h */
struct vk_compiler; /* gpu/vk/vk.h */

struct engine_options {
    uint32_t threads;   /* CPU engines; 0: all */
    const char *driver; /* Vulkan: a part of the driver or device name, or NULL */
    int device;         /* Vulkan: index as in `raydiff doctor`; -1: the first that matches */
    uint32_t workgroup; /* Vulkan: 0: ABI_WORKGROUP */
    const struct vk_compiler *compiler; /* Vulkan: compiles its shaders anew; NULL: as built */
    bool unguarded;   /* Embree: also trace rays that may crash it; only in a process that may
                           crash */
    bool compact;     /* Embree: build the scene with its compact flag */
    bool avx512;      /* Embree: use AVX-512 if available; by default up to AVX2 */
    bool alone;       /* fast: never trace several rays at once */
    uint32_t peer_ms; /* pipe: and FILE.so: time limit of a request to a peer; 0: PEER_MS */
    uint32_t peer_mb; /* the same: address space in MB; 0: PEER_MB, UINT32_MAX: unlimited */
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
    const uint32_t *parent; /* from packed_links: trace without a stack; or NULL */
};

struct world;        /* ref/world/world.h */
struct ray_mode;     /* ref/abi_world.h */
struct packed_world; /* ref/two_level/packed_world.h */

/* Input of a trace of a world; borrowed as a job is. */
struct world_job {
    const struct world *world;
    const struct packed_world *packed; /* NULL for engines without needs_packed */
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query;
    /* Rays have no flags and are not listed: where the filter passes all, an engine needs to test
     * no candidate. */
    bool bare;
};

/* True if a watertight triangle test stays watertight in the job's tree. That takes two conditions.
 * The box test must accept every box that contains a part of a triangle that such a test can hit.
 * The tree must not be split: the boxes of a split tree end at planes inside triangles. A ray that
 * meets a shared edge exactly on the side of one triangle may be accepted only by the test of the
 * other triangle, at a point beside that triangle that lies in none of the boxes that list it. The
 * point's distance from the triangle grows with the distance along the ray, so no padding of the
 * boxes is enough. Exact hits are found in split trees, too (ref/tree/cover.h). */
static inline bool job_keeps_watertight(const struct job *job)
{
    return !job->packed || (job->box->watertight && !job->packed->split);
}

/* Cost of one trace call. */
struct trace_report {
    uint64_t ns;                     /* tracing only */
    uint64_t core_ns;                /* the same in time of the calling thread; 0: not measured */
    bool device_clock;               /* ns is from GPU timestamps, else from the host's clock */
    uint64_t boxes, tris;            /* number of tests; 0 if not counted */
    uint64_t node_bytes, item_bytes; /* of an engine with own_tree: of its own tree; of a tracer
                                        from outside: of its nodes, if it tells; else 0 */
    uint64_t scene_bytes;            /* of a tracer from outside: of the triangles in the form that
                                        it reads, if it tells; else 0 */
    uint64_t memory_bytes;           /* scene, tree and buffers held by the engine; 0: unknown */
    uint32_t flags;                  /* ABI_FLAG_* of the first unfinished ray, if known; else 0 */
};

/* One of many small jobs traced together. The caller sets the members before `hit`. */
struct engine_task {
    struct job job; /* closest or any */
    const struct ray *ray;
    size_t ray_count;
    struct hit *hit; /* room for ray_count; undefined for an unfinished ray */
    uint32_t *flag;  /* room for ray_count: ABI_FLAG_DONE for a finished ray, else with other
                        flags */
    uint32_t *work;  /* NULL, or room for ray_count: the work for each ray, as in trace_rays, if
                        the engine has tells_work */
    const uint32_t *expected; /* NULL, or the expected work for each ray: an engine that traces
                                 rays side by side groups rays of similar work */
    enum status status;       /* of this task; values as for prepare and trace */
    struct reason reason;     /* set if status is not STATUS_OK */
};

/* How an engine with its own process failed. */
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
    /* As engine.prepare; independent of it. */
    enum status (*prepare)(void *self, const struct frame_job *job, struct reason *reason);
    /* Draws the prepared job as seen from `view`. report->ns is the time of the drawing alone,
     * without reading back. Errors: STATUS_DEVICE a path was not finished (the reason names pixel
     * and cause), or the device was lost; STATUS_LIMIT more pixels than buffers can hold;
     * STATUS_MEMORY. */
    enum status (*draw)(void *self, const struct view *view, struct frame *out,
                        struct trace_report *report, struct reason *reason);
};

/* Tracing of worlds: instances, their masks, culling, opacity and filters. */
struct world_tracer {
    /* As engine.prepare, and apart from it: after either, only traces of that kind are allowed. */
    enum status (*prepare_world)(void *self, const struct world_job *job, struct reason *reason);
    /* As prepare_world, after a prepare_world or move_world of this engine that returned STATUS_OK,
     * with nothing of another job between them. Vertices have moved, or members of instances have
     * changed: transforms, masks, meshes, custom indices, flags. Numbers of instances, of meshes
     * and of their triangles, indices, geometries, filter, tests and query are the same, and so is
     * the packed world but for what packed_world_refit changes. Errors: as prepare_world; then it
     * holds nothing. NULL: it cannot, and is prepared anew (engine_follow_world). */
    enum status (*move_world)(void *self, const struct world_job *job, struct reason *reason);
    /* As engine.trace. Ray i meets what mode[i] lets it meet; modes have passed ray_mode_check;
     * NULL: ray_mode_all() for every ray. hit[i].prim is the number of a placed triangle
     * (ref/world/world.h), tag[i] what ref/abi.h has under ABI_TAG_CUSTOM; 0 for a miss. */
    enum status (*trace_world)(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason);
    /* As engine.trace_all, with the tags of the hits at the same places. Hits end no ray, whatever
     * its flags. NULL: not supported. */
    enum status (*trace_world_all)(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason);
    /* Whether this opened engine traces worlds at all. NULL: it does. */
    bool (*traces)(const void *self);
};

/* What a compiler made of the shader of the job that was prepared last. Float operations are
 * those with NoContraction in the build's shader: all of them. */
struct engine_compiled {
    const char *compiler;     /* "opt", "passes:ccp+if-conversion:final" */
    const struct engine *raw; /* the same engine with the shaders as built */
    bool translates;      /* through another language, which may have no word for a decoration */
    bool free;            /* no decoration is asked for: ":none" */
    uint32_t source, ops; /* float operations of the build's module and of the compiled one */
    uint32_t kept;        /* of `ops`, with NoContraction */
    uint32_t signs;       /* of those without, negations, which round nothing */
    uint32_t foreign; /* instructions of open rounding that the source lacks, such as Fma and Dot */
    uint32_t words;   /* of the compiled module; 0: nothing is prepared yet */
    bool equal;       /* answers must have the bits of `raw`; known when the model was asked for */
};

/* How many float operations lack a decoration that was asked for, or have open rounding. */
static inline uint32_t engine_compiled_lost(const struct engine_compiled *compiled)
{
    return compiled->free ? 0 : compiled->ops - compiled->kept + compiled->foreign;
}

/* The same without negations: while there is none, a driver may not round otherwise than before. */
static inline uint32_t engine_compiled_loose(const struct engine_compiled *compiled)
{
    return compiled->free ? compiled->ops : engine_compiled_lost(compiled) - compiled->signs;
}

struct engine {
    const char *name;
    const char *summary;
    void *named;          /* of an engine that was named while the program runs: what it is, for the
                          functions that are told their engine */
    bool reference;       /* the C engine that all others are compared with, on a tree or without
                             one */
    bool library;         /* a tracer of another project, in this process */
    bool needs_packed;    /* false: reads only the scene (brute, Embree) */
    bool brute;           /* tests every triangle; gets at most as many rays as
                             match_options.brute_budget allows */
    bool own_tri;         /* has its own triangle test and ignores job.tri; does not trace faithful
                             layouts, nor does one with own_tree */
    const char *tri_name; /* own_tri: name of its triangle test, if that is in the table */
    bool own_tree;        /* builds a tree of its own, from the packed one if it needs_packed, and
                             tests the boxes of that */
    bool tells_work;      /* trace_tasks fills in task.work */
    bool binary;          /* traces only trees of binary layouts; others: STATUS_UNSUPPORTED */
    bool gpu;             /* runs on a Vulkan driver */
    bool compiles; /* compiles a program per layout, storage and tests: the first trial is slow */
    bool foreign_bits; /* may have other bits than the reference engine on the same tree, which are
                          counted */
    const struct engine *plain; /* of a mode of a library: its engine of the same formula, whose
                                   bits are counted against: NULL: it is no such mode */
    bool plain_bits; /* its answers must have the bits of `plain`: it traces a copy of its tree */
    bool recorded;   /* its results are a recording: it cannot trace other rays */
    /* Errors: STATUS_UNSUPPORTED cannot run here (with the reason); STATUS_DEVICE;
     * STATUS_MEMORY. */
    enum status (*open)(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason);
    /* Uploads, builds, compiles. May be called again with another job. Errors: STATUS_LIMIT too
     * large for the engine, STATUS_UNSUPPORTED, _DEVICE, _MEMORY. */
    enum status (*prepare)(void *self, const struct job *job, struct reason *reason);
    /* As prepare, after a prepare or move of this engine that returned STATUS_OK, with nothing of
     * another job between them. The vertices have moved; numbers of vertices and triangles,
     * indices, tests and query are the same, and so is the packed tree but for what packed_refit
     * changes. The engine updates what it holds. Errors: as prepare; then it holds nothing. NULL:
     * it cannot, and is prepared anew (engine_follow). */
    enum status (*move)(void *self, const struct job *job, struct reason *reason);
    /* Whether this opened engine has move at all. NULL: it does. */
    bool (*moves)(const void *self);
    /* Traces ray_count rays (0 is allowed). Errors: STATUS_DEVICE the device was lost, or a ray was
     * not finished (stack or loop exhausted: the reason names the ray and the cause);
     * STATUS_MEMORY. */
    enum status (*trace)(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason);
    /* Traces `count` jobs with all their rays. The results are the same bits as from prepare and
     * trace for each job in turn; no job is prepared afterwards. A job that cannot be traced, or
     * with an unfinished ray, reports this in its own status and does not stop the others. Errors,
     * after which the tasks have no valid results: STATUS_DEVICE the device was lost;
     * STATUS_MEMORY. NULL: the engine traces one job at a time. */
    enum status (*trace_tasks)(void *self, struct engine_task *task, size_t count,
                               struct reason *reason);
    /* Finds all triangles that each ray hits in its range, for a job prepared with QUERY_ALL (trace
     * handles the other queries). Hits of ray i are hit[i * capacity .. + hit_count[i] - 1],
     * unordered. A count over capacity is the full number; then only the first `capacity` hits are
     * written. A triangle may be listed twice if the engine finds it twice; the judge checks that.
     * The caller keeps ray_count * capacity in bounds (as ref/trace/all_hits.h does). Errors: as
     * trace; STATUS_LIMIT capacity hits of one ray exceed a buffer. NULL: not supported (rows are
     * skipped). An engine whose traversal is not ours, such as a ray query, can list candidates and
     * confirm none. See engine_lists. */
    enum status (*trace_all)(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason);
    /* Whether this opened engine has trace_all at all. NULL: it does. */
    bool (*lists)(const void *self);
    const struct engine_compiled *compiled; /* NULL: it is not an engine with other shaders */
    const struct world_tracer *worlds;      /* NULL: it traces no worlds (rows are skipped); see
                                              engine_traces_worlds */
    const struct frame_renderer *renderer;  /* NULL: rendered ray by ray (scenes/render/render.h) */
    /* Returns how the last prepare or trace that returned STATUS_DEVICE failed, and in *ray how
     * many of its rays were answered before. The engine stays usable: the next call restarts its
     * process. NULL: the engine has no process of its own; after STATUS_DEVICE it may have to be
     * opened again. */
    enum engine_fault (*fault)(void *self, size_t *ray);
    /* Returns what the judge may assume about the arithmetic of an opened engine with `tri`. */
    struct model (*model)(const struct engine *engine, void *self, const struct tri_test *tri);
    /* Returns how `trace` calls an opened tracer of another project, for tables of speeds, in 36
     * characters at most. NULL: see engine_called. */
    const char *(*called)(const void *self);
    void (*close)(void *self); /* NULL is allowed */
    /* Returns the name of the engine whose formula that variant of this engine has ("rayquery" of
     * "rayquery:nan"); NULL if no variant is called so. NULL: the engine has no variants. */
    const char *(*plain_of)(const char *name);
    /* Writes the text of `raydiff doctor`: versions, limits, or why it cannot run. */
    void (*describe)(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes);
};

/* engine.open, model and describe: those that are told which engine they are of, since engines that
 * were named while the program runs share them. */
static inline enum status engine_open(const struct engine *engine,
                                      const struct engine_options *options, void **self,
                                      struct reason *reason)
{
    return engine->open(engine, options, self, reason);
}

struct model engine_model(const struct engine *engine, void *self, const struct tri_test *tri);

static inline void engine_describe(const struct engine *engine,
                                   const struct engine_options *options, char *text,
                                   size_t text_bytes)
{
    engine->describe(engine, options, text, text_bytes);
}

/* Whether an opened engine updates what it holds when vertices have moved. */
static inline bool engine_moves(const struct engine *engine, const void *self)
{
    return engine->move && (!engine->moves || engine->moves(self));
}

/* Prepares an opened engine with the next job of a life (ref/packed/life.h). `refitted`: its tree
 * was refitted, not built again. Errors: as engine.prepare. */
static inline enum status engine_follow(const struct engine *engine, void *self,
                                        const struct job *job, bool refitted, struct reason *reason)
{
    return refitted && engine_moves(engine, self) ? engine->move(self, job, reason)
                                                  : engine->prepare(self, job, reason);
}

/* Whether an engine updates what it holds of a world. */
static inline bool engine_moves_worlds(const struct engine *engine)
{
    return engine->worlds && engine->worlds->move_world;
}

/* As engine_follow, of a world that `engine` traces. Errors: as prepare_world. */
static inline enum status engine_follow_world(const struct engine *engine, void *self,
                                              const struct world_job *job, bool refitted,
                                              struct reason *reason)
{
    return refitted && engine_moves_worlds(engine)
               ? engine->worlds->move_world(self, job, reason)
               : engine->worlds->prepare_world(self, job, reason);
}

/* How an opened engine is called when it is timed. */
static inline const char *engine_called(const struct engine *engine, const void *self)
{
    return engine->called ? engine->called(self) : "trace of raydiff's rays";
}

/* Whether an opened engine traces worlds. */
static inline bool engine_traces_worlds(const struct engine *engine, const void *self)
{
    return engine->worlds && (!engine->worlds->traces || engine->worlds->traces(self));
}

/* Whether an opened engine lists all hits of scenes. */
static inline bool engine_lists(const struct engine *engine, const void *self)
{
    return engine->trace_all && (!engine->lists || engine->lists(self));
}

/* For an engine that needs trees: false if it does not trace that layout (STATUS_UNSUPPORTED). */
static inline bool engine_takes(const struct engine *engine, const struct layout *layout)
{
    const bool own = engine->own_tri || engine->own_tree;
    return !(engine->binary && layout_is_wide(layout)) && !(own && layout->faithful);
}

/* NULL-terminated: the program's own, then what engine_add added. */
extern const struct engine *const *const engines;

/* Of each of three kinds from outside, a recorded answer, engines with compiled shaders, modes of
 * Embree, and variants of rayquery. */
#define ENGINES_OUTSIDE_MOST  4
#define ENGINES_COMPILED_MOST 32
#define ENGINES_EMBREE_MOST   240
#define ENGINES_RAYQUERY_MOST 128
#define ENGINES_ADDED_MOST                                                                         \
    (3 * ENGINES_OUTSIDE_MOST + 1 + ENGINES_COMPILED_MOST + ENGINES_EMBREE_MOST +                  \
     ENGINES_RAYQUERY_MOST)

/* Adds a copy of an engine at the end of the table, and puts it into *out; its name and what else
 * it points to are borrowed until the program ends. Call it only while no other thread reads the
 * table. Errors, on which *out is unchanged: STATUS_LIMIT more than ENGINES_ADDED_MOST. */
enum status engine_add(const struct engine *engine, const struct engine **out,
                       struct reason *reason) MUST_USE;

/* Returns the engine of that name, or NULL. */
const struct engine *engine_find(const char *name);

/* Returns the reference engine of the table, on packed trees or without them. */
const struct engine *engine_reference(bool packed);

#endif
