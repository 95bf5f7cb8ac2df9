/* One engine on several drivers: what tests of drivers share. Includes cmocka.h, whose macros must
 * come last. */
#ifndef TESTS_DRIVERS_H
#define TESTS_DRIVERS_H

#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include "tests/support/gpu.h"

#include <math.h>

/* A scene, rays, and its tree in one layout. */
struct drivers_view {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray *ray;
    struct hit *expected, *got;
    size_t ray_count;
};

static inline struct drivers_view view_make(const char *spec, const char *rays, size_t ray_count)
{
    struct drivers_view view = {.ray_count = ray_count};
    struct reason reason = {""};
    const struct build_options build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    gpu_must(scene_open(spec, 5, &view.scene, &reason), &reason);
    gpu_must(builder_find("median")->build(&view.scene, &build, &view.bvh, &reason), &reason);
    view.ray = calloc(ray_count, sizeof *view.ray);
    view.expected = calloc(ray_count, sizeof *view.expected);
    view.got = calloc(ray_count, sizeof *view.got);
    assert_true(view.ray && view.expected && view.got);
    gpu_must(ray_set_make(ray_set_find(rays), &view.scene, 7, ray_count, view.ray, &reason),
             &reason);
    return view;
}

static inline void view_pack(struct drivers_view *view, const char *layout)
{
    struct reason reason = {""};
    packed_free(&view->packed);
    gpu_must(packed_make(layout_find(layout), &view->bvh, &view->scene, &view->packed, &reason),
             &reason);
}

static inline void view_free(struct drivers_view *view)
{
    packed_free(&view->packed);
    bvh_free(&view->bvh);
    scene_free(&view->scene);
    free(view->ray);
    free(view->expected);
    free(view->got);
}

/* Answers all rays; returns the number of hits. */
static inline size_t driver_trace(const char *engine, void *self, const struct drivers_view *view,
                                  const struct job *job, struct hit *hit)
{
    struct reason reason = {""};
    struct trace_report report;
    size_t hits = 0;
    gpu_must(engine_find(engine)->prepare(self, job, &reason), &reason);
    gpu_must(engine_find(engine)->trace(self, view->ray, view->ray_count, hit, &report, &reason),
             &reason);
    for (size_t i = 0; i < view->ray_count; i++)
        hits += hit[i].prim != ABI_NO_PRIM;
    return hits;
}

/* Answers that differ in a bit. */
static inline size_t view_differs(const struct drivers_view *view)
{
    size_t differs = 0;
    for (size_t i = 0; i < view->ray_count; i++)
        differs += memcmp(&view->expected[i], &view->got[i], sizeof *view->got) != 0;
    return differs;
}

#endif
