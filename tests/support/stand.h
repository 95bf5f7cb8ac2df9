/* What the suites of the twins' bounds and of the judge's noise go through: every formula, every
 * rounding, and how a pair is printed. Include after cmocka.h. */
#ifndef TESTS_STAND_H
#define TESTS_STAND_H

#include "ref/twin/model.h"
#include "ref/twin/twin.h"
#include "ref/primitives/primitives.h"

#include <math.h>

static const struct {
    const char *name;
    enum twin_formula formula;
} formulas[] = {
    {"mt", TWIN_MT},
    {"mt_rtrs", TWIN_MT_RTRS},
    {"woop", TWIN_WOOP},
    {"pluecker", TWIN_PLUECKER},
    {"baldwin_webber", TWIN_BALDWIN_WEBBER},
    {"tri_accel", TWIN_TRI_ACCEL},
    {"embree", TWIN_EMBREE},
    {"embree_robust", TWIN_EMBREE_ROBUST},
};

struct stand_rounding {
    const char *name;
    struct rounding rounding;
    bool fuses;
};

/* Those that fuse where their engines do. */
static const struct stand_rounding roundings[] = {
    {"ieee", ROUNDING_IEEE, false},
    {"flushed", ROUNDING_FLUSHED, false},
    {"vulkan rte", ROUNDING_VULKAN_RTE, false},
    {"vulkan", ROUNDING_VULKAN, false},
    {"embree", ROUNDING_EMBREE, true},
};

/* Whether the judge promises something of ray and triangle. */
static inline bool pair_in_contract(const struct ray *ray, const float v[3][3])
{
    bool in = ray_in_contract(ray);
    for (int i = 0; i < 9; i++)
        in = in && fabsf(v[i / 3][i % 3]) <= 0x1p40f;
    return in;
}

static inline void print_pair(const struct ray *ray, const float v[3][3])
{
    print_message("o %a %a %a d %a %a %a tmin %a tmax %a\n", (double)ray->org[0],
                  (double)ray->org[1], (double)ray->org[2], (double)ray->dir[0],
                  (double)ray->dir[1], (double)ray->dir[2], (double)ray->tmin, (double)ray->tmax);
    for (int c = 0; c < 3; c++)
        print_message("v%d %a %a %a\n", c, (double)v[c][0], (double)v[c][1], (double)v[c][2]);
}

#endif
