/* What the tests of the traversal share. Include after cmocka.h. */
#ifndef SUPPORT_TRACE_FIXTURE_H
#define SUPPORT_TRACE_FIXTURE_H

#include "ref/trace/trace.h"
#include "scenes/scenes.h"
#include "tests/support/held.h"

#define TMAX 1e30f

static const char *const repaired[] = {"f32", "rf16"};

static inline struct packed pack(const char *layout, const struct bvh *bvh,
                                 const struct scene *scene)
{
    struct packed packed;
    struct reason reason = {""};
    if (packed_make(layout_find(layout), bvh, scene, &packed, &reason))
        fail_msg("%s", reason.text);
    return packed;
}

static inline struct scene generated(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static inline struct bvh median(const struct scene *scene, uint32_t leaf)
{
    struct bvh bvh;
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    assert_int_equal(builder_find("median")->build(scene, &options, &bvh, NULL), STATUS_OK);
    return bvh;
}

/* Closest hit with the robust box test and mt; counts may be NULL. */
static inline struct hit closest(const struct packed *packed, const struct scene *scene,
                                 const struct ray *ray, struct trace_counts *counts)
{
    struct hit hit;
    assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                             .packed = packed,
                                             .box = box_test_find("robust"),
                                             .tri = tri_test_find("mt"),
                                             .query = QUERY_CLOSEST},
                               ray, &hit, counts),
                     STATUS_OK);
    return hit;
}

#endif
