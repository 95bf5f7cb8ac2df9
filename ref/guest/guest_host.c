#define _GNU_SOURCE /* F_DUPFD_CLOEXEC */
#include "ref/guest/guest_host.h"

#include "ref/outside/pipe.h"
#include "ref/outside/pipe_world.h"
#include "ref/outside/shared_object.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXIT_FAILED 3
#define HEAD_WORDS  4u /* of the filter, and of a mesh */

_Static_assert(sizeof(struct raydiff_engine_ray) == sizeof(struct ray), "rays are the same");
_Static_assert(sizeof(struct raydiff_engine_hit) == sizeof(struct hit), "hits are the same");
_Static_assert(sizeof(struct raydiff_engine_world_ray) == sizeof(struct pipe_world_ray), "rays");
_Static_assert(sizeof(struct raydiff_engine_world_hit) == sizeof(struct pipe_world_hit), "hits");
_Static_assert(sizeof(struct raydiff_engine_geometry) == 16, "geometries as they are sent");
_Static_assert(sizeof(struct raydiff_engine_instance) == 64, "instances as they are sent");

struct host {
    struct guest guest;
    int in, out;
    char *subject; /* as it was sent; the guest may point into it */
    size_t subject_size, subject_room;
    struct raydiff_engine_world_mesh *mesh;
    char *ray, *answer; /* of one request; before the answers of lists are the numbers of hits */
    size_t ray_room, answer_room;
    struct reason refused; /* of the subject; empty: accepted */
};

/* --- bytes ------------------------------------------------------------------------------------ */

/* Returns false at the end of the input. */
static bool read_all(const struct host *host, void *to, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t got = read(host->in, (char *)to + done, size - done);
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        done += got > 0 ? (size_t)got : 0;
    }
    return true;
}

static bool write_all(const struct host *host, const void *from, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t put = write(host->out, (const char *)from + done, size - done);
        if (put < 0 && errno != EINTR)
            return false;
        done += put > 0 ? (size_t)put : 0;
    }
    return true;
}

/* Reads so many bytes behind what there is of the subject; *at is where they begin. */
static bool read_more(struct host *host, size_t size, size_t *at)
{
    *at = host->subject_size;
    if (array_reserve(&host->subject, &host->subject_room, *at + size + 1, 1) ||
        !read_all(host, host->subject + *at, size))
        return false;
    host->subject_size += size;
    return true;
}

/* --- requests --------------------------------------------------------------------------------- */

/* Reads a world as pipe_world_words writes it. */
static bool read_world(struct host *host, const struct pipe_request *request)
{
    size_t at;
    bool fine = read_more(host, HEAD_WORDS * sizeof(uint32_t), &at);
    for (uint32_t i = 0; fine && i < request->vertices; i++) {
        uint32_t head[HEAD_WORDS];
        fine = read_more(host, sizeof head, &at);
        if (!fine)
            break;
        memcpy(head, host->subject + at, sizeof head);
        fine = read_more(host,
                         12 * ((size_t)head[0] + head[1]) +
                             sizeof(struct raydiff_engine_geometry) * (size_t)head[2],
                         &at);
    }
    return fine &&
           read_more(host, sizeof(struct raydiff_engine_instance) * (size_t)request->triangles,
                     &at);
}

static struct raydiff_engine_mesh mesh_of(const struct host *host,
                                          const struct pipe_request *request)
{
    return (struct raydiff_engine_mesh){
        .vertex = (const void *)host->subject,
        .index = (const void *)(host->subject + 12 * (size_t)request->vertices),
        .vertex_count = request->vertices,
        .triangle_count = request->triangles};
}

/* Builds from the subject that was read. A refusal is kept, for this subject's later requests. */
static enum status build(struct host *host, const struct pipe_request *request,
                         struct reason *reason)
{
    enum status status;
    if (request->version == PIPE_VERSION_WORLD) {
        struct raydiff_engine_world world;
        free(host->mesh);
        host->mesh = guest_world(host->subject, request->vertices, request->triangles, &world);
        status = host->mesh ? guest_build_world(&host->guest, &world, reason)
                            : fail(reason, STATUS_MEMORY, "no memory for a world");
    } else {
        const struct raydiff_engine_mesh mesh = mesh_of(host, request);
        status = request->same == PIPE_SAME_MOVED ? guest_move(&host->guest, &mesh, reason)
                                                  : guest_build(&host->guest, &mesh, reason);
    }
    if (status == STATUS_REFUSED)
        host->refused = *reason;
    return status == STATUS_REFUSED ? STATUS_OK : status;
}

/* Returns false at the end of the input. */
static bool read_subject(struct host *host, const struct pipe_request *request)
{
    size_t at;
    if (request->same == PIPE_SAME_MOVED)
        return 12 * ((size_t)request->vertices + request->triangles) == host->subject_size &&
               read_all(host, host->subject, 12 * (size_t)request->vertices);
    host->subject_size = 0;
    host->refused.text[0] = '\0';
    if (request->version == PIPE_VERSION_WORLD)
        return read_world(host, request);
    return read_more(host, 12 * ((size_t)request->vertices + request->triangles), &at);
}

static enum status trace(struct host *host, const struct pipe_request *request,
                         struct reason *reason)
{
    const size_t count = request->rays;
    if (request->version == PIPE_VERSION_WORLD)
        return guest_trace_world(&host->guest, (const void *)host->ray, count, request->query,
                                 (void *)host->answer, reason);
    if (request->query == PIPE_QUERY_LISTS)
        return guest_trace_all(&host->guest, (const void *)host->ray, count, request->zero,
                               (void *)(host->answer + count * sizeof(uint32_t)),
                               (void *)host->answer, reason);
    return guest_trace(&host->guest, (const void *)host->ray, count, request->query,
                       (void *)host->answer, reason);
}

/* --- answers ---------------------------------------------------------------------------------- */

static bool refuse(struct host *host, struct pipe_answer head, const char *why)
{
    char prefix[GUEST_PATH_MOST + 16];
    snprintf(prefix, sizeof prefix, "%.80s refused: ", host->guest.path);
    if (strncmp(why, prefix, strlen(prefix)) == 0) /* the reader puts its name before it, too */
        why += strlen(prefix);
    const size_t length = strlen(why);
    head.refused = 1;
    head.count = (uint32_t)(length < PIPE_REFUSED_MOST ? length : PIPE_REFUSED_MOST);
    return write_all(host, &head, sizeof head) && write_all(host, why, head.count);
}

static struct pipe_answer head_of(const struct host *host, const struct pipe_request *request)
{
    struct pipe_answer head = {
        .magic = {'R', 'D', 'R', 'A'}, .version = request->version, .count = request->rays};
    if (!host->guest.self)
        return head;
    const struct raydiff_engine_model model = guest_promise(&host->guest);
    head.formula = model.formula;
    head.rounding = model.rounding;
    head.flags = model.flags & ~PIPE_FLAGS_CAN; /* these would be taken for what it can */
    head.flags |= model.flags & PIPE_FLAGS_CAN ? 2 * PIPE_FLAG_MOVES : 0u;
    head.flags |= guest_can(&host->guest, RAYDIFF_ENGINE_WORLDS) ? PIPE_FLAG_WORLDS : 0u;
    head.flags |= guest_can(&host->guest, RAYDIFF_ENGINE_ALL) ? PIPE_FLAG_LISTS : 0u;
    head.flags |= host->guest.table->memory ? PIPE_FLAG_MEMORY : 0u;
    head.flags |= guest_can(&host->guest, RAYDIFF_ENGINE_MOVE) ? PIPE_FLAG_MOVES : 0u;
    head.zero = float_bits(model.displacement);
    return head;
}

static bool is_lists(const struct pipe_request *request)
{
    return request->version == PIPE_VERSION && request->query == PIPE_QUERY_LISTS;
}

/* Bytes of the room for the answers to a request's rays. */
static size_t room_of(const struct pipe_request *request)
{
    const size_t rays = request->rays;
    if (is_lists(request))
        return rays * (sizeof(uint32_t) + request->zero * sizeof(struct hit));
    return rays * (request->version == PIPE_VERSION_WORLD ? sizeof(struct pipe_world_hit)
                                                          : sizeof(struct hit));
}

/* Moves lists together, behind their numbers; returns the bytes of both. */
static size_t pack_lists(char *answer, const struct pipe_request *request)
{
    const uint32_t *number = (const void *)answer;
    struct hit *hit = (void *)(answer + request->rays * sizeof *number);
    size_t total = 0;
    for (size_t i = 0; i < request->rays; i++) {
        const uint32_t count = number[i] < request->zero ? number[i] : request->zero;
        memmove(hit + total, hit + i * request->zero, count * sizeof *hit);
        total += count;
    }
    return request->rays * sizeof *number + total * sizeof *hit;
}

/* Writes an answer that is no refusal. */
static bool write_answer(struct host *host, const struct pipe_request *request,
                         const struct pipe_answer *head, bool opening)
{
    const size_t bytes = is_lists(request) ? pack_lists(host->answer, request) : room_of(request);
    bool fine = write_all(host, head, sizeof *head);
    if (!opening && (head->flags & PIPE_FLAG_MEMORY)) {
        const struct raydiff_engine_memory memory = guest_memory(&host->guest);
        const uint64_t told[] = {memory.tree_bytes, memory.scene_bytes, memory.other_bytes};
        uint32_t word[2 * ARRAY_COUNT(told)];
        for (size_t i = 0; i < ARRAY_COUNT(word); i++)
            word[i] = (uint32_t)(told[i / 2] >> 32 * (i % 2));
        fine = fine && write_all(host, word, sizeof word);
    }
    return fine && write_all(host, host->answer, bytes);
}

/* Answers a request that was read but for its rays. Returns false at the end of the input. */
static bool answer(struct host *host, const struct pipe_request *request, bool opening,
                   enum status *status, struct reason *reason)
{
    const bool world = request->version == PIPE_VERSION_WORLD;
    const size_t rays = request->rays, bytes = room_of(request),
                 ray_bytes = rays * (world ? sizeof(struct pipe_world_ray) : sizeof(struct ray));
    *status = STATUS_OK;
    if (array_reserve(&host->ray, &host->ray_room, ray_bytes + 1, 1) ||
        array_reserve(&host->answer, &host->answer_room, bytes + 1, 1)) {
        *status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", rays);
        return true;
    }
    if (!read_all(host, host->ray, ray_bytes))
        return false;
    const struct pipe_answer head = head_of(host, request);
    if (host->refused.text[0])
        return refuse(host, head, host->refused.text);
    /* What the guest leaves out names a triangle that is not there, or is a list too long. */
    memset(host->answer, 0xFE, bytes);
    if (!opening && rays > 0)
        *status = trace(host, request, reason);
    if (*status == STATUS_REFUSED) {
        *status = STATUS_OK;
        return refuse(host, head, reason->text);
    }
    return *status || write_answer(host, request, &head, opening);
}

/* Serves until the input ends or the guest fails. The first request has no subject. */
static enum status serve(struct host *host, uint32_t threads, struct reason *reason)
{
    struct pipe_request request;
    enum status status = STATUS_OK;
    for (bool opening = true; !status && read_all(host, &request, sizeof request);
         opening = false) {
        const bool other = request.same != PIPE_SAME;
        if (other && !read_subject(host, &request))
            return STATUS_OK;
        if (opening) {
            status = guest_open(&host->guest, threads, reason);
            if (status == STATUS_UNSUPPORTED)
                host->refused = *reason;
            status = status == STATUS_UNSUPPORTED ? STATUS_OK : status;
        } else if (other) {
            status = build(host, &request, reason);
        }
        if (!status && !answer(host, &request, opening, &status, reason))
            return STATUS_OK;
    }
    return status;
}

/* --- the process ------------------------------------------------------------------------------ */

/* Keeps the standard files for the protocol; the guest gets the null device in their place. */
static bool keep_files(struct host *host)
{
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    host->in = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
    host->out = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    return null >= 0 && host->in >= 0 && host->out >= 0 && dup2(null, STDIN_FILENO) >= 0 &&
           dup2(null, STDOUT_FILENO) >= 0;
}

bool guest_host_is_meant(int argc, char *const *argv)
{
    return argc == 5 && strcmp(argv[1], PIPE_HOST_FLAG) == 0;
}

int guest_host_main(char *const *argv)
{
    struct host host = {.in = -1};
    struct reason reason = {""};
    enum status status = STATUS_DEVICE;
    const uint32_t megabytes = (uint32_t)strtoul(argv[3], NULL, 10),
                   threads = (uint32_t)strtoul(argv[4], NULL, 10);
    if (!keep_files(&host)) {
        (void)fail(&reason, STATUS_DEVICE, "no files: %s", strerror(errno));
    } else {
        object_limit_memory(megabytes);
        status = guest_load(argv[2], &host.guest, &reason);
        if (!status)
            status = serve(&host, threads, &reason);
    }
    if (status)
        dprintf(STDERR_FILENO, "%s\n", reason.text);
    guest_close(&host.guest);
    free(host.subject);
    free(host.mesh);
    free(host.ray);
    free(host.answer);
    return status ? EXIT_FAILED : 0;
}
