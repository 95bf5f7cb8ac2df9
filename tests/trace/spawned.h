/* A scene and rays that hit it, for the tests of spawned rays. Include first. */
#ifndef TESTS_SPAWNED_H
#define TESTS_SPAWNED_H

#include "bench/measure/spawn.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAYS 3000

/* A scene and hits on it; the oracle borrows the scene, so that it stays where it is. */
struct field {
    struct scene scene;
    struct oracle *oracle;
    struct topology topology;
    struct spawn_hit hit[RAYS];
    size_t count;
};

static inline void prepare(struct field *f)
{
    struct reason reason = {""};
    if (oracle_make(&f->scene, &f->oracle, &reason) ||
        topology_make(&f->scene, &f->topology, &reason))
        fail_msg("%s", reason.text);
}

static inline struct field *opened(const char *spec, float scale, float offset)
{
    struct field *f = calloc(1, sizeof *f);
    struct reason reason = {""};
    assert_non_null(f);
    if (scene_open(spec, 1, &f->scene, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < 3 * (size_t)f->scene.vertex_count; i++)
        f->scene.vertex[i] = scale * (f->scene.vertex[i] + offset);
    prepare(f);
    return f;
}

static inline void closed(struct field *f)
{
    topology_free(&f->topology);
    oracle_free(f->oracle);
    scene_free(&f->scene);
    free(f);
}

static inline struct oracle_answer truth_of(const struct field *f, const struct ray *ray)
{
    struct oracle_answer truth;
    struct reason reason = {""};
    if (oracle_closest(f->oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, 1, 1, &truth, NULL, &reason))
        fail_msg("%s", reason.text);
    return truth;
}

static inline void shoot(struct field *f, const char *set, const char *tri)
{
    struct ray *ray = calloc(RAYS, sizeof *ray);
    struct reason reason = {""};
    assert_non_null(ray);
    if (ray_set_make(ray_set_find(set), &f->scene, 7, RAYS, ray, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < RAYS; i++) {
        struct oracle_answer truth = truth_of(f, &ray[i]);
        struct rng rng = rng_make(9, i);
        bool made = spawn_hit_make(f->oracle, &f->scene, tri_test_find(tri), &ray[i], &truth, &rng,
                                   &f->hit[f->count]);
        assert_false(made && truth.prim == ABI_NO_PRIM);
        f->count += made;
    }
    free(ray);
    assert_true(f->count > RAYS / 20);
}

#endif
