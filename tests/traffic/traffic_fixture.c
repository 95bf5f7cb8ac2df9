#include "tests/traffic/traffic_fixture.h"

#include <math.h>
#include <stdio.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

/* Adds each triangle once more. */
static void double_triangles(struct scene *scene)
{
    struct scene twice;
    size_t indices = 3 * (size_t)scene->tri_count;
    assert_int_equal(scene_make(scene->vertex_count, 2 * scene->tri_count, &twice), STATUS_OK);
    memcpy(twice.vertex, scene->vertex, 3 * (size_t)scene->vertex_count * sizeof *twice.vertex);
    memcpy(twice.index, scene->index, indices * sizeof *twice.index);
    memcpy(twice.index + indices, scene->index, indices * sizeof *twice.index);
    scene_free(scene);
    *scene = twice;
}

bool traffic_case_open(const char *spec, const char *layout, const char *store,
                       struct traffic_case *out)
{
    struct reason reason = {""};
    bool twice = strncmp(spec, TRAFFIC_TWICE, strlen(TRAFFIC_TWICE)) == 0;
    int power = 0, length = 0;
    if (sscanf(spec, TRAFFIC_SCALED "%d %n", &power, &length) == 1)
        spec += length;
    const struct build_options build = {.leaf = twice ? 1 : 3, .eps = BUILD_EPS_DEFAULT};
    memset(out, 0, sizeof *out);
    if (scene_open(spec + (twice ? strlen(TRAFFIC_TWICE) : 0), 1, &out->scene, &reason))
        fail_msg("%s: %s", spec, reason.text);
    if (twice)
        double_triangles(&out->scene);
    for (size_t i = 0; i < 3 * (size_t)out->scene.vertex_count; i++)
        out->scene.vertex[i] = ldexpf(out->scene.vertex[i], power);
    if (bvh_build(builder_find(twice ? "median" : "sah_binned"), &out->scene, &build, &out->bvh,
                  &reason))
        fail_msg("%s: %s", spec, reason.text);
    enum status status = packed_make_stored(layout_find(layout), tri_store_find(store), &out->bvh,
                                            &out->scene, &out->packed, &reason);
    if (status) {
        assert_int_equal(status, STATUS_LIMIT);
        traffic_case_close(out);
        return false;
    }
    out->job = (struct job){.scene = &out->scene,
                            .packed = &out->packed,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = QUERY_CLOSEST};
    return true;
}

void traffic_case_start(struct traffic_case *c, size_t paths, uint32_t depth, uint64_t treelet)
{
    struct reason reason = {""};
    struct packed packed;
    struct job job = c->job;
    job.packed = &packed;
    if (packed_make(layouts[0], &c->bvh, &c->scene, &packed, &reason) ||
        traffic_paths_make(&job, 3, paths, depth, &c->paths, &reason) ||
        traffic_paths_trace(&c->paths, &c->job, &reason) ||
        traffic_walker_make(&c->job, treelet, &c->walker, &reason) ||
        treelets_runs(&c->walker.treelets, &c->walker.touch, &reason))
        fail_msg("%s", reason.text);
    packed_free(&packed);
}

void traffic_case_stop(struct traffic_case *c)
{
    traffic_paths_free(&c->paths);
    traffic_walker_free(&c->walker);
}

void traffic_case_close(struct traffic_case *c)
{
    kd_free(&c->kd);
    packed_free(&c->packed);
    bvh_free(&c->bvh);
    scene_free(&c->scene);
}

struct traffic_machine traffic_small(void)
{
    return (struct traffic_machine){
        .memory = {.cache = {{1024, 2, 64}, {4096, 4, 64}}, .units = 2, .row_bytes = 1024},
        .lanes = 3,
        .packet = 5,
        .treelet = 1024,
        .queue = 70};
}

struct traffic_result traffic_case_play(struct traffic_case *c, const char *scheduler,
                                        const struct traffic_machine *machine)
{
    struct reason reason = {""};
    struct traffic_result result;
    if (scheduler_find(scheduler)->kd && !c->kd.node && kd_make(&c->scene, &c->kd, &reason))
        fail_msg("%s", reason.text);
    struct traffic_run run = {.machine = machine,
                              .paths = &c->paths,
                              .depth = c->paths.depth,
                              .walker = &c->walker,
                              .kd = &c->kd};
    if (traffic_play(scheduler_find(scheduler), &run, &result, &reason))
        fail_msg("%s: %s", scheduler, reason.text);
    return result;
}
