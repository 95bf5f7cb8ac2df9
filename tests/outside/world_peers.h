/* Peers of worlds for engines "pipe:COMMAND": one that keeps version 2 of the protocol, one for
 * every defect that tracers of worlds are known to have, and one for every way to break it. The
 * words are read as ref/outside/pipe.h describes them; nothing of the engine is used. */
#ifndef TESTS_WORLD_PEERS_H
#define TESTS_WORLD_PEERS_H

#include "ref/explain/world_defect.h"
#include "tests/outside/peers.h"

#define WORLD_PEER_RAY    10         /* the ray whose answer is broken */
#define WORLD_PEER_TRACES (1u << 14) /* of requests of more rays all miss, and nothing is broken */

/* One request of version 2, read. */
struct world_request {
    struct pipe_request head;
    struct world world;
    struct ray *ray;
    struct ray_mode *mode;
};

static bool take(void *to, size_t bytes)
{
    return fread(to, 1, bytes, stdin) == bytes;
}

static bool world_peer_mesh(struct world_mesh *mesh)
{
    uint32_t head[4];
    if (!take(head, sizeof head) || head[3] != 0)
        return false;
    mesh->scene = calloc(1, sizeof *mesh->scene);
    mesh->geometry = calloc(head[2] + 1, sizeof *mesh->geometry);
    if (!mesh->scene || !mesh->geometry || scene_make(head[0], head[1], mesh->scene) ||
        !take(mesh->scene->vertex, 12 * (size_t)head[0]) ||
        !take(mesh->scene->index, 12 * (size_t)head[1]))
        return false;
    uint32_t first = 0;
    for (uint32_t i = 0; i < head[2]; i++) {
        uint32_t words[4];
        if (!take(words, sizeof words) || words[1] > 1 || words[2] || words[3])
            return false;
        mesh->geometry[i] = (struct geometry){first, words[0], words[1] == 1};
        first += words[0];
    }
    mesh->geometry_count = head[2];
    return true;
}

static bool world_peer_world(struct world_request *request)
{
    struct world *world = &request->world;
    struct reason reason;
    uint32_t filter[4];
    world_free(world);
    world->mesh = calloc(request->head.vertices + 1, sizeof *world->mesh);
    world->instance = calloc(request->head.triangles + 1, sizeof *world->instance);
    if (!world->mesh || !world->instance || !take(filter, sizeof filter) || filter[3] != 0)
        return false;
    world->filter = (struct filter_rule){(enum filter_kind)filter[0], filter[1], filter[2]};
    for (; world->mesh_count < request->head.vertices; world->mesh_count++)
        if (!world_peer_mesh(&world->mesh[world->mesh_count]))
            return false;
    for (; world->instance_count < request->head.triangles; world->instance_count++) {
        struct instance *one = &world->instance[world->instance_count];
        if (!take(&one->mesh, 4) || !take(&one->custom, 4) || !take(&one->mask, 4) ||
            !take(&one->flags, 4) || !take(one->m, sizeof one->m))
            return false;
    }
    return world_finish(world, &reason) == STATUS_OK;
}

/* Reads what follows a head of version 2. */
static bool world_peer_read(struct world_request *request)
{
    if (!request->head.same && !world_peer_world(request))
        return false;
    free(request->ray);
    free(request->mode);
    request->ray = calloc(request->head.rays + 1, sizeof *request->ray);
    request->mode = calloc(request->head.rays + 1, sizeof *request->mode);
    if (!request->ray || !request->mode)
        return false;
    for (uint32_t i = 0; i < request->head.rays; i++)
        if (!take(&request->ray[i], sizeof *request->ray) ||
            !take(&request->mode[i], sizeof *request->mode))
            return false;
    return true;
}

/* The eight words of a hit. */
struct world_words {
    float t, u, v;
    uint32_t instance, geometry, triangle, side, custom;
};

static struct world_words world_words_of(const struct world *world, const struct hit *hit,
                                         uint32_t tag)
{
    if (hit->prim == ABI_NO_PRIM)
        return (struct world_words){.instance = 0xFFFFFFFFu};
    const struct place place = world_place(world, hit->prim);
    return (struct world_words){hit->t,         hit->u,    hit->v,    place.instance,
                                place.geometry, place.tri, tag >> 31, tag & 0xFFFFFFu};
}

/* What is wrong with one answer. */
static struct world_words world_peer_broken(const char *what, const struct world *world,
                                            struct world_words hit)
{
    const struct world_words miss = {.instance = 0xFFFFFFFFu};
    const struct world_words first = {.t = 1, .instance = 1};
    if (is(what, "unnamed"))
        hit = hit.instance == 0xFFFFFFFFu ? miss : (struct world_words){.geometry = 77, .side = 9};
    if (is(what, "keeps_none") && hit.instance != 0xFFFFFFFFu)
        hit.custom = 0xFFFFFFFFu;
    if (is(what, "instance"))
        hit = (struct world_words){.instance = world->instance_count};
    if (is(what, "no_mesh"))
        for (hit = first; world->instance[hit.instance].mesh != WORLD_NO_MESH;)
            hit.instance++;
    if (is(what, "geometry"))
        hit = (struct world_words){.instance = 1, .geometry = 99};
    if (is(what, "triangle"))
        hit = (struct world_words){.instance = 1, .triangle = 999999};
    if (is(what, "side"))
        hit = (struct world_words){.instance = 1, .side = 2};
    if (is(what, "custom"))
        hit = (struct world_words){.instance = 1, .custom = 0x1000000u};
    if (is(what, "miss_side"))
        hit = (struct world_words){.instance = 0xFFFFFFFFu, .side = 1};
    if (is(what, "miss_geometry"))
        hit = (struct world_words){.instance = 0xFFFFFFFFu, .geometry = 3};
    if (is(what, "miss_custom"))
        hit = (struct world_words){.instance = 0xFFFFFFFFu, .custom = 5};
    return hit;
}

static void world_peer_hits(const char *what, const struct world_request *request)
{
    const struct tri_test *mt = tri_test_find("mt");
    const bool each = is(what, "unnamed") || is(what, "keeps_none");
    struct world_look look;
    struct reason reason;
    if (request->head.rays > WORLD_PEER_TRACES) {
        const struct world_words miss = {.instance = 0xFFFFFFFFu};
        for (uint32_t i = 0; i < request->head.rays; i++)
            fwrite(&miss, sizeof miss, 1, stdout);
        return;
    }
    if (world_look_make(&request->world, mt, &look, &reason))
        exit(4);
    if (strncmp(what, "defect:", 7) == 0)
        world_look_bend(&look, (enum world_defect)atoi(what + 7));
    for (uint32_t i = 0; i < request->head.rays; i++) {
        const struct hit none = {.prim = ABI_NO_PRIM};
        struct hit hit;
        uint32_t tag;
        world_look_trace(&look, (enum query)request->head.query, &request->ray[i], request->mode[i],
                         &none, &hit, &tag);
        struct world_words words = world_words_of(&request->world, &hit, tag);
        if (i == WORLD_PEER_RAY)
            peer_amid(what);
        if (i == WORLD_PEER_RAY || each)
            words = world_peer_broken(what, &request->world, words);
        fwrite(&words, sizeof words, 1, stdout);
    }
    world_look_free(&look);
}

/* Answers a request whose head has been read. */
static bool world_peer_answer(const char *what, struct world_request *request)
{
    const struct pipe_request *head = &request->head;
    const bool of_world = head->version == 2;
    struct pipe_answer answer = {.version = head->version, .count = head->rays};
    memcpy(answer.magic, "RDRA", 4);
    if (memcmp(head->magic, "RDRQ", 4) != 0 || (of_world && !world_peer_read(request)))
        return false;
    answer.flags = is(what, "scenes") ? 0 : 8;
    answer.flags |= is(what, "unnamed") ? 4 : 0;
    answer.flags = is(what, "fickle") && of_world ? 0 : answer.flags;
    answer.formula = is(what, "declared") ? 1 : 0;
    answer.version = is(what, "old") && of_world ? 1 : answer.version;
    if (is(what, "few") && of_world && head->rays)
        answer.count--;
    if (is(what, "refuses") && of_world)
        answer.refused = 1, answer.count = 13;
    fwrite(&answer, sizeof answer, 1, stdout);
    if (answer.refused)
        fputs("only teapots\n", stdout);
    else if (of_world)
        world_peer_hits(what, request);
    if (is(what, "long") && head->rays)
        putchar('x');
    fflush(stdout);
    return true;
}

/* Answers requests as `what` says: of version 1 those without triangles or rays, and all of
 * version 2. The exit code of its process. */
static inline int world_peer_main(const char *what)
{
    struct world_request request = {.head = {.rays = 0}};
    while (take(&request.head, sizeof request.head))
        if ((request.head.version != 2 && (request.head.rays || request.head.triangles)) ||
            (is(what, "scenes") && request.head.version != 1) || !world_peer_answer(what, &request))
            return 9;
    free(request.ray);
    free(request.mode);
    world_free(&request.world);
    return 0;
}

#endif
