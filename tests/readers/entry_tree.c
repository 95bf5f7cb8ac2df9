/* The tree file of RTRS's precompute, for a scene of four triangles. What form lets through is
 * walked: the file comes again, layouts pack it, and a traversal ends. */
#define _POSIX_C_SOURCE 200809L
#include "tests/readers/reader_entry.h"
#include "ref/tree/bvh_json.h"
#include "ref/packed/packed_file.h"
#include "ref/trace/trace.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

/* Whatever the boxes say, every ray ends; what packed_check finds in its form was made by wrapping.
 */
static void walk_packed(const struct packed *packed, const struct scene *scene)
{
    const struct ray ray = {{0.1f, 0.2f, -3}, 0, {0.01f, -0.02f, 1}, 1e30f};
    struct packed_faults faults;
    struct reason reason = {""};
    if (packed_check(packed, scene, &faults, &reason))
        reader_must_be_reason(&reason);
    for (size_t b = 0; box_tests[b]; b++) {
        struct hit hit;
        enum status status = trace_ray(&(struct job){.scene = scene,
                                                     .packed = packed,
                                                     .box = box_tests[b],
                                                     .tri = tri_tests[0],
                                                     .query = QUERY_CLOSEST},
                                       &ray, &hit, NULL);
        READER_MUST(hit.prim == ABI_NO_PRIM || hit.prim < scene->tri_count);
        READER_MUST(status == STATUS_OK || faults.cycles || faults.too_deep);
    }
}

static void must_be_tree(const struct bvh *bvh, const struct scene *scene)
{
    char *bytes = NULL;
    size_t size = 0;
    struct bvh again;
    struct reason reason = {""};
    reader_count_limit(false);
    FILE *stream = open_memstream(&bytes, &size);
    READER_MUST(stream);
    bvh_json_write(bvh, stream);
    READER_MUST(fclose(stream) == 0);
    READER_MUST(bvh_json_read("again", bytes, size, scene, &again, &reason) == STATUS_OK);
    READER_MUST(again.node_count == bvh->node_count &&
                !memcmp(again.node, bvh->node, bvh->node_count * sizeof *bvh->node));
    bvh_free(&again);
    free(bytes);
    reader_count_limit(true);
    for (size_t i = 0; layouts[i]; i++) {
        struct packed packed;
        enum status status = packed_make(layouts[i], bvh, scene, &packed, &reason);
        READER_MUST(status == STATUS_OK || status == STATUS_LIMIT);
        if (status)
            reader_must_be_reason(&reason);
        else
            walk_packed(&packed, scene);
        packed_free(&packed);
    }
}

static bool play(const char *bytes, size_t size)
{
    struct scene scene;
    struct bvh bvh;
    struct reason reason = {""};
    READER_MUST(scene_open("soup:n=4,seed=1", 1, &scene, &reason) == STATUS_OK);
    enum status status = bvh_json_read("fuzz", bytes, size, &scene, &bvh, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    else
        must_be_tree(&bvh, &scene);
    bvh_free(&bvh);
    if (!packed_file_is(bytes, size))
        reader_must_be_tree_file(bytes, size, &scene, status == STATUS_OK);
    scene_free(&scene);
    return status == STATUS_OK;
}

const struct reader_entry reader_entry = {"tree", 1 << 18, play};
