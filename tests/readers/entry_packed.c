/* A packed tree from outside, for a scene of four triangles: what the reader lets through is safe
 * to trace, with every test, by every way. */
#define _POSIX_C_SOURCE 200809L
#include "tests/readers/reader_entry.h"
#include "ref/packed/packed_file.h"
#include "ref/trace/trace.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

#define RAYS 6

static const struct ray rays[RAYS] = {
    {{0.1f, 0.2f, -3}, 0, {0.01f, -0.02f, 1}, 1e30f},
    {{-4, -4, -4}, 0, {1, 1, 1}, 1e30f},
    {{0, 0, 0}, 0, {0, 0, -1}, 1e30f},
    {{2, 0.5f, 0.5f}, -1, {-1, 0, 0}, 1e30f},
    {{0.5f, 3, 0.5f}, 0, {0, -1, 0}, 2},
    {{0, 0, 0}, 0, {0, 0, 0}, 1},
};

static void must_trace(const struct packed *packed, const struct scene *scene,
                       const struct box_test *box, const struct tri_test *tri, enum query query)
{
    struct hit one, all[RAYS], listed[8];
    uint32_t flag[RAYS], count;
    READER_MUST(
        trace_rays(
            &(struct job){.scene = scene, .packed = packed, .box = box, .tri = tri, .query = query},
            rays, RAYS, all, flag, NULL) == STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) {
        READER_MUST(
            trace_ray(
                &(struct job){
                    .scene = scene, .packed = packed, .box = box, .tri = tri, .query = query},
                &rays[i], &one, NULL) == STATUS_OK);
        READER_MUST(memcmp(&one, &all[i], sizeof one) == 0);
        READER_MUST(one.prim == ABI_NO_PRIM || one.prim < scene->tri_count);
        READER_MUST(
            trace_ray_all(
                &(struct job){
                    .scene = scene, .packed = packed, .box = box, .tri = tri, .query = QUERY_ALL},
                &rays[i], 8, listed, &count, NULL) == STATUS_OK);
        READER_MUST(one.prim == ABI_NO_PRIM || count > 0);
    }
}

static void must_be_packed(const struct packed *packed, const struct scene *scene,
                           const char *bytes, size_t size)
{
    char *again = NULL;
    size_t length = 0;
    reader_count_limit(false);
    FILE *stream = open_memstream(&again, &length);
    READER_MUST(stream);
    packed_file_write(packed, stream);
    READER_MUST(fclose(stream) == 0);
    READER_MUST(length == size && memcmp(again, bytes, size) == 0);
    free(again);
    reader_count_limit(true);
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++)
            for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
                must_trace(packed, scene, box_tests[b], tri_tests[t], query);
}

static bool play(const char *bytes, size_t size)
{
    struct scene scene;
    struct packed packed;
    struct packed_faults faults;
    struct reason reason = {""};
    READER_MUST(scene_open("soup:n=4,seed=1", 1, &scene, &reason) == STATUS_OK);
    enum status status = packed_file_read("fuzz", bytes, size, &scene, &packed, &faults, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status || faults.loose_boxes || faults.lost_prims || faults.double_prims)
        reader_must_be_reason(&reason);
    else
        READER_MUST(reason.text[0] == '\0');
    if (!status)
        must_be_packed(&packed, &scene, bytes, size);
    packed_free(&packed);
    if (packed_file_is(bytes, size))
        reader_must_be_tree_file(bytes, size, &scene, status == STATUS_OK);
    scene_free(&scene);
    return status == STATUS_OK;
}

const struct reader_entry reader_entry = {"packed", 1 << 18, play};
