#include "ref/outside/pipe_peer.h"

#include <stdio.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "floats are sent as they lie in memory");
_Static_assert(sizeof(struct pipe_request) == 4 * PIPE_WORDS, "request");
_Static_assert(sizeof(struct pipe_answer) == 4 * PIPE_WORDS, "answer");

/* How long to wait for a process to end after it closed its output. */
#define FATE_MS 500u

/* One request. */
struct asked {
    const struct pipe_rays *rays;
    uint32_t version;
    bool opening;
};

void pipe_peer_end(struct pipe_peer *peer)
{
    pipe_child_stop(&peer->child);
    peer->has_subject = peer->moved = false;
}

/* Ends the peer. The reason contains its name, `what` and its standard error. */
static enum status blame(struct pipe_peer *peer, enum status status, struct reason *reason,
                         const char *what)
{
    char said[PIPE_SAID_MOST + 40] = "";
    pipe_child_listen(&peer->child);
    if (peer->child.noisy)
        snprintf(said, sizeof said, "; its standard error: %s", peer->child.said);
    pipe_peer_end(peer);
    return fail(reason, status, "%.80s: %s%s", peer->name, what, said);
}

/* Hits that stand in the answer about ray i of a request. */
static size_t hits_of(const struct pipe_rays *rays, size_t i)
{
    return rays->list[i] < rays->capacity ? rays->list[i] : rays->capacity;
}

/* How many whole answers there are in so many bytes; of lists these are behind their numbers. */
static size_t answers_in(const struct asked *asked, size_t bytes)
{
    const struct pipe_rays *rays = asked->rays;
    size_t whole = rays->count ? bytes / rays->answer_bytes : 0, lists = 0;
    if (!rays->list)
        return whole;
    while (whole > 0 && lists < rays->count && whole >= hits_of(rays, lists))
        whole -= hits_of(rays, lists++);
    return lists;
}

/* Describes where the answers end: "after the answer to ray 17". */
static void place(const struct asked *asked, size_t bytes, char text[64])
{
    size_t done = answers_in(asked, bytes);
    if (asked->rays->count == 0)
        snprintf(text, 64, "at a request without rays");
    else if (done == 0)
        snprintf(text, 64, "before the answer to ray %zu", asked->rays->first);
    else
        snprintf(text, 64, "after the answer to ray %zu", asked->rays->first + done - 1);
}

/* Ends the peer after an exchange failed with `bytes` of answers received, and returns the
 * error. */
static enum status blame_end(struct pipe_peer *peer, enum pipe_end end, const struct asked *asked,
                             size_t bytes, struct reason *reason)
{
    char where[64], fate[PIPE_FATE_MOST], what[200];
    bool missing = false;
    unsigned limit = peer->options.peer_ms;
    place(asked, bytes, where);
    peer->fault_ray = asked->rays->first + answers_in(asked, bytes);
    switch (end) {
    case PIPE_LONG:
        snprintf(what, sizeof what, "its answer is longer than %zu rays", asked->rays->count);
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

static enum status read_refusal(struct pipe_peer *peer, struct pipe_talk *talk, uint32_t bytes,
                                const struct asked *asked, struct reason *reason)
{
    char text[PIPE_REFUSED_MOST + 1] = "";
    if (bytes > PIPE_REFUSED_MOST)
        return blame(peer, STATUS_DEVICE, reason, "its refusal is longer than 256 bytes");
    enum pipe_end end = pipe_talk(talk, text, bytes, true);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, 0, reason);
    make_printable(text);
    peer->has_subject = false;
    pipe_child_listen(&peer->child);
    if (peer->command)
        return fail(reason, STATUS_REFUSED, "%.80s: %s%s%s", peer->name, text,
                    peer->child.noisy ? "; it said: " : "", peer->child.said);
    return fail(reason, STATUS_REFUSED, "%.80s refused: %s", peer->name, text);
}

static bool is_object(const struct pipe_peer *peer)
{
    return !peer->command && strncmp(peer->name, PIPE_PREFIX, strlen(PIPE_PREFIX)) != 0;
}

/* Checks the header of an answer. Of the first request, sets peer->model from it. */
static enum status check_head(struct pipe_peer *peer, const struct pipe_answer *head,
                              const struct asked *asked, struct reason *reason)
{
    char what[200];
    struct reason why = {""};
    if (memcmp(head->magic, "RDRA", 4) != 0) {
        char begins[5] = "";
        memcpy(begins, head->magic, 4);
        make_printable(begins);
        snprintf(what, sizeof what, "its answer begins with '%s', not with 'RDRA'", begins);
    } else if (head->version != asked->version) {
        snprintf(what, sizeof what, "its answer is of version %u, not %u", head->version,
                 asked->version);
    } else if (head->refused > 1) {
        snprintf(what, sizeof what, "its answer has status %u, not 0 (given) or 1 (refused)",
                 head->refused);
    } else if (!head->refused && head->count != asked->rays->count) {
        snprintf(what, sizeof what, "its answer is about %u rays, not %zu, from ray %zu on",
                 head->count, asked->rays->count, asked->rays->first);
    } else if (asked->opening && pipe_model(head->formula, head->rounding,
                                            head->flags & ~PIPE_FLAGS_CAN, &peer->model, &why)) {
        snprintf(what, sizeof what, "says of itself: %.150s", why.text);
    } else if (asked->opening && is_object(peer) &&
               pipe_displacement(float_from_bits(head->zero), &peer->model, &why)) {
        snprintf(what, sizeof what, "says of itself: %.150s", why.text);
    } else if (!asked->opening &&
               (head->formula != peer->head.formula || head->rounding != peer->head.rounding ||
                head->flags != peer->head.flags)) {
        snprintf(what, sizeof what, "now declares another formula, rounding or flags");
    } else {
        return STATUS_OK;
    }
    return blame(peer, STATUS_DEVICE, reason, what);
}

/* Receives lists: their numbers, then all hits together, which go to their places. */
static enum pipe_end receive_lists(const struct pipe_rays *rays, struct pipe_talk *talk)
{
    struct hit *hit = rays->answer;
    size_t total = 0;
    enum pipe_end end = pipe_talk(talk, rays->list, rays->count * sizeof *rays->list, false);
    if (end != PIPE_GOT) {
        talk->got = 0; /* no list is whole */
        return end;
    }
    for (size_t i = 0; i < rays->count; i++)
        total += hits_of(rays, i);
    end = pipe_talk(talk, hit, total * sizeof *hit, true);
    for (size_t i = rays->count;
         i-- > 0;) { /* from the last on, as each moves away from the first */
        total -= hits_of(rays, i);
        memmove(hit + i * rays->capacity, hit + total, hits_of(rays, i) * sizeof *hit);
    }
    return end;
}

/* Receives what stands behind the head of an answer that is no refusal. */
static enum pipe_end receive(struct pipe_peer *peer, const struct asked *asked,
                             struct pipe_talk *talk)
{
    const struct pipe_rays *rays = asked->rays;
    uint32_t word[6];
    if (!asked->opening && (peer->head.flags & PIPE_FLAG_MEMORY)) {
        enum pipe_end end = pipe_talk(talk, word, sizeof word, false);
        talk->got = end == PIPE_GOT ? talk->got : 0;
        if (end != PIPE_GOT)
            return end;
        peer->memory = (struct pipe_memory){(uint64_t)word[1] << 32 | word[0],
                                            (uint64_t)word[3] << 32 | word[2],
                                            (uint64_t)word[5] << 32 | word[4]};
    }
    return rays->list ? receive_lists(rays, talk)
                      : pipe_talk(talk, rays->answer, rays->count * rays->answer_bytes, true);
}

/* Sends a request and receives its answer. */
static enum status ask(struct pipe_peer *peer, const struct asked *asked, struct reason *reason)
{
    static const struct pipe_subject empty = {
        .head = {.magic = {'R', 'D', 'R', 'Q'}, .version = PIPE_VERSION}};
    const struct pipe_subject *subject = asked->opening ? &empty : &peer->subject;
    const struct pipe_rays *rays = asked->rays;
    struct pipe_request request = subject->head;
    request.rays = (uint32_t)rays->count;
    request.same = peer->has_subject ? PIPE_SAME : peer->moved ? PIPE_SAME_MOVED : 0;
    request.zero = rays->list ? rays->capacity : 0;
    struct pipe_part part[4] = {{&request, sizeof request}};
    size_t parts = 1; /* of the subject what the peer does not have */
    if (request.same != PIPE_SAME)
        part[parts++] = subject->part[0];
    if (request.same == 0)
        part[parts++] = subject->part[1];
    part[parts++] = (struct pipe_part){rays->ray, rays->count * rays->ray_bytes};
    struct pipe_talk talk = {.child = &peer->child,
                             .part = part,
                             .part_count = parts,
                             .deadline_ns = time_ns() + (uint64_t)peer->options.peer_ms * 1000000u};
    struct pipe_answer head;
    peer->fault = ENGINE_NONSENSE; /* unless it is set below */
    peer->fault_ray = rays->first;
    peer->moved = false;
    if (!asked->opening && pipe_child_is_early(&peer->child)) /* else its bytes are shown */
        return blame(peer, STATUS_DEVICE, reason, "wrote more bytes after its previous answer");
    enum pipe_end end = pipe_talk(&talk, &head, sizeof head, false);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, 0, reason);
    enum status status = check_head(peer, &head, asked, reason);
    if (status)
        return status;
    if (asked->opening)
        peer->head = head;
    if (head.refused)
        return read_refusal(peer, &talk, head.count, asked, reason);
    end = receive(peer, asked, &talk);
    if (end != PIPE_GOT)
        return blame_end(peer, end, asked, talk.got, reason);
    peer->has_subject = true;
    if (peer->child.noisy && !peer->command)
        return blame(peer, STATUS_DEVICE, reason,
                     "answered, but must not write to its standard error");
    return STATUS_OK;
}

enum status pipe_peer_start(struct pipe_peer *peer, struct reason *reason)
{
    static const struct pipe_rays none;
    if (pipe_child_runs(&peer->child))
        return STATUS_OK;
    struct reason why = {""};
    const bool object = is_object(peer);
    const char *command = peer->command ? peer->command : peer->name + strlen(PIPE_PREFIX);
    const struct pipe_order order = {.command = object ? NULL : command,
                                     .object = object ? peer->name : NULL,
                                     .megabytes = peer->options.peer_mb,
                                     .threads = peer->options.threads};
    enum status status = pipe_child_start(&order, &peer->child, &why);
    if (status)
        return fail(reason, status, "%.80s: %s", peer->name, why.text);
    peer->has_subject = false;
    status = ask(peer, &(struct asked){&none, PIPE_VERSION, true}, reason);
    peer->has_subject = false; /* the request had none */
    if (status != STATUS_REFUSED)
        return status;
    if (!object && !peer->command) /* it may accept another */
        return STATUS_OK;
    pipe_peer_end(peer);
    return STATUS_UNSUPPORTED;
}

enum status pipe_peer_need(struct pipe_peer *peer, struct reason *reason)
{
    static const struct pipe_rays none;
    enum status status = pipe_peer_start(peer, reason); /* restarts it if it was ended */
    return status || peer->has_subject ? status : pipe_peer_ask(peer, &none, reason);
}

enum status pipe_peer_ask(struct pipe_peer *peer, const struct pipe_rays *rays,
                          struct reason *reason)
{
    return ask(peer, &(struct asked){rays, peer->subject.head.version, false}, reason);
}

enum status pipe_peer_blame(struct pipe_peer *peer, size_t ray, struct reason *reason,
                            const char *what)
{
    peer->fault = ENGINE_NONSENSE;
    peer->fault_ray = ray;
    return blame(peer, STATUS_DEVICE, reason, what);
}
