/* The text form of requests and answers: files of rays and of hits for raydiff judge, and what
 * comes over shell pipes to raydiff verify. The first byte states what is known of the answers: 1
 * and 2 a scene, 3 the world below. */
#define _POSIX_C_SOURCE 200809L
#include "tests/readers/reader_entry.h"
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_text.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

static struct world *world(void)
{
    static float vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static uint32_t index[6] = {0, 1, 2, 0, 2, 1}, first[3] = {0, 2, 2};
    static struct scene scene = {
        .vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 2};
    static struct geometry geometry[2] = {{0, 1, true}, {1, 1, false}};
    static struct world_mesh mesh = {&scene, geometry, 2};
    static struct instance instance[2] = {
        {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, 0, 7, 255, 0},
        {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, WORLD_NO_MESH, 0, 255, 0}};
    static struct world out = {.mesh = &mesh,
                               .instance = instance,
                               .first = first,
                               .mesh_count = 1,
                               .instance_count = 2,
                               .borrows = true};
    return &out;
}

static uint64_t hash_of(const struct pipe_text *text)
{
    return text->version == PIPE_VERSION_WORLD
               ? pipe_hash_world(&text->world, text->ray, text->mode, text->ray_count, text->query)
               : pipe_hash(&text->scene, text->ray, text->ray_count, text->query);
}

/* A request survives writing and reading back. */
static void must_be_request(const struct pipe_text *text)
{
    const struct pipe_limits limits = {.rays = 0, .triangles = UINT32_MAX};
    char *bytes = NULL;
    size_t size = 0;
    struct reason reason = {""};
    struct pipe_text again;
    reader_count_limit(false);
    for (int decimal = 0; decimal < 2; decimal++) {
        FILE *stream = open_memstream(&bytes, &size);
        READER_MUST(stream);
        if (text->version == PIPE_VERSION_WORLD)
            pipe_text_write_world(stream, &text->from, &text->world, text->ray, text->mode,
                                  text->ray_count, text->query, decimal);
        else
            pipe_text_write(stream, &text->from, &text->scene, text->ray, text->ray_count,
                            text->query, decimal);
        READER_MUST(fclose(stream) == 0);
        READER_MUST(pipe_text_parse("again", bytes, size, &limits, &again, &reason) == STATUS_OK);
        READER_MUST(again.ray_count == text->ray_count && again.query == text->query);
        READER_MUST(again.version == text->version && hash_of(&again) == hash_of(text));
        READER_MUST(again.from.seed == text->from.seed && again.from.hash == text->from.hash &&
                    again.from.count == text->from.count &&
                    strcmp(again.from.spec, text->from.spec) == 0 &&
                    strcmp(again.from.modes, text->from.modes) == 0 &&
                    strcmp(again.from.rays, text->from.rays) == 0);
        pipe_text_free(&again);
        free(bytes);
        bytes = NULL;
    }
    reader_count_limit(true);
}

static bool play(const char *bytes, size_t size)
{
    const struct pipe_limits limits[] = {pipe_limits_none(),
                                         {.rays = 2, .triangles = 3},
                                         {.rays = 0, .triangles = 0},
                                         {.rays = 2, .triangles = 0, .world = world()}};
    struct pipe_text text;
    struct reason reason = {""};
    const struct pipe_limits *limit = &limits[0];
    if (size > 0 && bytes[0] >= '\1' && bytes[0] <= '\3') {
        limit = &limits[(int)bytes[0]];
        bytes++;
        size--;
    }
    enum status status = pipe_text_parse("fuzz", bytes, size, limit, &text, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status) {
        reader_must_be_reason(&reason);
        return false;
    }
    struct model model;
    READER_MUST(pipe_model(text.formula, text.rounding, text.flags, &model, &reason) == STATUS_OK);
    READER_MUST(text.hit_count <= limit->rays && text.query <= QUERY_ANY);
    const uint32_t triangles = limit->world ? world_tri_count(limit->world) : limit->triangles;
    for (size_t i = 0; i < text.hit_count; i++)
        READER_MUST(text.hit[i].prim == ABI_NO_PRIM || text.hit[i].prim < triangles);
    READER_MUST(text.version == PIPE_VERSION || text.version == PIPE_VERSION_WORLD);
    READER_MUST(!limit->world || !text.hit_count || text.version == PIPE_VERSION_WORLD);
    READER_MUST((text.mode != NULL) == (text.version == PIPE_VERSION_WORLD && text.ray_count > 0));
    for (size_t i = 0; i < text.ray_count && text.mode; i++)
        READER_MUST(ray_mode_check(text.mode[i], &reason) == STATUS_OK);
    if (text.version == PIPE_VERSION_WORLD)
        READER_MUST(world_finish(&text.world, &reason) == STATUS_OK);
    if (text.scene.vertex_count)
        READER_MUST(scene_check(&text.scene, &reason) == STATUS_OK);
    if (text.from.spec[0] && !text.hit_count && (text.scene.tri_count || text.world.instance_count))
        must_be_request(&text);
    pipe_text_free(&text);
    return true;
}

const struct reader_entry reader_entry = {"text", 1 << 18, play};
