/* The binary protocol: what a peer writes, without the process. The input is what it answers to
 * each request in turn, a byte of length in front: first to the one that asks what it is, then to a
 * scene, then to rays; where it traces worlds, to a world and to rays, too. Linked with --wrap, so
 * that the child process is a file. */
#define _GNU_SOURCE /* pwrite, O_CLOEXEC */
#include "tests/readers/reader_entry.h"
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_child.h"
#include "scenes/scenes.h"

#include <fcntl.h>
#include <unistd.h>

#define RAYS 5

static struct {
    const char *at, *end; /* of the input: answers not yet given */
    off_t given;          /* bytes in the file */
} peer;

/* Of the same types, so that the compiler tells where one is changed. */
__typeof__(pipe_child_start) __wrap_pipe_child_start;
__typeof__(pipe_child_stop) __wrap_pipe_child_stop;
__typeof__(pipe_child_is_early) __wrap_pipe_child_is_early, __real_pipe_child_is_early;

/* Puts the next answer where the engine will look for it; past the last it finds the end. */
static void give_next(const struct pipe_child *child)
{
    if (peer.at == peer.end)
        return;
    size_t length = (unsigned char)*peer.at++, rest = (size_t)(peer.end - peer.at);
    length = length < rest ? length : rest;
    READER_MUST(pwrite(child->from, peer.at, length, peer.given) == (ssize_t)length);
    peer.at += length;
    peer.given += (off_t)length;
}

enum status __wrap_pipe_child_start(const struct pipe_order *order, struct pipe_child *out,
                                    struct reason *reason)
{
    char path[READER_PATH_MOST];
    (void)order, (void)reason;
    *out = (struct pipe_child){.guardian = {.pid = 0x7FFFFFFF}, .mute = true};
    out->from = reader_file("", 0, path);
    out->to = open("/dev/null", O_WRONLY | O_CLOEXEC);
    out->said_from = open("/dev/null", O_RDONLY | O_CLOEXEC);
    READER_MUST(out->to >= 0 && out->said_from >= 0);
    peer.given = 0;
    give_next(out);
    return STATUS_OK;
}

/* Asked before each request but the first. */
bool __wrap_pipe_child_is_early(struct pipe_child *child)
{
    bool early = __real_pipe_child_is_early(child);
    give_next(child);
    return early;
}

void __wrap_pipe_child_stop(struct pipe_child *child)
{
    if (pipe_child_runs(child)) {
        close(child->to);
        close(child->from);
        close(child->said_from);
    }
    *child = (struct pipe_child){0};
}

/* Answers name triangles of the scene, or the engine says whose fault it is. */
static bool ask(const struct engine *engine, void *self, const struct job *job)
{
    static const struct ray ray[RAYS] = {{{0, 0, -3}, 0, {0, 0, 1}, 1e30f}};
    struct hit hit[RAYS + 1];
    struct trace_report report;
    struct reason reason = {""};
    size_t at = 0;
    hit[RAYS] = (struct hit){.prim = 0xA5A5A5A5u};
    enum status status = engine->prepare(self, job, &reason);
    if (!status)
        status = engine->trace(self, ray, RAYS, hit, &report, &reason);
    READER_MUST(hit[RAYS].prim == 0xA5A5A5A5u);
    if (status) {
        READER_MUST(status == STATUS_DEVICE || status == STATUS_REFUSED);
        READER_MUST(status == STATUS_REFUSED || engine->fault(self, &at) != ENGINE_FINE);
        READER_MUST(at <= RAYS);
        reader_must_be_reason(&reason);
        return false;
    }
    for (size_t i = 0; i < RAYS; i++)
        READER_MUST(hit[i].prim == ABI_NO_PRIM || hit[i].prim < job->scene->tri_count);
    return true;
}

/* The same of a world. */
static bool ask_world(const struct engine *engine, void *self, const struct world_job *job)
{
    static const struct ray ray[RAYS] = {{{0, 0, -3}, 0, {0, 0, 1}, 1e30f}};
    const struct ray_mode mode[RAYS] = {{255, 0}, {255, ABI_RAY_FIRST}, {1, 0}};
    struct hit hit[RAYS + 1];
    uint32_t tag[RAYS + 1];
    struct trace_report report;
    struct reason reason = {""};
    size_t at = 0;
    hit[RAYS] = (struct hit){.prim = 0xA5A5A5A5u};
    tag[RAYS] = 0xA5A5A5A5u;
    enum status status = engine->worlds->prepare_world(self, job, &reason);
    if (!status)
        status = engine->worlds->trace_world(self, ray, mode, RAYS, hit, tag, &report, &reason);
    READER_MUST(hit[RAYS].prim == 0xA5A5A5A5u && tag[RAYS] == 0xA5A5A5A5u);
    if (status) {
        READER_MUST(status == STATUS_DEVICE || status == STATUS_REFUSED ||
                    (status == STATUS_UNSUPPORTED && !engine_traces_worlds(engine, self)));
        READER_MUST(status != STATUS_DEVICE || engine->fault(self, &at) != ENGINE_FINE);
        READER_MUST(at <= RAYS);
        reader_must_be_reason(&reason);
        return false;
    }
    for (size_t i = 0; i < RAYS; i++) {
        READER_MUST(hit[i].prim == ABI_NO_PRIM || hit[i].prim < world_tri_count(job->world));
        READER_MUST((tag[i] & ~ABI_TAG_FRONT) <= ABI_TAG_CUSTOM);
        READER_MUST(hit[i].prim != ABI_NO_PRIM || tag[i] == 0);
    }
    return true;
}

static bool play(const char *bytes, size_t size)
{
    const struct engine_options options = {.peer_ms = 5000, .peer_mb = UINT32_MAX};
    const struct engine *engine;
    struct scene scene;
    struct reason reason = {""};
    void *self = NULL;
    bool taken = false;
    peer.at = bytes;
    peer.end = bytes + size;
    READER_MUST(pipe_engine("pipe:peer", &engine, &reason) == STATUS_OK);
    READER_MUST(scene_open("soup:n=4,seed=1", 1, &scene, &reason) == STATUS_OK);
    enum status status = engine_open(engine, &options, &self, &reason);
    if (status) {
        READER_MUST(status == STATUS_DEVICE || status == STATUS_UNSUPPORTED);
        reader_must_be_reason(&reason);
    }
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY && !status; query++) {
        struct job job = {
            .scene = &scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
        taken = ask(engine, self, &job) || taken;
    }
    if (!status && engine_traces_worlds(engine, self)) {
        struct world world;
        READER_MUST(world_of_scene(&scene, &world, &reason) == STATUS_OK);
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct world_job job = {.world = &world, .tri = tri_tests[0], .query = query};
            taken = ask_world(engine, self, &job) || taken;
        }
        world_free(&world);
    }
    engine->close(self);
    scene_free(&scene);
    return taken;
}

const struct reader_entry reader_entry = {"peer", 1 << 18, play};
