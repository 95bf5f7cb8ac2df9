#include "ref/primitives/primitives.h"

#include "ref/base/base.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <string.h>

static const struct box_test box_robust = {
    .name = "robust", .summary = "slabs, far plane x (1 + 2^-19), closed", .id = ABI_BOX_ROBUST};
static const struct box_test box_watertight = {
    .name = "watertight",
    .summary = "robust, widened by woop's rounding: a closed mesh stays closed on a tree",
    .id = ABI_BOX_WATERTIGHT,
    .watertight = true};
static const struct box_test box_rtrs = {.name = "rtrs",
                                         .summary = "as published: y and z never cull",
                                         .id = ABI_BOX_RTRS,
                                         .faithful = true};

const struct box_test *const box_tests[] = {&box_robust, &box_watertight, &box_rtrs, NULL};

static const struct tri_test tri_mt = {
    .name = "mt", .summary = "Moeller-Trumbore, determinant not 0", .id = ABI_TRI_MT, .core = true};
static const struct tri_test tri_woop_test = {.name = "woop",
                                              .summary = "Woop, Benthin, Wald: watertight",
                                              .id = ABI_TRI_WOOP,
                                              .watertight = true,
                                              .core = true};
static const struct tri_test tri_mt_rtrs = {.name = "mt_rtrs",
                                            .summary = "as published: |determinant| > 1e-7, open",
                                            .id = ABI_TRI_MT_RTRS,
                                            .faithful = true,
                                            .open = true,
                                            .core = true};
static const struct tri_test tri_pluecker_test = {
    .name = "pluecker",
    .summary = "sides of edges relative to the origin, closed, no band",
    .id = ABI_TRI_PLUECKER};
static const struct tri_test tri_baldwin_webber_test = {
    .name = "baldwin_webber",
    .summary = "Baldwin-Weber: in the triangle's own coordinates",
    .id = ABI_TRI_BALDWIN_WEBBER};

const struct tri_test *const tri_tests[] = {
    &tri_mt, &tri_woop_test, &tri_mt_rtrs, &tri_pluecker_test, &tri_baldwin_webber_test, NULL};

const struct box_test *box_test_find(const char *name)
{
    for (size_t i = 0; box_tests[i]; i++)
        if (strcmp(box_tests[i]->name, name) == 0)
            return box_tests[i];
    return NULL;
}

const struct tri_test *tri_test_find(const char *name)
{
    for (size_t i = 0; tri_tests[i]; i++)
        if (strcmp(tri_tests[i]->name, name) == 0)
            return tri_tests[i];
    return NULL;
}

const char *query_name(enum query query)
{
    static const char *const names[QUERY_COUNT] = {"closest", "any", "all"};
    return query < QUERY_COUNT ? names[query] : "unknown";
}

bool query_find(const char *name, enum query *out)
{
    *out = QUERY_CLOSEST;
    for (enum query query = QUERY_CLOSEST; query < QUERY_COUNT; query++)
        if (strcmp(name, query_name(query)) == 0) {
            *out = query;
            return true;
        }
    return false;
}

bool ray_in_contract(const struct ray *ray)
{
    float largest = 0.0f;
    for (int k = 0; k < 3; k++) {
        if (!float_is_finite(ray->org[k]) || !float_is_finite(ray->dir[k]))
            return false;
        if (fabsf(ray->org[k]) > 0x1p40f)
            return false;
        largest = fmaxf(largest, fabsf(ray->dir[k]));
    }
    if (!(largest >= 0x1p-40f && largest <= 0x1p40f))
        return false;
    for (int k = 0; k < 3; k++)
        if (ray->dir[k] != 0.0f && fabsf(ray->dir[k]) < SLAB_PARALLEL * largest)
            return false;
    return ray->tmin >= 0.0f && ray->tmin <= ray->tmax && float_is_finite(ray->tmin);
}
