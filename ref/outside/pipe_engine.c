/* The engine "pipe:COMMAND". */
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_child.h"
#include "ref/twin/model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "floats are sent as they lie in memory");
_Static_assert(sizeof(struct pipe_request) == 4 * PIPE_WORDS, "request");
_Static_assert(sizeof(struct pipe_answer) == 4 * PIPE_WORDS, "answer");

/* Rays of one request at most. The time limit is for one request. */
#define RAYS_MOST ((size_t)1 << 18)
/* How long to wait for a process to end after it closed its output. */
#define FATE_MS 500u

struct peer {
    const char *name; /* "pipe:COMMAND" */
    struct engine_options options;
    struct pipe_child child; /* zero: not running */
    bool has_scene;          /* the peer has the scene of `job` */
    struct job job;
    struct pipe_answer head; /* of its first answer: describes its arithmetic */
    struct model model;
    enum engine_fault fault; /* of the last call */
    size_t fault_ray;
};

/* One request, for messages about it. */
struct asked {
    size_t first; /* index of the first ray */
    size_t rays;
};

static void end_peer(struct peer *peer)
{
    pipe_child_stop(&peer->child);
    peer->has_scene = false;
}

/* Ends the peer. The reason contains its name, `what` and its standard error. */
static enum status blame(struct peer *peer, enum status status, struct reason *reason,
                         const char *what)
{
    char said[PIPE_SAID_MOST + 40] = "";
    pipe_child_listen(&peer->child);
    if (peer->child.noisy)
        snprintf(said, sizeof said, "; its standard error: %s", peer->child.said);
    end_peer(peer);
    return fail(reason, status, "%.80s: %s%s", peer->name, what, said);
}

/* Describes where the answers end: "after the answer to ray 17". */
static void place(const struct asked *asked, size_t bytes, char text[64])
{
    size_t done = bytes / sizeof(struct hit);
    if (asked->rays == 0)
        snprintf(text, 64, "at a request without rays");
    else if (done == 0)
        snprintf(text, 64, "before the answer to ray %zu", asked->first);
    else
        snprintf(text, 64, "after the answer to ray %zu", asked->first + done - 1);
}

/* Ends the peer after an exchange failed with `bytes` of answers received, and returns the
 * error. */
static enum status blame_end(struct peer *peer, enum pipe_end end, const struct asked *asked,
                             size_t bytes, struct reason *reason)
{
    char where[64], fate[PIPE_FATE_MOST], what[200];
    bool missing = false;
    unsigned limit = peer->options.peer_ms;
    place(asked, bytes, where);
    peer->fault_ray = asked->first + bytes / sizeof(struct hit);
    switch (end) {
    case PIPE_LONG:
        snprintf(what, sizeof what, "its answer is longer than %zu rays", asked->rays);
        break;
    case PIPE_LATE:
        peer->fault = ENGINE_LATE;
        snprintf(what, sizeof what, "late: not done within %g s, %s", 1e-3 * limit, where);
        break;
    case PIPE_CLOSED:
        peer->fault = ENGINE_ENDED;
        pipe_child_fate(&peer->child, FATE_MS, fate, &missing);
        snprintf(what, sizeof what, "%s %s", fate, where);
        break;
    case PIPE_GOT:
        break;
    }
    return blame(peer, missing ? STATUS_UNSUPPORTED : STATUS_DEVICE, reason, what);
}

/* Replaces unprintable characters with '?'. */
static void make_printable(char *text)
{
    for (; *text; text++)
        if (*text < ' ' || *text > '~')
            *text = '?';
}

static enum status read_refusal(struct peer *peer, struct pipe_talk *talk, uint32_t bytes,
                                const struct asked *asked, struct reason *reason)
{
    char text[PIPE_REFUSED_MOST + 1] = "";
    if (bytes > PIPE_REFUSED_MOST)
        return blame(peer, STATUS_DEVICE, reason, "its refusal is longer than 256 bytes");
    enum pipe_end end = pipe_talk(talk, text, bytes, true);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, 0, reason);
    make_printable(text);
    peer->has_scene = false;
    return fail(reason, STATUS_REFUSED, "%.80s refused: %s", peer->name, text);
}

/* Checks the header of an answer. When opening, sets peer->model from it. */
static enum status check_head(struct peer *peer, const struct pipe_answer *head,
                              const struct asked *asked, bool opening, struct reason *reason)
{
    char what[200];
    struct reason why = {""};
    if (memcmp(head->magic, "RDRA", 4) != 0) {
        char begins[5] = "";
        memcpy(begins, head->magic, 4);
        make_printable(begins);
        snprintf(what, sizeof what, "its answer begins with '%s', not with 'RDRA'", begins);
    } else if (head->version != PIPE_VERSION) {
        snprintf(what, sizeof what, "its answer is of version %u, not %u", head->version,
                 PIPE_VERSION);
    } else if (head->refused > 1) {
        snprintf(what, sizeof what, "its answer has status %u, not 0 (given) or 1 (refused)",
                 head->refused);
    } else if (!head->refused && head->count != asked->rays) {
        snprintf(what, sizeof what, "its answer is about %u rays, not %zu, from ray %zu on",
                 head->count, asked->rays, asked->first);
    } else if (opening &&
               pipe_model(head->formula, head->rounding, head->flags, &peer->model, &why)) {
        snprintf(what, sizeof what, "says of itself: %.150s", why.text);
    } else if (!opening &&
               (head->formula != peer->head.formula || head->rounding != peer->head.rounding ||
                head->flags != peer->head.flags)) {
        snprintf(what, sizeof what, "now declares another formula, rounding or flags");
    } else {
        return STATUS_OK;
    }
    return blame(peer, STATUS_DEVICE, reason, what);
}

/* Checks that all triangles are in the scene; an answer with another number is not judged. t, u and
 * v may be anything: the judge finds wrong ones. */
static enum status check_hits(struct peer *peer, const struct asked *asked, struct hit *hit,
                              struct reason *reason)
{
    char what[120];
    bool unnamed = peer->model.any_unnamed && peer->job.query == QUERY_ANY;
    for (size_t i = 0; i < asked->rays; i++) {
        if (hit[i].prim == ABI_NO_PRIM) {
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        } else if (hit[i].prim >= peer->job.scene->tri_count) {
            peer->fault_ray = asked->first + i;
            snprintf(what, sizeof what, "its answer to ray %zu names triangle %u of %u",
                     asked->first + i, hit[i].prim, peer->job.scene->tri_count);
            return blame(peer, STATUS_DEVICE, reason, what);
        } else if (unnamed) {
            hit[i] = (struct hit){.prim = 0};
        }
    }
    return STATUS_OK;
}

/* Sends a request and receives its answer. */
static enum status ask(struct peer *peer, const struct asked *asked, const struct ray *ray,
                       struct hit *hit, bool opening, struct reason *reason)
{
    static const struct scene empty;
    const struct scene *scene = opening ? &empty : peer->job.scene;
    struct pipe_request request = {.version = PIPE_VERSION,
                                   .query = opening ? 0u : (uint32_t)peer->job.query,
                                   .vertices = scene->vertex_count,
                                   .triangles = scene->tri_count,
                                   .rays = (uint32_t)asked->rays,
                                   .same = peer->has_scene};
    memcpy(request.magic, "RDRQ", 4);
    size_t send_scene = peer->has_scene ? 0 : 1;
    const struct pipe_part part[] = {
        {&request, sizeof request},
        {scene->vertex, send_scene * 3 * sizeof(float) * (size_t)scene->vertex_count},
        {scene->index, send_scene * 3 * sizeof(uint32_t) * (size_t)scene->tri_count},
        {ray, asked->rays * sizeof *ray}};
    struct pipe_talk talk = {.child = &peer->child,
                             .part = part,
                             .part_count = ARRAY_COUNT(part),
                             .deadline_ns = time_ns() + (uint64_t)peer->options.peer_ms * 1000000u};
    struct pipe_answer head;
    peer->fault = ENGINE_NONSENSE; /* unless it is set below */
    peer->fault_ray = asked->first;
    if (!opening && pipe_child_is_early(&peer->child)) /* when opening, its bytes are shown */
        return blame(peer, STATUS_DEVICE, reason, "wrote more bytes after its previous answer");
    enum pipe_end end = pipe_talk(&talk, &head, sizeof head, false);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, 0, reason);
    enum status status = check_head(peer, &head, asked, opening, reason);
    if (status)
        return status;
    if (opening)
        peer->head = head;
    if (head.refused)
        return read_refusal(peer, &talk, head.count, asked, reason);
    end = pipe_talk(&talk, hit, asked->rays * sizeof *hit, true);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, talk.got, reason);
    peer->has_scene = true;
    if (peer->child.noisy)
        return blame(peer, STATUS_DEVICE, reason,
                     "answered, but must not write to its standard error");
    return check_hits(peer, asked, hit, reason);
}

/* Starts the process if it is not running, and reads the description of its arithmetic. */
static enum status need_peer(struct peer *peer, struct reason *reason)
{
    if (pipe_child_runs(&peer->child))
        return STATUS_OK;
    struct reason why = {""};
    const char *command = peer->name + strlen(PIPE_PREFIX);
    enum status status = pipe_child_start(command, peer->options.peer_mb, &peer->child, &why);
    if (status)
        return fail(reason, status, "%.80s: %s", peer->name, why.text);
    peer->has_scene = false;
    status = ask(peer, &(struct asked){0, 0}, NULL, NULL, true, reason);
    peer->has_scene = false;                              /* the request had no scene */
    return status == STATUS_REFUSED ? STATUS_OK : status; /* it may accept another scene */
}

static void peer_close(void *self)
{
    struct peer *peer = self;
    if (!peer)
        return;
    end_peer(peer);
    free(peer);
}

static enum status peer_open(const char *name, const struct engine_options *options, void **self,
                             struct reason *reason)
{
    struct peer *peer = alloc_zeroed(1, sizeof *peer);
    *self = NULL;
    if (!peer)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    peer->name = name;
    peer->options = *options;
    peer->options.peer_ms = options->peer_ms ? options->peer_ms : PEER_MS;
    peer->options.peer_mb = options->peer_mb ? options->peer_mb : PEER_MB;
    enum status status = need_peer(peer, reason);
    if (status)
        peer_close(peer);
    else
        *self = peer;
    return status;
}

/* Sends the scene with a request of no rays, so that the peer builds its tree outside the timed
 * calls, and can refuse the scene. */
static enum status peer_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct peer *peer = self;
    if (job->query == QUERY_ALL)
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits", peer->name);
    peer->job = *job;
    peer->has_scene = false;
    enum status status = need_peer(peer, reason);
    return status ? status : ask(peer, &(struct asked){0, 0}, NULL, NULL, false, reason);
}

static enum status peer_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                              struct trace_report *report, struct reason *reason)
{
    struct peer *peer = self;
    *report = (struct trace_report){0};
    for (size_t first = 0; first < ray_count; first += RAYS_MOST) {
        size_t rest = ray_count - first;
        struct asked asked = {first, rest < RAYS_MOST ? rest : RAYS_MOST};
        enum status status = need_peer(peer, reason); /* restarts it if it was ended */
        if (!status && !peer->has_scene)
            status = ask(peer, &(struct asked){0, 0}, NULL, NULL, false, reason);
        uint64_t start = time_ns();
        if (!status)
            status = ask(peer, &asked, ray + first, hit + first, false, reason);
        if (status)
            return status;
        report->ns += time_ns() - start;
    }
    return STATUS_OK;
}

static enum engine_fault peer_fault(void *self, size_t *ray)
{
    const struct peer *peer = self;
    *ray = peer->fault_ray;
    return peer->fault;
}

static struct model peer_model(void *self, const struct tri_test *tri)
{
    (void)tri;
    return ((const struct peer *)self)->model;
}

/* Engines are constant tables of functions, so each name is bound to one by its index here. */
static char name_of[ENGINES_ADDED_MOST][PIPE_NAME_MOST];
static size_t name_count;

#define PLACE(n)                                                                                   \
    static enum status open_##n(const struct engine_options *options, void **self,                 \
                                struct reason *reason)                                             \
    {                                                                                              \
        return peer_open(name_of[n], options, self, reason);                                       \
    }                                                                                              \
    static void describe_##n(const struct engine_options *options, char *text, size_t text_bytes)  \
    {                                                                                              \
        (void)options;                                                                             \
        snprintf(text, text_bytes, "the command %s", name_of[n] + strlen(PIPE_PREFIX));            \
    }

#define ENGINE(n)                                                                                  \
    {                                                                                              \
        .name = name_of[n], .summary = "a child process, over a pipe", .own_tri = true,            \
        .open = open_##n, .prepare = peer_prepare, .trace = peer_trace, .model = peer_model,       \
        .fault = peer_fault, .close = peer_close, .describe = describe_##n                         \
    }

PLACE(0)
PLACE(1)
PLACE(2)
PLACE(3)

static const struct engine engine_of[] = {ENGINE(0), ENGINE(1), ENGINE(2), ENGINE(3)};
_Static_assert(ARRAY_COUNT(engine_of) == ENGINES_ADDED_MOST, "a place for each");

const char *pipe_engines_behind(const char *name)
{
    char rest[PIPE_NAME_MOST + 1];
    const char *first = NULL;
    snprintf(rest, sizeof rest, "%s", name);
    for (char *comma; (comma = strrchr(rest, ',')) && engine_find(comma + 1); *comma = '\0')
        first = name + (comma - rest);
    return first;
}

enum status pipe_engine(const char *name, const struct engine **out, struct reason *reason)
{
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    size_t length = strlen(name);
    if (strncmp(name, PIPE_PREFIX, strlen(PIPE_PREFIX)) != 0 || !name[strlen(PIPE_PREFIX)])
        return fail(reason, STATUS_INPUT, "'%.60s' is not pipe:COMMAND", name);
    if (length >= PIPE_NAME_MOST)
        return fail(reason, STATUS_INPUT, "'%.40s...' is longer than %d characters", name,
                    PIPE_NAME_MOST - 1);
    if (name_count == ARRAY_COUNT(engine_of))
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d peers", name, ENGINES_ADDED_MOST);
    memcpy(name_of[name_count], name, length + 1);
    enum status status = engine_add(&engine_of[name_count], reason);
    if (status)
        return status;
    *out = &engine_of[name_count++];
    return STATUS_OK;
}
