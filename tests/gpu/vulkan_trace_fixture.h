/* What test_vulkan_trace.c and test_vulkan_trace_ends.c share. */
#ifndef VULKAN_TRACE_FIXTURE_H
#define VULKAN_TRACE_FIXTURE_H

#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/gpu.h"
#include "tests/support/tree_fixture.h"
#include <math.h>

#define RAYS 3000

/* A scene, its tree in one layout, rays, and C's answers. */
struct gpu_case {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray *ray;
    struct hit *expected, *got;
    size_t ray_count;
};

static struct scene soup(double count)
{
    struct scene scene;
    struct reason reason = {""};
    const struct generator *generator = generator_find("soup");
    double value[GENERATOR_PARAMS] = {0};
    for (int k = 0; k < GENERATOR_PARAMS && generator->param[k].name; k++)
        value[k] = generator->param[k].value;
    value[0] = count;
    gpu_must(generator_make(generator, value, 5, &scene, &reason), &reason);
    return scene;
}

static struct gpu_case pack(struct scene scene, struct bvh bvh, const char *layout, size_t rays)
{
    struct gpu_case f = {.scene = scene, .bvh = bvh, .ray_count = rays};
    struct reason reason = {""};
    gpu_must(packed_make(layout_find(layout), &f.bvh, &f.scene, &f.packed, &reason), &reason);
    f.ray = calloc(rays + 1, sizeof *f.ray);
    f.expected = calloc(rays + 1, sizeof *f.expected);
    f.got = calloc(rays + 1, sizeof *f.got);
    assert_true(f.ray && f.expected && f.got);
    if (f.scene.tri_count)
        gpu_must(ray_set_make(ray_sets[0], &f.scene, 3, rays, f.ray, &reason), &reason);
    return f;
}

static inline struct gpu_case fixture(const char *layout, uint32_t leaf, size_t rays)
{
    struct scene scene = soup(300);
    struct bvh bvh;
    struct reason reason = {""};
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    gpu_must(builder_find("median")->build(&scene, &options, &bvh, &reason), &reason);
    return pack(scene, bvh, layout, rays);
}

static void release(struct gpu_case *f)
{
    packed_free(&f->packed);
    bvh_free(&f->bvh);
    scene_free(&f->scene);
    free(f->ray);
    free(f->expected);
    free(f->got);
}

static struct job job_of(const struct gpu_case *f, const char *box, const char *tri,
                         enum query query)
{
    return (struct job){.scene = &f->scene,
                        .packed = &f->packed,
                        .box = box_test_find(box),
                        .tri = tri_test_find(tri),
                        .query = query};
}

static void expect(struct gpu_case *f, const struct job *job)
{
    for (size_t i = 0; i < f->ray_count; i++)
        assert_int_equal(trace_ray(&(struct job){.scene = &f->scene,
                                                 .packed = &f->packed,
                                                 .box = job->box,
                                                 .tri = job->tri,
                                                 .query = job->query},
                                   &f->ray[i], &f->expected[i], NULL),
                         STATUS_OK);
}

/* Traces all rays; the bits must be C's, and what lies behind the last hit untouched. */
static size_t must_agree(struct tracer *tracer, struct gpu_case *f, const struct job *job)
{
    struct reason reason = {""};
    struct trace_report report;
    memset(f->got, 0xA5, (f->ray_count + 1) * sizeof *f->got);
    struct hit canary = f->got[f->ray_count];
    expect(f, job);
    gpu_must(tracer_prepare(tracer, job, &reason), &reason);
    gpu_must(tracer_trace(tracer, f->ray, f->ray_count, f->got, &report, &reason), &reason);
    size_t hits = 0;
    for (size_t i = 0; i < f->ray_count; i++) {
        hits += f->expected[i].prim != ABI_NO_PRIM;
        if (memcmp(&f->expected[i], &f->got[i], sizeof f->got[i]) != 0)
            fail_msg("%s %s %s query %d, ray %zu: prim %u t %a, C has prim %u t %a",
                     job->packed->layout->name, job->box->name, job->tri->name, (int)job->query, i,
                     f->got[i].prim, (double)f->got[i].t, f->expected[i].prim,
                     (double)f->expected[i].t);
    }
    assert_memory_equal(&f->got[f->ray_count], &canary, sizeof canary);
    return hits;
}

#endif
