/* What the tests of ray sets share. */
#ifndef SUPPORT_RAY_FIXTURE_H
#define SUPPORT_RAY_FIXTURE_H

#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define COUNT 1200 /* rays of a set, unless a test says otherwise */

/* A generated scene: its first parameter may be chosen, the others keep their defaults. */
static inline struct scene make_scene(const char *name, double first)
{
    const struct generator *generator = generator_find(name);
    double value[GENERATOR_PARAMS] = {0};
    struct scene scene;
    struct reason reason = {""};
    assert_non_null(generator);
    for (int k = 0; k < GENERATOR_PARAMS && generator->param[k].name; k++)
        value[k] = generator->param[k].value;
    if (first >= 0)
        value[0] = first;
    if (generator_make(generator, value, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static inline struct scene default_scene(const char *name)
{
    return make_scene(name, -1);
}

static inline void make_rays(const char *set, const struct scene *scene, uint64_t seed,
                             size_t count, struct ray *out)
{
    struct reason reason = {""};
    assert_non_null(ray_set_find(set));
    if (ray_set_make(ray_set_find(set), scene, seed, count, out, &reason))
        fail_msg("%s: %s", set, reason.text);
}

static inline struct hit brute(const struct scene *scene, const struct ray *ray)
{
    struct hit hit;
    trace_brute(scene, tri_test_find("mt"), QUERY_CLOSEST, ray, &hit);
    return hit;
}

#endif
