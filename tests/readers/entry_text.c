/* The text form of requests and answers: files of rays and of hits for raydiff judge, and what
 * comes over shell pipes to raydiff verify. The first byte says what is known of the answers. */
#define _POSIX_C_SOURCE 200809L
#include "tests/readers/reader_entry.h"
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_text.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

/* A request survives writing and reading back. */
static void must_be_request(const struct pipe_text *text)
{
    const struct pipe_limits limits = {0, 0};
    char *bytes = NULL;
    size_t size = 0;
    struct reason reason = {""};
    struct pipe_text again;
    reader_count_limit(false);
    for (int decimal = 0; decimal < 2; decimal++) {
        FILE *stream = open_memstream(&bytes, &size);
        READER_MUST(stream);
        pipe_text_write(stream, &text->from, &text->scene, text->ray, text->ray_count, text->query,
                        decimal);
        READER_MUST(fclose(stream) == 0);
        READER_MUST(pipe_text_parse("again", bytes, size, &limits, &again, &reason) == STATUS_OK);
        READER_MUST(again.ray_count == text->ray_count && again.query == text->query);
        READER_MUST(pipe_hash(&again.scene, again.ray, again.ray_count, again.query) ==
                    pipe_hash(&text->scene, text->ray, text->ray_count, text->query));
        READER_MUST(again.from.seed == text->from.seed && again.from.hash == text->from.hash &&
                    again.from.count == text->from.count &&
                    strcmp(again.from.spec, text->from.spec) == 0 &&
                    strcmp(again.from.rays, text->from.rays) == 0);
        pipe_text_free(&again);
        free(bytes);
        bytes = NULL;
    }
    reader_count_limit(true);
}

static bool play(const char *bytes, size_t size)
{
    static const struct pipe_limits limits[] = {{SIZE_MAX, UINT32_MAX}, {2, 3}, {0, 0}};
    struct pipe_text text;
    struct reason reason = {""};
    const struct pipe_limits *limit = &limits[0];
    if (size > 0 && (bytes[0] == '\1' || bytes[0] == '\2')) {
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
    for (size_t i = 0; i < text.hit_count; i++)
        READER_MUST(text.hit[i].prim == ABI_NO_PRIM || text.hit[i].prim < limit->triangles);
    if (text.scene.vertex_count)
        READER_MUST(scene_check(&text.scene, &reason) == STATUS_OK);
    if (text.from.spec[0] && text.scene.tri_count && !text.hit_count)
        must_be_request(&text);
    pipe_text_free(&text);
    return true;
}

const struct reader_entry reader_entry = {"text", 1 << 18, play};
