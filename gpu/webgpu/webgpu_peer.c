#define _XOPEN_SOURCE 700 /* realpath */
#include "gpu/webgpu/webgpu_peer.h"

#include "gpu/vk/vk_driver.h"
#include "gpu/webgpu/webgpu_text.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/outside/tool.h"

#include <stdlib.h>
#include <string.h>

#define HEAD_WORDS    16u
#define COMMAND_BYTES ((size_t)1 << 16)
#define MODULE        "node_modules/webgpu/index.js"

/* Appends NAME=VALUE for the shell. */
static void put_variable(char *text, const char *name, const char *value)
{
    char word[2 * DRIVER_PATH_BYTES] = "";
    text_append(word, sizeof word, "%s=%s", name, value);
    text_append(text, COMMAND_BYTES, " ");
    command_word(text, COMMAND_BYTES, word);
}

/* The environment that makes Vulkan's loader use this driver alone. */
static void put_driver(char *text, const struct driver *driver)
{
    char folder[DRIVER_PATH_BYTES];
    if (driver->kind != DRIVER_FILE)
        return;
    put_variable(text, "VK_DRIVER_FILES", driver->icd);
    put_variable(text, "VK_ICD_FILENAMES", driver->icd);
    snprintf(folder, sizeof folder, "%s", driver->icd);
    char *slash = strrchr(folder, '/');
    if (!driver->fetched || !slash)
        return;
    *slash = '\0'; /* libraries that were fetched with it */
    put_variable(text, "LD_LIBRARY_PATH", folder);
}

/* Appends the text that Node runs. */
static enum status put_text(char *text, struct reason *reason)
{
    static const char *const part[] = {"core.js", "peer.js"};
    size_t bytes = 1;
    for (size_t i = 0; i < ARRAY_COUNT(part); i++)
        bytes += strlen(wgsl_find(part[i]));
    char *joined = alloc_zeroed(bytes, 1);
    if (!joined)
        return fail(reason, STATUS_MEMORY, "webgpu: no memory for the engine");
    for (size_t i = 0; i < ARRAY_COUNT(part); i++)
        text_append(joined, bytes, "%s", wgsl_find(part[i]));
    command_word(text, COMMAND_BYTES, joined);
    free(joined);
    return STATUS_OK;
}

static enum status make_command(const struct engine_options *options, char *text,
                                struct reason *reason)
{
    char folder[DRIVER_PATH_BYTES], module[DRIVER_PATH_BYTES + 64], node[DRIVER_PATH_BYTES];
    struct driver driver;
    if (!tool_find("node", node, sizeof node))
        return fail(reason, STATUS_UNSUPPORTED,
                    "webgpu: node is not in PATH (Debian package nodejs)");
    driver_folder("RAYDIFF_WEBGPU", "webgpu", MODULE, folder);
    snprintf(module, sizeof module, "%s/" MODULE, folder);
    char *path = realpath(module, NULL);
    if (!path)
        return fail(reason, STATUS_UNSUPPORTED,
                    "webgpu: Dawn is not in %.160s: run make webgpu, or npm install webgpu and set "
                    "RAYDIFF_WEBGPU",
                    folder);
    enum status status = driver_find(options->driver, &driver, reason);
    if (!status) {
        text_append(text, COMMAND_BYTES, "exec env");
        put_driver(text, &driver);
        command_word(text, COMMAND_BYTES, node);
        text_append(text, COMMAND_BYTES, " --input-type=module -e");
        status = put_text(text, reason);
        text_append(text, COMMAND_BYTES, " --");
        command_word(text, COMMAND_BYTES, path);
        text_append(text, COMMAND_BYTES, driver.kind == DRIVER_HARDWARE ? " hardware" : " any");
    }
    if (!status && driver.kind == DRIVER_PART) {
        char option[DRIVER_PATH_BYTES] = "";
        text_append(option, sizeof option, "adapter=%s", driver.text);
        command_word(text, COMMAND_BYTES, option);
    }
    free(path);
    return status;
}

enum status webgpu_start(const struct engine_options *options, struct webgpu_peer *out,
                         struct reason *reason)
{
    *out = (struct webgpu_peer){.command = alloc_zeroed(COMMAND_BYTES, 1)};
    if (!out->command)
        return fail(reason, STATUS_MEMORY, "webgpu: no memory for the engine");
    enum status status = make_command(options, out->command, reason);
    out->pipe.name = "webgpu";
    out->pipe.command = out->command;
    out->pipe.options = *options;
    out->pipe.options.peer_ms = options->peer_ms ? options->peer_ms : PEER_MS;
    /* Node reserves far more addresses than it uses. */
    out->pipe.options.peer_mb = options->peer_mb ? options->peer_mb : UINT32_MAX;
    if (!status)
        status = pipe_peer_start(&out->pipe, reason);
    if (status)
        webgpu_stop(out);
    return status;
}

void webgpu_stop(struct webgpu_peer *peer)
{
    pipe_peer_end(&peer->pipe);
    free(peer->command);
    free(peer->words);
    *peer = (struct webgpu_peer){.command = NULL};
}

enum status webgpu_words(const struct webgpu_program *program, uint32_t **out, size_t *count,
                         struct reason *reason)
{
    const size_t bytes = strlen(program->text), words = (bytes + 3) / 4;
    size_t total = HEAD_WORDS + words;
    uint32_t head[HEAD_WORDS] = {(uint32_t)bytes};
    *out = NULL;
    for (uint32_t i = 0; i < WEBGPU_ARRAYS; i++) {
        head[1 + i] = (uint32_t)program->array[i].count;
        total += program->array[i].count;
    }
    head[4] = program->into_words;
    head[5] = program->out_words;
    memcpy(head + HEAD_WORDS - WEBGPU_UNIFORM, program->uniform, sizeof program->uniform);
    if (total > UINT32_MAX)
        return fail(reason, STATUS_LIMIT, "webgpu: more than 2^32 words");
    uint32_t *at = *out = alloc_zeroed(total, sizeof *at);
    if (!at)
        return fail(reason, STATUS_MEMORY, "webgpu: no memory for a program");
    memcpy(at, head, sizeof head);
    memcpy(at + HEAD_WORDS, program->text, bytes);
    at += HEAD_WORDS + words;
    for (uint32_t i = 0; i < WEBGPU_ARRAYS; i++) {
        if (program->array[i].count > 0) /* an empty array may be NULL */
            memcpy(at, program->array[i].word, 4 * program->array[i].count);
        at += program->array[i].count;
    }
    *count = total;
    return STATUS_OK;
}

enum status webgpu_give(struct webgpu_peer *peer, const struct webgpu_program *program,
                        struct reason *reason)
{
    size_t total;
    free(peer->words);
    enum status status = webgpu_words(program, &peer->words, &total, reason);
    if (status)
        return status;
    peer->pipe.subject = (struct pipe_subject){.head = {.magic = {'R', 'D', 'R', 'Q'},
                                                        .version = PIPE_VERSION_SHADER,
                                                        .vertices = (uint32_t)total},
                                               .part = {{peer->words, 4 * total}}};
    peer->pipe.has_subject = false;
    return pipe_peer_need(&peer->pipe, reason);
}

enum status webgpu_run(struct webgpu_peer *peer, size_t first, size_t count, const void *record,
                       void *answer, struct reason *reason)
{
    const uint32_t *head = peer->words;
    const struct pipe_rays rays = {.first = first,
                                   .count = count,
                                   .ray = record,
                                   .answer = answer,
                                   .ray_bytes = 4 * (size_t)head[4],
                                   .answer_bytes = 4 * (size_t)head[5]};
    enum status status = pipe_peer_need(&peer->pipe, reason);
    return status ? status : pipe_peer_ask(&peer->pipe, &rays, reason);
}
