#include "ref/guest/guest_engine.h"

#include "ref/guest/guest.h"
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_world.h"
#include "ref/outside/shared_object.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A tracer in this process, and what it is prepared for. */
struct inmate {
    struct guest guest;
    struct model model;
    enum query query;
    uint32_t triangles;        /* of the scene */
    const struct world *world; /* NULL: a scene is prepared */
    char *words;               /* of the world; the guest points into it */
    struct raydiff_engine_world_mesh *mesh;
    struct raydiff_engine_world_ray *ray; /* room for the rays of a world, and for its answers */
    struct raydiff_engine_world_hit *answer;
    size_t room;
};

static void inmate_close(void *self)
{
    struct inmate *inmate = self;
    if (!inmate)
        return;
    guest_close(&inmate->guest);
    free(inmate->words);
    free(inmate->mesh);
    free(inmate->ray);
    free(inmate->answer);
    free(inmate);
}

static enum status inmate_open(const struct engine *engine, const struct engine_options *options,
                               void **self, struct reason *reason)
{
    struct inmate *inmate = alloc_zeroed(1, sizeof *inmate);
    *self = NULL;
    if (!inmate)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    enum status status = guest_load(engine->name + strlen(GUEST_PREFIX), &inmate->guest, reason);
    if (!status)
        status = guest_open(&inmate->guest, options->threads, reason);
    if (!status)
        status = guest_model(&inmate->guest, &inmate->model, reason);
    if (status)
        inmate_close(inmate);
    else
        *self = inmate;
    return status;
}

/* --- scenes ----------------------------------------------------------------------------------- */

static struct raydiff_engine_mesh mesh_of(const struct scene *scene)
{
    return (struct raydiff_engine_mesh){.vertex = scene->vertex,
                                        .index = scene->index,
                                        .vertex_count = scene->vertex_count,
                                        .triangle_count = scene->tri_count};
}

static enum status inmate_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct inmate *inmate = self;
    const struct scene *scene = job->scene;
    const struct raydiff_engine_mesh mesh = mesh_of(scene);
    if (job->query == QUERY_ALL && !guest_can(&inmate->guest, RAYDIFF_ENGINE_ALL))
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits: its `can` has no ALL",
                    inmate->guest.path);
    inmate->world = NULL;
    inmate->triangles = scene->tri_count;
    inmate->query = job->query;
    return guest_build(&inmate->guest, &mesh, reason);
}

static bool inmate_moves(const void *self)
{
    return guest_can(&((const struct inmate *)self)->guest, RAYDIFF_ENGINE_MOVE);
}

static enum status inmate_move(void *self, const struct job *job, struct reason *reason)
{
    const struct raydiff_engine_mesh mesh = mesh_of(job->scene);
    return guest_move(&((struct inmate *)self)->guest, &mesh, reason);
}

/* Checks that a hit's triangle is in the scene; t, u and v may be anything: the judge finds wrong
 * ones. */
static enum status check_hit(const struct inmate *inmate, size_t ray, struct hit *hit,
                             struct reason *reason)
{
    if (hit->prim == ABI_NO_PRIM)
        *hit = (struct hit){.prim = ABI_NO_PRIM};
    else if (hit->prim >= inmate->triangles)
        return fail(reason, STATUS_DEVICE, "%.80s: its answer to ray %zu names triangle %u of %u",
                    inmate->guest.path, ray, hit->prim, inmate->triangles);
    else if (inmate->model.any_unnamed && inmate->query == QUERY_ANY)
        *hit = (struct hit){.prim = 0};
    return STATUS_OK;
}

/* What counts of a time: tracing, and of conversions what they take beyond half of that. Without
 * that a guest could trace while it makes its rays. */
static uint64_t counted(uint64_t all, uint64_t tracing)
{
    const uint64_t conversions = all - tracing, free_of_charge = tracing / 2;
    return tracing + (conversions > free_of_charge ? conversions - free_of_charge : 0);
}

/* Traces rays in the guest's own form. */
static enum status trace_native(struct inmate *inmate, const struct ray *ray, size_t count,
                                struct hit *hit, struct trace_report *report, struct reason *reason)
{
    struct guest *guest = &inmate->guest;
    void *rays;
    const uint64_t start = time_ns(), core = core_time_ns();
    enum status status =
        guest_rays_make(guest, (const void *)ray, count, (uint32_t)inmate->query, &rays, reason);
    const uint64_t made = time_ns(), made_core = core_time_ns();
    if (!status)
        status = guest_rays_trace(guest, rays, reason);
    const uint64_t tracing_core = core_time_ns() - made_core, tracing = time_ns() - made;
    if (!status)
        guest->table->hits_read(guest->self, rays, (void *)hit);
    report->core_ns = counted(core_time_ns() - core, tracing_core);
    report->ns = counted(time_ns() - start, tracing);
    if (rays)
        guest->table->rays_free(guest->self, rays);
    return status;
}

static enum status trace_plain(struct inmate *inmate, const struct ray *ray, size_t count,
                               struct hit *hit, struct trace_report *report, struct reason *reason)
{
    const uint64_t start = time_ns(), core = core_time_ns();
    enum status status = guest_trace(&inmate->guest, (const void *)ray, count,
                                     (uint32_t)inmate->query, (void *)hit, reason);
    report->core_ns = core_time_ns() - core;
    report->ns = time_ns() - start;
    return status;
}

static void report_memory(const struct inmate *inmate, struct trace_report *report)
{
    const struct raydiff_engine_memory memory = guest_memory(&inmate->guest);
    pipe_memory_report(memory.tree_bytes, memory.scene_bytes, memory.other_bytes, report);
}

static enum status inmate_trace(void *self, const struct ray *ray, size_t ray_count,
                                struct hit *hit, struct trace_report *report, struct reason *reason)
{
    struct inmate *inmate = self;
    *report = (struct trace_report){.ns = 0};
    enum status status = STATUS_OK;
    if (inmate->query != QUERY_ALL) /* else there are no rays: inmate_trace_all has them */
        status = guest_can(&inmate->guest, RAYDIFF_ENGINE_NATIVE)
                     ? trace_native(inmate, ray, ray_count, hit, report, reason)
                     : trace_plain(inmate, ray, ray_count, hit, report, reason);
    report_memory(inmate, report);
    for (size_t i = 0; i < ray_count && !status; i++)
        status = check_hit(inmate, i, &hit[i], reason);
    return status;
}

static bool inmate_lists(const void *self)
{
    return guest_can(&((const struct inmate *)self)->guest, RAYDIFF_ENGINE_ALL);
}

static enum status inmate_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                    uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                    struct reason *reason)
{
    struct inmate *inmate = self;
    struct reason why;
    enum status status = guest_trace_all(&inmate->guest, (const void *)ray, ray_count, capacity,
                                         (void *)hit, hit_count, reason);
    for (size_t i = 0; i < ray_count && !status; i++)
        if (pipe_list_check(hit + i * capacity, hit_count[i], capacity, inmate->triangles, &why))
            status = fail(reason, STATUS_DEVICE, "%.80s: its list of ray %zu %.150s",
                          inmate->guest.path, i, why.text);
    return status;
}

/* --- worlds ----------------------------------------------------------------------------------- */

static bool inmate_traces(const void *self)
{
    return guest_can(&((const struct inmate *)self)->guest, RAYDIFF_ENGINE_WORLDS);
}

static enum status inmate_prepare_world(void *self, const struct world_job *job,
                                        struct reason *reason)
{
    struct inmate *inmate = self;
    struct raydiff_engine_world world;
    size_t size;
    if (!inmate_traces(inmate))
        return fail(reason, STATUS_UNSUPPORTED, "%.80s traces scenes, not worlds",
                    inmate->guest.path);
    if (job->query == QUERY_ALL)
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits of a world",
                    inmate->guest.path);
    free(inmate->words);
    free(inmate->mesh);
    inmate->mesh = NULL;
    inmate->words = pipe_world_words(job->world, &size);
    if (inmate->words)
        inmate->mesh =
            guest_world(inmate->words, job->world->mesh_count, job->world->instance_count, &world);
    if (!inmate->mesh)
        return fail(reason, STATUS_MEMORY, "%.80s: no memory for a world", inmate->guest.path);
    inmate->world = job->world;
    inmate->query = job->query;
    return guest_build_world(&inmate->guest, &world, reason);
}

static bool make_room(struct inmate *inmate, size_t count)
{
    if (inmate->room >= count && inmate->ray && inmate->answer)
        return true;
    free(inmate->ray);
    free(inmate->answer);
    inmate->ray = alloc_zeroed(count, sizeof *inmate->ray);
    inmate->answer = alloc_zeroed(count, sizeof *inmate->answer);
    inmate->room = inmate->ray && inmate->answer ? count : 0;
    return inmate->ray && inmate->answer;
}

static enum status take_answers(struct inmate *inmate, const struct ray_mode *mode, size_t count,
                                struct hit *hit, uint32_t *tag, struct reason *reason)
{
    for (size_t i = 0; i < count; i++) {
        struct reason why;
        struct pipe_world_hit answer;
        const bool first = mode && (mode[i].flags & ABI_RAY_FIRST);
        memcpy(&answer, &inmate->answer[i], sizeof answer);
        if (pipe_world_take(inmate->world, &answer,
                            inmate->model.any_unnamed && (first || inmate->query == QUERY_ANY),
                            &hit[i], &tag[i], &why))
            return fail(reason, STATUS_DEVICE, "%.80s: its answer to ray %zu %.150s",
                        inmate->guest.path, i, why.text);
    }
    return STATUS_OK;
}

static enum status inmate_trace_world(void *self, const struct ray *ray,
                                      const struct ray_mode *mode, size_t ray_count,
                                      struct hit *hit, uint32_t *tag, struct trace_report *report,
                                      struct reason *reason)
{
    struct inmate *inmate = self;
    *report = (struct trace_report){.ns = 0};
    if (!make_room(inmate, ray_count))
        return fail(reason, STATUS_MEMORY, "%.80s: no memory for rays", inmate->guest.path);
    for (size_t i = 0; i < ray_count; i++) {
        const struct pipe_world_ray one = {ray[i], mode ? mode[i] : ray_mode_all()};
        memcpy(&inmate->ray[i], &one, sizeof one);
    }
    memset(inmate->answer, 0xFE, ray_count * sizeof *inmate->answer);
    const uint64_t start = time_ns(), core = core_time_ns();
    enum status status = guest_trace_world(&inmate->guest, inmate->ray, ray_count,
                                           (uint32_t)inmate->query, inmate->answer, reason);
    report->core_ns = core_time_ns() - core;
    report->ns = time_ns() - start;
    report_memory(inmate, report);
    return status ? status : take_answers(inmate, mode, ray_count, hit, tag, reason);
}

static const struct world_tracer inmate_worlds = {.prepare_world = inmate_prepare_world,
                                                  .trace_world = inmate_trace_world,
                                                  .traces = inmate_traces};

/* --- the engines ------------------------------------------------------------------------------ */

/* In worlds transforms are its own, and no formula of ours has these. */
static struct model inmate_model(const struct engine *engine, void *self,
                                 const struct tri_test *tri)
{
    (void)engine;
    const struct inmate *inmate = self;
    struct model model = inmate->model;
    (void)tri;
    if (inmate->world)
        model.formula = TWIN_UNKNOWN;
    return model;
}

static const char *inmate_called(const void *self)
{
    return guest_can(&((const struct inmate *)self)->guest, RAYDIFF_ENGINE_NATIVE)
               ? "rays_trace of its own rays"
               : "trace of raydiff's rays";
}

static void inmate_describe(const struct engine *engine, const struct engine_options *options,
                            char *text, size_t text_bytes)
{
    (void)options;
    snprintf(text, text_bytes, "the shared object %s", engine->name + strlen(GUEST_PREFIX));
}

static const struct engine inmates = {
    .summary = "a tracer in a shared object",
    .own_tri = true,
    .open = inmate_open,
    .prepare = inmate_prepare,
    .move = inmate_move,
    .moves = inmate_moves,
    .trace = inmate_trace,
    .trace_all = inmate_trace_all,
    .lists = inmate_lists,
    .model = inmate_model,
    .worlds = &inmate_worlds,
    .called = inmate_called,
    .close = inmate_close,
    .describe = inmate_describe,
};

enum status guest_engine(const char *name, const struct engine **out, struct reason *reason)
{
    static char names[ENGINES_OUTSIDE_MOST][GUEST_PATH_MOST + sizeof GUEST_PREFIX];
    static size_t count;
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    const char *path = object_of_engine(name);
    if (!path || path == name)
        return fail(reason, STATUS_INPUT, "'%.60s' is not inside:FILE.so", name);
    if (strlen(name) >= GUEST_PATH_MOST + strlen(GUEST_PREFIX))
        return fail(reason, STATUS_INPUT, "'%.40s...' is a path of over %d characters", name,
                    GUEST_PATH_MOST - 1);
    if (count == ARRAY_COUNT(names))
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d engines from outside", name,
                    ENGINES_OUTSIDE_MOST);
    struct engine engine = inmates;
    engine.name = strcpy(names[count], name);
    enum status status = engine_add(&engine, out, reason);
    count += !status;
    return status;
}
