/* What the tests of the all-hits query share: a scene with its rays, packed, and engines on it.
 * Includes cmocka.h, whose macros must come last. */
#ifndef SUPPORT_ALL_HITS_FIXTURE_H
#define SUPPORT_ALL_HITS_FIXTURE_H

#include "ref/trace/all_hits.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* A scene, rays and one packed tree. */
struct fixture_stand {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray *ray;
    size_t ray_count;
};

static inline void stand_must(enum status status, const struct reason *reason)
{
    if (status)
        fail_msg("%s", reason->text);
}

static inline struct fixture_stand stand_make(const char *spec, const char *rays, size_t ray_count,
                                              const char *layout, uint32_t leaf)
{
    struct fixture_stand stand = {.ray_count = ray_count};
    struct reason reason = {""};
    struct build_options build = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    stand_must(scene_open(spec, 1, &stand.scene, &reason), &reason);
    stand_must(builder_find("median")->build(&stand.scene, &build, &stand.bvh, &reason), &reason);
    stand_must(packed_make(layout_find(layout), &stand.bvh, &stand.scene, &stand.packed, &reason),
               &reason);
    stand.ray = calloc(ray_count, sizeof *stand.ray);
    assert_non_null(stand.ray);
    stand_must(ray_set_make(ray_set_find(rays), &stand.scene, 1, ray_count, stand.ray, &reason),
               &reason);
    return stand;
}

static inline void stand_free(struct fixture_stand *stand)
{
    free(stand->ray);
    packed_free(&stand->packed);
    bvh_free(&stand->bvh);
    scene_free(&stand->scene);
}

static inline struct job stand_job(const struct fixture_stand *stand, const char *box,
                                   const char *tri, enum query query)
{
    return (struct job){.scene = &stand->scene,
                        .packed = &stand->packed,
                        .box = box_test_find(box),
                        .tri = tri_test_find(tri),
                        .query = query};
}

/* Opens an engine; the test is skipped with the reason where it cannot run. */
static inline void *stand_open(const struct engine *engine)
{
    struct engine_options options = {.threads = 2, .device = -1};
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine, &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    stand_must(status, &reason);
    return self;
}

/* All hits of all rays; the caller frees hit and first. */
struct lists {
    struct hit *hit;
    size_t *first;
    size_t again;
};

static inline struct lists stand_lists(const struct engine *engine, void *self,
                                       const struct fixture_stand *stand, const struct job *job)
{
    struct lists lists = {.first = calloc(stand->ray_count + 1, sizeof *lists.first)};
    struct all_hits all = {0};
    struct reason reason = {""};
    assert_non_null(lists.first);
    stand_must(engine->prepare(self, job, &reason), &reason);
    for (size_t at = 0; at < stand->ray_count; at += all.done) {
        stand_must(
            all_hits_next(engine, self, stand->ray + at, stand->ray_count - at, &all, &reason),
            &reason);
        assert_true(all.done > 0);
        size_t before = lists.first[at], more = all.first[all.done];
        lists.hit = realloc(lists.hit, (before + more + 1) * sizeof *lists.hit);
        assert_non_null(lists.hit);
        memcpy(lists.hit + before, all.hit, more * sizeof *lists.hit);
        for (size_t i = 1; i <= all.done; i++)
            lists.first[at + i] = before + all.first[i];
    }
    lists.again = all.again;
    all_hits_free(&all);
    return lists;
}

static inline void lists_free(struct lists *lists)
{
    free(lists->hit);
    free(lists->first);
}

#endif
