/* Dawn in a process of its own: Node runs gpu/webgpu/peer.js, which runs WGSL. */
#ifndef WEBGPU_PEER_H
#define WEBGPU_PEER_H

#include "ref/outside/pipe_peer.h"

#define WEBGPU_ARRAYS  3u /* storage buffers of a program, from binding 3 on */
#define WEBGPU_UNIFORM 8u /* words of struct Job; the peer writes the first */

/* A shader and its data. All is borrowed until webgpu_give returns. */
struct webgpu_program {
    const char *text;
    struct {
        const uint32_t *word;
        size_t count;
    } array[WEBGPU_ARRAYS];
    uint32_t into_words, out_words; /* of a record that an invocation reads, and writes */
    uint32_t uniform[WEBGPU_UNIFORM];
};

struct webgpu_peer {
    struct pipe_peer pipe;
    char *command;
    uint32_t *words; /* the program, as it is sent */
};

/* Starts Node with Dawn on the driver of the options. Errors: STATUS_UNSUPPORTED Node, Dawn or the
 * driver is not here (each with the remedy), or Dawn refuses the driver; STATUS_DEVICE it failed;
 * STATUS_MEMORY. */
enum status webgpu_start(const struct engine_options *options, struct webgpu_peer *out,
                         struct reason *reason) MUST_USE;

/* Writes a program as gpu/webgpu/core.js takes it; the caller frees *out. Errors: STATUS_LIMIT over
 * 2^32 words; STATUS_MEMORY. *out is NULL on error. */
enum status webgpu_words(const struct webgpu_program *program, uint32_t **out, size_t *count,
                         struct reason *reason) MUST_USE;

/* Sends a program, which is compiled. Errors: as pipe_peer_need and webgpu_words. */
enum status webgpu_give(struct webgpu_peer *peer, const struct webgpu_program *program,
                        struct reason *reason) MUST_USE;

/* Runs the program that was given last on `count` records; `first` is the number of the first, for
 * reasons. Errors: as pipe_peer_ask. */
enum status webgpu_run(struct webgpu_peer *peer, size_t first, size_t count, const void *record,
                       void *answer, struct reason *reason) MUST_USE;

/* Ends the process and frees what belongs to it. A zero peer is fine. */
void webgpu_stop(struct webgpu_peer *peer);

#endif
