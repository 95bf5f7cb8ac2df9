/* A guest (ref/raydiff_engine.h) for tests: $GUEST tells what it does. "good", and where nothing
 * else stands: hits that hold what the guest was given, so that a test can see whether it arrived.
 * With -DSYMBOL=NAME the object exports that instead of raydiff_engine. */
#ifdef SYMBOL
#define raydiff_engine SYMBOL
#endif
#include "ref/raydiff_engine.h"
#include "ref/plugin.h" /* both in one file */

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int is(const char *what)
{
    const char *guest = getenv("GUEST");
    return guest && strcmp(guest, what) == 0;
}

/* "move" and "move_...": it takes updates. */
static int moves(void)
{
    const char *guest = getenv("GUEST");
    return guest && strncmp(guest, "move", 4) == 0;
}

__attribute__((constructor)) static void load(void)
{
    if (is("load_crash"))
        abort(); /* cmocka catches SIGSEGV, also in its children */
    while (is("load_hang"))
        pause();
}

struct bad {
    uint32_t threads;
    struct raydiff_engine_mesh mesh;
    struct raydiff_engine_world world;
    unsigned moves; /* since the last build */
};

struct bad_rays {
    const struct raydiff_engine_ray *ray;
    size_t count;
    uint32_t query;
    struct raydiff_engine_hit hit[];
};

static int say(char *reason, int status, const char *why)
{
    snprintf(reason, RAYDIFF_ENGINE_REASON, "%s", why);
    return status;
}

static int open_bad(const struct raydiff_engine_options *options, void **self, char *reason)
{
    if (is("open_refuses"))
        return say(reason, RAYDIFF_ENGINE_REFUSED, "no such card");
    if (is("open_memory"))
        return say(reason, RAYDIFF_ENGINE_MEMORY, "of the card");
    if (is("open_fails"))
        return say(reason, RAYDIFF_ENGINE_FAILED, "the card is hot");
    if (is("open_nothing"))
        return RAYDIFF_ENGINE_OK;
    struct bad *bad = calloc(1, sizeof *bad);
    bad->threads = options->threads;
    *self = bad;
    return options->bytes == sizeof *options ? RAYDIFF_ENGINE_OK : 99;
}

static int build(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    ((struct bad *)self)->mesh = *mesh;
    ((struct bad *)self)->moves = 0;
    if (is("build_refuses"))
        return say(reason, RAYDIFF_ENGINE_REFUSED, "more than no triangle");
    if (is("build_bounded") && mesh->triangle_count > 100)
        return say(reason, RAYDIFF_ENGINE_REFUSED, "over 100 triangles");
    if (is("build_fails"))
        return say(reason, RAYDIFF_ENGINE_FAILED, "the tree fell");
    return is("build_99") ? 99 : RAYDIFF_ENGINE_OK;
}

static int move(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    struct bad *bad = self;
    if (mesh->vertex_count != bad->mesh.vertex_count ||
        mesh->triangle_count != bad->mesh.triangle_count)
        return say(reason, RAYDIFF_ENGINE_FAILED, "another scene");
    if (is("move_refuses"))
        return say(reason, RAYDIFF_ENGINE_REFUSED, "too far");
    if (is("move_crash"))
        abort();
    bad->mesh = *mesh;
    bad->moves++;
    return is("move_fails") ? RAYDIFF_ENGINE_FAILED : RAYDIFF_ENGINE_OK;
}

static void misbehave(void)
{
    if (is("crash")) {
        signal(SIGSEGV, SIG_DFL); /* a sanitizer has one of its own */
        raise(SIGSEGV);
    }
    if (is("exit"))
        exit(9);
    while (is("hang"))
        pause();
    while (is("memory")) {
        char *more = malloc(1 << 20);
        if (!more)
            abort();
        memset(more, 1, 1 << 20);
    }
    if (is("talks")) {
        printf("a line of text\n");
        fflush(stdout);
    }
    if (is("complains"))
        fprintf(stderr, "something is odd\n");
}

static void answer(const struct bad *bad, const struct raydiff_engine_ray *ray, size_t count,
                   uint32_t query, struct raydiff_engine_hit *hit)
{
    for (size_t i = 0; i < count; i++) {
        const struct raydiff_engine_mesh *mesh = &bad->mesh;
        if (is("lazy"))
            continue;
        const uint32_t triangle =
            mesh->triangle_count ? (uint32_t)i % mesh->triangle_count : RAYDIFF_ENGINE_NONE;
        hit[i] = (struct raydiff_engine_hit){1, 2, 3, triangle};
        if (triangle == RAYDIFF_ENGINE_NONE)
            continue;
        hit[i].t = mesh->vertex[3 * mesh->index[3 * triangle]] + ray[i].origin[0];
        hit[i].u = ray[i].direction[2] + (float)mesh->vertex_count + 1000 * (float)query;
        hit[i].v = ray[i].tmax + (float)bad->threads;
        if (moves())
            hit[i].v = (float)bad->moves;
        if (i == 5 && is("beyond"))
            hit[i].triangle = mesh->triangle_count;
        if (i % 3 == 1)
            hit[i].triangle = RAYDIFF_ENGINE_NONE;
    }
}

static int trace(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                 struct raydiff_engine_hit *hit, char *reason)
{
    misbehave();
    answer(self, ray, count, query, hit);
    if (is("trace_memory"))
        return say(reason, RAYDIFF_ENGINE_MEMORY, "for a stack");
    return is("trace_fails") ? say(reason, RAYDIFF_ENGINE_FAILED, "") : RAYDIFF_ENGINE_OK;
}

static int trace_all(void *self, const struct raydiff_engine_ray *ray, size_t count,
                     uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                     char *reason)
{
    const struct bad *bad = self;
    (void)ray;
    misbehave();
    if (is("all_refuses"))
        return say(reason, RAYDIFF_ENGINE_REFUSED, "lists are too long");
    for (size_t i = 0; i < count && !is("lazy"); i++) {
        hit_count[i] = bad->mesh.triangle_count * (is("all_thrice") ? 3 : 1);
        for (uint32_t k = 0; k < hit_count[i] && k < capacity; k++)
            hit[i * capacity + k] = (struct raydiff_engine_hit){
                1, 0, 0, is("all_misses") ? RAYDIFF_ENGINE_NONE : k + (is("all_beyond") ? 1 : 0)};
    }
    return RAYDIFF_ENGINE_OK;
}

static int build_world(void *self, const struct raydiff_engine_world *world, char *reason)
{
    (void)reason;
    ((struct bad *)self)->world = *world;
    return RAYDIFF_ENGINE_OK;
}

static uint32_t mixed(uint32_t hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 16777619u;
    return hash;
}

static uint32_t mixed_mesh(uint32_t hash, const struct raydiff_engine_world_mesh *mesh)
{
    hash = mixed(hash, mesh->mesh.vertex, 12 * (size_t)mesh->mesh.vertex_count);
    hash = mixed(hash, mesh->mesh.index, 12 * (size_t)mesh->mesh.triangle_count);
    for (uint32_t g = 0; g < mesh->geometry_count; g++) {
        const uint32_t words[] = {mesh->geometry[g].triangle_count, mesh->geometry[g].opaque};
        hash = mixed(hash, words, sizeof words);
    }
    return hash;
}

/* Ray i hits the last triangle of the last geometry of instance i, and holds a hash of all else:
 * of the instance and its mesh, of the ray, of what belongs to the query. A float has 24 bits of
 * each. */
static int trace_world(void *self, const struct raydiff_engine_world_ray *ray, size_t count,
                       uint32_t query, struct raydiff_engine_world_hit *hit, char *reason)
{
    const struct raydiff_engine_world *world = &((struct bad *)self)->world;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        const uint32_t number = (uint32_t)i % world->instance_count;
        const struct raydiff_engine_instance *instance = &world->instance[number];
        memset(&hit[i], 0, sizeof hit[i]);
        hit[i].instance =
            i == 2 && is("world_beyond") ? world->instance_count : RAYDIFF_ENGINE_NONE;
        if (hit[i].instance != RAYDIFF_ENGINE_NONE || instance->mesh == RAYDIFF_ENGINE_NONE)
            continue;
        const struct raydiff_engine_world_mesh *mesh = &world->mesh[instance->mesh];
        const uint32_t last = mesh->geometry_count - 1;
        if (mesh->geometry[last].triangle_count == 0)
            continue;
        const uint32_t of_instance[] = {instance->mesh, instance->custom, instance->mask,
                                        instance->flags};
        const uint32_t of_query[] = {query, world->filter_kind, world->filter_seed,
                                     world->filter_share};
        uint32_t place = mixed(1, of_instance, sizeof of_instance);
        place = mixed_mesh(mixed(place, instance->transform, 48), mesh);
        hit[i] =
            (struct raydiff_engine_world_hit){(float)(place >> 8),
                                              (float)(mixed(2, &ray[i], sizeof ray[i]) >> 8),
                                              (float)(mixed(3, of_query, sizeof of_query) >> 8),
                                              number,
                                              last,
                                              mesh->geometry[last].triangle_count - 1,
                                              number & 1,
                                              instance->custom};
    }
    return RAYDIFF_ENGINE_OK;
}

static int rays_make(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                     void **rays, char *reason)
{
    struct bad_rays *made = calloc(1, sizeof *made + count * sizeof *made->hit);
    (void)self, (void)reason;
    *made = (struct bad_rays){ray, count, query};
    *rays = made;
    if (is("slow_rays") || is("slow_rays_and_trace"))
        usleep(20000);
    return RAYDIFF_ENGINE_OK;
}

static int rays_trace(void *self, void *rays, char *reason)
{
    struct bad_rays *made = rays;
    if (is("slow_rays_and_trace"))
        usleep(200000);
    return trace(self, made->ray, made->count, made->query, made->hit, reason);
}

static void hits_read(void *self, const void *rays, struct raydiff_engine_hit *hit)
{
    const struct bad_rays *made = rays;
    (void)self;
    memcpy(hit, made->hit, made->count * sizeof *hit);
    if (is("slow_rays") || is("slow_rays_and_trace"))
        usleep(20000);
}

static void rays_free(void *self, void *rays)
{
    (void)self;
    free(rays);
}

static void model(void *self, struct raydiff_engine_model *out)
{
    (void)self;
    if (is("model"))
        *out = (struct raydiff_engine_model){RAYDIFF_ENGINE_WOOP, RAYDIFF_ENGINE_FLUSHED,
                                             RAYDIFF_ENGINE_WATERTIGHT, 0};
    if (is("model_displacement"))
        out->displacement = 7;
    if (is("model_unnamed"))
        out->flags = RAYDIFF_ENGINE_UNNAMED;
    if (is("model_formula"))
        out->formula = 8;
    if (is("model_flags"))
        out->flags = 8;
    if (is("model_both"))
        *out = (struct raydiff_engine_model){RAYDIFF_ENGINE_MT, 0, 0, 7};
    if (is("model_generous"))
        out->displacement = 8193;
    if (is("model_endless"))
        out->displacement = 1e30f;
}

static void memory(void *self, struct raydiff_engine_memory *out)
{
    const struct bad *bad = self;
    if (!is("memory_zero"))
        *out = (struct raydiff_engine_memory){100 + (UINT64_C(1) << 40) + bad->mesh.triangle_count,
                                              20, 3};
}

const struct raydiff_engine *raydiff_engine(void)
{
    static struct raydiff_engine engine;
    engine =
        (struct raydiff_engine){RAYDIFF_ENGINE_VERSION,
                                sizeof engine,
                                "bad",
                                "for tests",
                                RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_ALL |
                                    RAYDIFF_ENGINE_WORLDS | RAYDIFF_ENGINE_NATIVE,
                                0,
                                open_bad,
                                free,
                                build,
                                trace,
                                trace_all,
                                build_world,
                                trace_world,
                                rays_make,
                                rays_trace,
                                hits_read,
                                rays_free,
                                model,
                                memory,
                                move};
    /* A table of version 1 ends before its `move`: behind it stands anything. */
    const int old = is("old") || is("old_can");
    engine.version = old || is("old_long") ? 1 : engine.version + (is("version") ? 1 : 0);
    engine.bytes = old || is("new_short") ? offsetof(struct raydiff_engine, move) : engine.bytes;
    engine.bytes -= is("bytes") ? 4 : 0;
    engine.name = is("name") ? "7up" : engine.name;
    engine.can |= is("can") ? 64 : moves() || is("old_can") || is("no_move") ? 32 : 0;
    engine.move = is("no_move") ? NULL : engine.move;
    engine.can = is("neither") ? RAYDIFF_ENGINE_ALL : is("only_closest") ? 1 : engine.can;
    engine.memory = is("memory_none") ? NULL : engine.memory;
    engine.trace = is("no_trace") ? NULL : engine.trace;
    engine.close = is("no_close") ? NULL : engine.close;
    engine.rays_free = is("no_rays_free") ? NULL : engine.rays_free;
    engine.build_world = is("no_build_world") ? NULL : engine.build_world;
    return is("null") ? NULL : &engine;
}
