/* Peers for engines "pipe:COMMAND": one that keeps the protocol, and one for every way to break it.
 * Written from ref/outside/pipe.h alone, but for the triangle test. */
#ifndef TESTS_PEERS_H
#define TESTS_PEERS_H

#include "ref/outside/pipe.h"
#include "ref/trace/trace.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* One request, read. */
struct peer_request {
    struct pipe_request head;
    struct scene scene;
    struct ray *ray;
    uint32_t moved; /* updates since the scene came */
};

static bool peer_read(struct peer_request *request)
{
    struct scene *scene = &request->scene;
    if (fread(&request->head, sizeof request->head, 1, stdin) != 1)
        return false;
    if (memcmp(request->head.magic, "RDRQ", 4) != 0 || request->head.version != 1)
        return false;
    if (request->head.same == 2) { /* vertices alone */
        const size_t vertices = scene->vertex_count;
        if (request->head.vertices != vertices || request->head.triangles != scene->tri_count ||
            fread(scene->vertex, 3 * sizeof *scene->vertex, vertices, stdin) != vertices)
            return false;
        request->moved++;
    } else if (!request->head.same) {
        request->moved = 0;
        scene_free(scene);
        if (scene_make(request->head.vertices, request->head.triangles, scene))
            return false;
        size_t vertices = scene->vertex_count, triangles = scene->tri_count;
        if (fread(scene->vertex, 3 * sizeof *scene->vertex, vertices, stdin) != vertices ||
            fread(scene->index, 3 * sizeof *scene->index, triangles, stdin) != triangles)
            return false;
    }
    free(request->ray);
    request->ray = calloc(request->head.rays + 1, sizeof *request->ray);
    return request->ray && fread(request->ray, sizeof *request->ray, request->head.rays, stdin) ==
                               request->head.rays;
}

static bool is(const char *what, const char *name)
{
    return strcmp(what, name) == 0;
}

/* What is done before a request is read; true if it was. */
static void peer_before(const char *what)
{
    if (is(what, "nothing"))
        exit(0);
    if (is(what, "deaf"))
        pause();
    while (is(what, "endless"))
        fputs("yes?", stdout);
    if (is(what, "text"))
        puts("Hello, I am a tracer; these are my hits: 0 0 0 0");
    while (is(what, "stderr_endless"))
        if (fputs("xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx", stderr) < 0 ||
            ftell(stderr) > 1 << 22)
            exit(0);
}

static struct pipe_answer peer_head(const char *what, const struct pipe_request *request)
{
    struct pipe_answer head = {.version = 1, .count = request->rays};
    memcpy(head.magic, "RDRA", 4);
    head.version = is(what, "version") ? 7 : 1;
    head.refused = is(what, "neither") ? 5 : 0;
    head.formula = is(what, "formula") ? 99 : is(what, "declared") || is(what, "as_mt") ? 1 : 0;
    head.rounding = is(what, "rounding") ? 5 : is(what, "declared") ? 1 : 0;
    head.flags = is(what, "flags")                ? 128
                 : strncmp(what, "moves", 5) == 0 ? 64
                 : is(what, "declared")           ? 5
                                                  : 0;
    head.flags = is(what, "fickle") && request->triangles ? 2 : head.flags;
    if (is(what, "short") && request->rays)
        head.count--;
    if (is(what, "moves_refuses") && request->same == 2) {
        head.refused = 1;
        head.count = 13;
    }
    if ((is(what, "refuses") || is(what, "refuses_long")) && request->triangles) {
        head.refused = 1;
        head.count = is(what, "refuses") ? 13 : 100000;
    }
    return head;
}

/* What is done in the middle of the hits of a request. */
static void peer_amid(const char *what)
{
    fflush(stdout);
    if (is(what, "dies"))
        raise(SIGKILL);
    if (is(what, "exits"))
        _exit(3);
    if (is(what, "closes")) {
        close(1);
        pause();
    }
    if (is(what, "hangs"))
        pause();
    if (is(what, "forks")) {
        pid_t pid = fork();
        if (pid == 0)
            for (;;)
                pause();
        FILE *file = fopen(getenv("PEER_FILE"), "w");
        if (file) {
            fprintf(file, "%ld", (long)pid);
            fclose(file);
        }
        pause();
    }
}

static void peer_hits(const char *what, const struct peer_request *request)
{
    for (uint32_t i = 0; i < request->head.rays; i++) {
        struct hit hit;
        trace_brute(&request->scene, tri_test_find("mt"), (enum query)request->head.query,
                    &request->ray[i], &hit);
        if (is(what, "moves_told"))
            hit = (struct hit){.t = (float)request->moved};
        if (i == 17)
            peer_amid(what);
        if (i == 17 && is(what, "range"))
            hit.prim = request->head.triangles;
        if (i == 17 && is(what, "nan_id"))
            hit.prim = 0x7FC00000u;
        if (i == 17 && is(what, "nan_t"))
            hit = (struct hit){float_from_bits(0x7FC00000u), 0, 0, 0};
        if (i == 16 && is(what, "nan_t"))
            hit = (struct hit){1, 2, 3, ABI_NO_PRIM};
        fwrite(&hit, sizeof hit, 1, stdout);
    }
}

/* What is done once a request was answered. */
static void peer_after(const char *what, const struct pipe_request *request)
{
    while (is(what, "endless_hits") && request->rays)
        fputs("0123456789abcdef", stdout);
    if (is(what, "long") && request->rays)
        putchar('x');
    if (is(what, "chatty") && request->rays) {
        fflush(stdout);
        usleep(20000);
        putchar('x');
    }
    fflush(stdout);
}

/* What is done at this request: "WHAT_again" is honest at the first that has rays. */
static const char *peer_now(const char *what, const struct pipe_request *request)
{
    static char now[32];
    static uint32_t with_rays;
    with_rays += request->rays > 0;
    const char *again = strstr(what, "_again");
    if (!again)
        return what;
    snprintf(now, sizeof now, "%.*s", (int)(again - what), what);
    return with_rays > 1 ? now : "honest";
}

/* Answers requests as `asked` says; the exit code of its process. */
static inline int peer_main(const char *asked)
{
    struct peer_request request = {0};
    peer_before(asked);
    while (peer_read(&request)) {
        const char *what = peer_now(asked, &request.head);
        if (is(what, "sleeps"))
            sleep(100);
        if (is(what, "crashes") && request.head.rays)
            raise(SIGABRT);
        if (is(what, "stderr") && request.head.rays)
            fputs("oops\n", stderr);
        if (is(what, "stderr_dies") && request.head.rays) {
            fputs("no\n", stderr);
            _exit(2);
        }
        struct pipe_answer head = peer_head(what, &request.head);
        fwrite(&head, sizeof head, 1, stdout);
        if (is(what, "moves_dies") && request.moved == 1)
            _exit(4);
        if (head.refused == 1)
            fputs("only teapots\n", stdout);
        else
            peer_hits(what, &request);
        peer_after(what, &request.head);
    }
    free(request.ray);
    scene_free(&request.scene);
    return 0;
}

#endif
