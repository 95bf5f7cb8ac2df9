/* The process behind an engine "pipe:COMMAND", and one exchange with it; for the engine alone. */
#ifndef PIPE_PEER_H
#define PIPE_PEER_H

#include "ref/outside/pipe.h"
#include "ref/outside/pipe_child.h"
#include "ref/twin/model.h"

/* What rays are traced in, as it is sent: the head of its requests, without rays, and what follows
 * it. All is borrowed. */
struct pipe_subject {
    struct pipe_request head;
    struct pipe_part part[2];
};

struct pipe_peer {
    const char *name; /* "pipe:COMMAND" */
    /* Of an engine of the program's own: the command, for sh -c. Its name is any; a refusal of the
     * first request is that of the engine, and what it says on its standard error is no fault, but
     * part of the reason where it fails. NULL: the name has the command or the object. */
    const char *command;
    struct engine_options options;
    struct pipe_child child; /* zero: not running */
    struct pipe_subject subject;
    bool has_subject;          /* the peer has it */
    bool moved;                /* it has it, but for the vertices: these are part[0] */
    struct pipe_answer head;   /* of its first answer: describes its arithmetic */
    struct pipe_memory memory; /* as it last told; 0: not known */
    struct model model;
    enum engine_fault fault; /* of the last call */
    size_t fault_ray;
};

/* Rays of one request, as they are sent, and the room for their answers. No rays: all 0. */
struct pipe_rays {
    size_t first, count; /* index of the first, for reasons */
    const void *ray;
    void *answer;
    size_t ray_bytes, answer_bytes; /* of one; of lists: of one hit */
    /* Of lists: room for the numbers of hits; the hits of ray i are those from i * capacity of
     * `answer` on. NULL: none. */
    uint32_t *list;
    uint32_t capacity;
};

/* Starts the process if it is not running, and reads the description of its arithmetic. Errors:
 * STATUS_UNSUPPORTED the shell did not find the command; STATUS_DEVICE. */
enum status pipe_peer_start(struct pipe_peer *peer, struct reason *reason) MUST_USE;

/* Sends the subject without rays, if the peer does not have it, so that it can build its tree.
 * Starts the process if it is not running. Errors: as pipe_peer_ask, pipe_peer_start. */
enum status pipe_peer_need(struct pipe_peer *peer, struct reason *reason) MUST_USE;

/* Sends a request about rays and receives the answers, which nothing has checked. Errors:
 * STATUS_REFUSED the peer refuses the subject; STATUS_DEVICE anything else, after which its process
 * has ended; peer->fault and peer->fault_ray are set. */
enum status pipe_peer_ask(struct pipe_peer *peer, const struct pipe_rays *rays,
                          struct reason *reason) MUST_USE;

/* Ends the process for an answer that is nonsense. The reason has its name, `what` and its standard
 * error. Returns STATUS_DEVICE. */
enum status pipe_peer_blame(struct pipe_peer *peer, size_t ray, struct reason *reason,
                            const char *what);

void pipe_peer_end(struct pipe_peer *peer);

#endif
