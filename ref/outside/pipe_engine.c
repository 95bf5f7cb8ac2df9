/* The engine "pipe:COMMAND". */
#include "ref/outside/pipe_peer.h"
#include "ref/outside/pipe_world.h"
#include "ref/outside/shared_object.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays of one request at most. The time limit is for one request. */
#define RAYS_MOST ((size_t)1 << 18)

struct pipe_tracer {
    struct pipe_peer peer;
    uint32_t triangles;         /* of the scene */
    enum query query;           /* of the scene or the world */
    const struct world *world;  /* NULL: a scene is prepared */
    char *words;                /* of the world */
    struct pipe_world_ray *ray; /* room for the rays of a request, and for its answers */
    struct pipe_world_hit *answer;
    size_t room;
};

static void tracer_close(void *self)
{
    struct pipe_tracer *tracer = self;
    if (!tracer)
        return;
    pipe_peer_end(&tracer->peer);
    free(tracer->words);
    free(tracer->ray);
    free(tracer->answer);
    free(tracer);
}

static enum status tracer_open(const struct engine *engine, const struct engine_options *options,
                               void **self, struct reason *reason)
{
    struct pipe_tracer *tracer = alloc_zeroed(1, sizeof *tracer);
    *self = NULL;
    if (!tracer)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    struct pipe_peer *peer = &tracer->peer;
    peer->name = engine->name;
    peer->options = *options;
    peer->options.peer_ms = options->peer_ms ? options->peer_ms : PEER_MS;
    peer->options.peer_mb = options->peer_mb ? options->peer_mb : PEER_MB;
    enum status status = pipe_peer_start(peer, reason);
    if (status)
        tracer_close(tracer);
    else
        *self = tracer;
    return status;
}

static bool is_unnamed(const struct pipe_tracer *tracer, bool first)
{
    return tracer->peer.model.any_unnamed && (first || tracer->query == QUERY_ANY);
}

/* --- scenes ----------------------------------------------------------------------------------- */

static bool tracer_lists(const void *self)
{
    return (((const struct pipe_tracer *)self)->peer.head.flags & PIPE_FLAG_LISTS) != 0;
}

static struct pipe_subject subject_of(const struct job *job)
{
    const struct scene *scene = job->scene;
    return (struct pipe_subject){
        .head = {.magic = {'R', 'D', 'R', 'Q'},
                 .version = PIPE_VERSION,
                 .query = (uint32_t)job->query,
                 .vertices = scene->vertex_count,
                 .triangles = scene->tri_count},
        .part = {{scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count},
                 {scene->index, 3 * sizeof(uint32_t) * (size_t)scene->tri_count}}};
}

/* Sends the scene with a request of no rays, so that the peer builds its tree outside the timed
 * calls, and can refuse the scene. */
static enum status tracer_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct pipe_tracer *tracer = self;
    struct pipe_peer *peer = &tracer->peer;
    if (job->query == QUERY_ALL && !tracer_lists(tracer))
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits: its %s", peer->name,
                    object_of_engine(peer->name) ? "`can` has no ALL" : "flags have no 16");
    tracer->world = NULL;
    tracer->triangles = job->scene->tri_count;
    tracer->query = job->query;
    peer->subject = subject_of(job);
    peer->has_subject = peer->moved = false;
    return pipe_peer_need(peer, reason);
}

static bool tracer_moves(const void *self)
{
    return (((const struct pipe_tracer *)self)->peer.head.flags & PIPE_FLAG_MOVES) != 0;
}

/* Sends the vertices alone, if the peer still has the scene before. */
static enum status tracer_move(void *self, const struct job *job, struct reason *reason)
{
    struct pipe_peer *peer = &((struct pipe_tracer *)self)->peer;
    peer->subject = subject_of(job);
    peer->moved = peer->has_subject;
    peer->has_subject = false;
    return pipe_peer_need(peer, reason);
}

/* Checks that all triangles are in the scene; an answer with another number is not judged. t, u and
 * v may be anything: the judge finds wrong ones. */
static enum status check_hits(struct pipe_tracer *tracer, const struct pipe_rays *rays,
                              struct hit *hit, struct reason *reason)
{
    char what[120];
    for (size_t i = 0; i < rays->count; i++) {
        if (hit[i].prim == ABI_NO_PRIM) {
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        } else if (hit[i].prim >= tracer->triangles) {
            snprintf(what, sizeof what, "its answer to ray %zu names triangle %u of %u",
                     rays->first + i, hit[i].prim, tracer->triangles);
            return pipe_peer_blame(&tracer->peer, rays->first + i, reason, what);
        } else if (is_unnamed(tracer, false)) {
            hit[i] = (struct hit){.prim = 0};
        }
    }
    return STATUS_OK;
}

/* Sends rays and has their answers; the time of that alone is added to the report. */
static enum status ask_peer(struct pipe_tracer *tracer, struct pipe_rays *rays,
                            struct trace_report *report, struct reason *reason)
{
    enum status status = pipe_peer_need(&tracer->peer, reason);
    uint64_t start = time_ns();
    if (!status)
        status = pipe_peer_ask(&tracer->peer, rays, reason);
    report->ns += time_ns() - start;
    report->core_ns = report->ns; /* this thread only waits */
    return status;
}

static void report_memory(const struct pipe_tracer *tracer, struct trace_report *report)
{
    const struct pipe_memory *memory = &tracer->peer.memory;
    pipe_memory_report(memory->tree, memory->scene, memory->other, report);
}

static enum status tracer_trace(void *self, const struct ray *ray, size_t ray_count,
                                struct hit *hit, struct trace_report *report, struct reason *reason)
{
    struct pipe_tracer *tracer = self;
    *report = (struct trace_report){0};
    for (size_t first = 0; first < ray_count; first += RAYS_MOST) {
        size_t rest = ray_count - first;
        struct pipe_rays rays = {.first = first,
                                 .count = rest < RAYS_MOST ? rest : RAYS_MOST,
                                 .ray = ray + first,
                                 .answer = hit + first,
                                 .ray_bytes = sizeof *ray,
                                 .answer_bytes = sizeof *hit};
        enum status status = ask_peer(tracer, &rays, report, reason);
        if (!status)
            status = check_hits(tracer, &rays, hit + first, reason);
        if (status)
            return status;
    }
    report_memory(tracer, report);
    return STATUS_OK;
}

static enum status check_lists(struct pipe_tracer *tracer, const struct pipe_rays *rays,
                               const struct hit *hit, struct reason *reason)
{
    struct reason why;
    char what[200];
    for (size_t i = 0; i < rays->count; i++) {
        if (pipe_list_check(hit + i * rays->capacity, rays->list[i], rays->capacity,
                            tracer->triangles, &why) == STATUS_OK)
            continue;
        snprintf(what, sizeof what, "its list of ray %zu %.150s", rays->first + i, why.text);
        return pipe_peer_blame(&tracer->peer, rays->first + i, reason, what);
    }
    return STATUS_OK;
}

static enum status tracer_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                    uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                    struct reason *reason)
{
    struct pipe_tracer *tracer = self;
    struct trace_report report = {.ns = 0};
    for (size_t first = 0; first < ray_count; first += RAYS_MOST) {
        size_t rest = ray_count - first;
        struct pipe_rays rays = {.first = first,
                                 .count = rest < RAYS_MOST ? rest : RAYS_MOST,
                                 .ray = ray + first,
                                 .answer = hit + first * capacity,
                                 .ray_bytes = sizeof *ray,
                                 .answer_bytes = sizeof *hit,
                                 .list = hit_count + first,
                                 .capacity = capacity};
        enum status status = ask_peer(tracer, &rays, &report, reason);
        if (!status)
            status = check_lists(tracer, &rays, hit + first * capacity, reason);
        if (status)
            return status;
    }
    return STATUS_OK;
}

/* --- worlds ----------------------------------------------------------------------------------- */

static bool tracer_traces(const void *self)
{
    return (((const struct pipe_tracer *)self)->peer.head.flags & PIPE_FLAG_WORLDS) != 0;
}

static enum status tracer_prepare_world(void *self, const struct world_job *job,
                                        struct reason *reason)
{
    struct pipe_tracer *tracer = self;
    struct pipe_peer *peer = &tracer->peer;
    size_t size;
    if (!tracer_traces(tracer))
        return fail(reason, STATUS_UNSUPPORTED, "%.80s traces scenes, not worlds: its %s",
                    peer->name,
                    object_of_engine(peer->name) ? "`can` has no WORLDS" : "flags have no 8");
    if (job->query == QUERY_ALL)
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits", peer->name);
    free(tracer->words);
    tracer->words = pipe_world_words(job->world, &size);
    if (!tracer->words)
        return fail(reason, STATUS_MEMORY, "%.80s: no memory for a world", peer->name);
    tracer->world = job->world;
    tracer->query = job->query;
    peer->subject = (struct pipe_subject){.head = {.magic = {'R', 'D', 'R', 'Q'},
                                                   .version = PIPE_VERSION_WORLD,
                                                   .query = (uint32_t)job->query,
                                                   .vertices = job->world->mesh_count,
                                                   .triangles = job->world->instance_count},
                                          .part = {{tracer->words, size}}};
    peer->has_subject = peer->moved = false;
    return pipe_peer_need(peer, reason);
}

static bool make_room(struct pipe_tracer *tracer, size_t count)
{
    if (tracer->room >= count)
        return true;
    free(tracer->ray);
    free(tracer->answer);
    tracer->ray = alloc_zeroed(count, sizeof *tracer->ray);
    tracer->answer = alloc_zeroed(count, sizeof *tracer->answer);
    tracer->room = tracer->ray && tracer->answer ? count : 0;
    return tracer->room == count;
}

/* Checks the answers of one request and converts them. */
static enum status take_answers(struct pipe_tracer *tracer, const struct pipe_rays *rays,
                                const struct ray_mode *mode, struct hit *hit, uint32_t *tag,
                                struct reason *reason)
{
    for (size_t i = 0; i < rays->count; i++) {
        struct reason why;
        char what[200];
        bool first = mode && (mode[i].flags & ABI_RAY_FIRST);
        if (pipe_world_take(tracer->world, &tracer->answer[i], is_unnamed(tracer, first), &hit[i],
                            &tag[i], &why) == STATUS_OK)
            continue;
        snprintf(what, sizeof what, "its answer to ray %zu %.150s", rays->first + i, why.text);
        return pipe_peer_blame(&tracer->peer, rays->first + i, reason, what);
    }
    return STATUS_OK;
}

static enum status tracer_trace_world(void *self, const struct ray *ray,
                                      const struct ray_mode *mode, size_t ray_count,
                                      struct hit *hit, uint32_t *tag, struct trace_report *report,
                                      struct reason *reason)
{
    struct pipe_tracer *tracer = self;
    *report = (struct trace_report){0};
    if (!make_room(tracer, ray_count < RAYS_MOST ? ray_count : RAYS_MOST))
        return fail(reason, STATUS_MEMORY, "%.80s: no memory for rays", tracer->peer.name);
    for (size_t first = 0; first < ray_count; first += RAYS_MOST) {
        size_t rest = ray_count - first;
        const struct ray_mode *some = mode ? mode + first : NULL;
        struct pipe_rays rays = {.first = first,
                                 .count = rest < RAYS_MOST ? rest : RAYS_MOST,
                                 .ray = tracer->ray,
                                 .answer = tracer->answer,
                                 .ray_bytes = sizeof *tracer->ray,
                                 .answer_bytes = sizeof *tracer->answer};
        for (size_t i = 0; i < rays.count; i++)
            tracer->ray[i] =
                (struct pipe_world_ray){ray[first + i], some ? some[i] : ray_mode_all()};
        enum status status = ask_peer(tracer, &rays, report, reason);
        if (!status)
            status = take_answers(tracer, &rays, some, hit + first, tag + first, reason);
        if (status)
            return status;
    }
    report_memory(tracer, report);
    return STATUS_OK;
}

static const struct world_tracer tracer_worlds = {.prepare_world = tracer_prepare_world,
                                                  .trace_world = tracer_trace_world,
                                                  .traces = tracer_traces};

/* --- the engines ------------------------------------------------------------------------------ */

static enum engine_fault tracer_fault(void *self, size_t *ray)
{
    const struct pipe_tracer *tracer = self;
    *ray = tracer->peer.fault_ray;
    return tracer->peer.fault;
}

/* In worlds transforms are its own, and no formula of ours has these. */
static struct model tracer_model(const struct engine *engine, void *self,
                                 const struct tri_test *tri)
{
    (void)engine;
    const struct pipe_tracer *tracer = self;
    struct model model = tracer->peer.model;
    (void)tri;
    if (tracer->world)
        model.formula = TWIN_UNKNOWN;
    return model;
}

static void tracer_describe(const struct engine *engine, const struct engine_options *options,
                            char *text, size_t text_bytes)
{
    const size_t prefix = strlen(PIPE_PREFIX);
    (void)options;
    if (strncmp(engine->name, PIPE_PREFIX, prefix) == 0)
        snprintf(text, text_bytes, "the command %s", engine->name + prefix);
    else
        snprintf(text, text_bytes, "the shared object %s, in a process of its own", engine->name);
}

static const struct engine tracers = {
    .summary = "a tracer in a process of its own",
    .own_tri = true,
    .open = tracer_open,
    .prepare = tracer_prepare,
    .move = tracer_move,
    .moves = tracer_moves,
    .trace = tracer_trace,
    .trace_all = tracer_trace_all,
    .lists = tracer_lists,
    .model = tracer_model,
    .fault = tracer_fault,
    .worlds = &tracer_worlds,
    .close = tracer_close,
    .describe = tracer_describe,
};

enum status pipe_engine(const char *name, const struct engine **out, struct reason *reason)
{
    static char names[ENGINES_OUTSIDE_MOST][PIPE_NAME_MOST];
    static size_t count;
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    size_t length = strlen(name);
    if (!pipe_is_peer(name) || strcmp(name, PIPE_PREFIX) == 0)
        return fail(reason, STATUS_INPUT, "'%.60s' is not pipe:COMMAND or FILE.so", name);
    if (length >= PIPE_NAME_MOST)
        return fail(reason, STATUS_INPUT, "'%.40s...' is longer than %d characters", name,
                    PIPE_NAME_MOST - 1);
    if (count == ARRAY_COUNT(names))
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d peers", name, ENGINES_OUTSIDE_MOST);
    struct engine engine = tracers;
    engine.name = memcpy(names[count], name, length + 1);
    enum status status = engine_add(&engine, out, reason);
    count += !status;
    return status;
}
