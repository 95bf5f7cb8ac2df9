/* What the leak counter counts, by its definition in ref/judge/leaks.h, written anew by positions.
 * Includes cmocka.h. */
#ifndef LEAK_DEFINITION_H
#define LEAK_DEFINITION_H

#include "ref/judge/leaks.h"
#include "ref/twin/twin.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define MOST 6u /* hits of a list */

struct counted {
    struct scene scene;
    struct topology topology;
    struct oracle *oracle;
};

/* Brings `welds` pairs of vertices together, where fans of several rings meet. */
static void counted_make(const char *spec, uint32_t welds, struct counted *c)
{
    struct reason reason = {""};
    if (scene_open(spec, 1, &c->scene, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < welds; i++) {
        float *one = c->scene.vertex + 3 * (size_t)(i * (c->scene.vertex_count / welds));
        const float *other = c->scene.vertex + 3 * (size_t)(c->scene.vertex_count - 1 - i);
        memcpy(one, other, 3 * sizeof *one);
    }
    if (topology_make(&c->scene, &c->topology, &reason) ||
        oracle_make(&c->scene, &c->oracle, &reason))
        fail_msg("%s", reason.text);
}

static void counted_free(struct counted *c)
{
    oracle_free(c->oracle);
    topology_free(&c->topology);
    scene_free(&c->scene);
}

static bool same_place(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Corners that two triangles have in common, and whether they run along an edge both ways. */
static int common_corners(const struct counted *c, uint32_t a, uint32_t b, bool *edge)
{
    float v[3][3], w[3][3];
    int count = 0;
    scene_tri(&c->scene, a, v);
    scene_tri(&c->scene, b, w);
    *edge = false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            count += same_place(v[i], w[j]);
            *edge = *edge || (same_place(v[i], w[(j + 1) % 3]) && same_place(v[(i + 1) % 3], w[j]));
        }
    return count;
}

static int side_of(const struct counted *c, const struct ray *ray, uint32_t prim)
{
    struct oracle_pair pair;
    oracle_pair(c->oracle, ray, prim, &pair);
    return pair.det;
}

static struct twin twin_of(const struct counted *c, const struct model *model,
                           const struct ray *ray, uint32_t prim)
{
    float v[3][3];
    scene_tri(&c->scene, prim, v);
    return twin_eval(model->formula, model->rounding, ray, v);
}

/* True if all triangles around the corner are seen from this side, exactly or by a model's twin,
 * and are one ring. */
static bool around(const struct counted *c, const struct model *model, const struct ray *ray,
                   const float corner[3], int side)
{
    for (uint32_t i = 0; i < c->scene.tri_count; i++) {
        float v[3][3];
        scene_tri(&c->scene, i, v);
        for (uint32_t k = 0; k < 3; k++) {
            if (!same_place(v[k], corner) || same_place(v[0], v[1]) || same_place(v[1], v[2]) ||
                same_place(v[2], v[0])) /* in no fan */
                continue;
            if (!topology_fan_is_ring(&c->topology, c->topology.corner[3 * i + k]) ||
                (model ? twin_of(c, model, ray, i).det : side_of(c, ray, i)) != side)
                return false;
        }
    }
    return true;
}

static bool excludes(const struct counted *c, const struct ray *ray, uint32_t a, uint32_t b)
{
    bool edge, flat = false;
    float v[3][3], w[3][3];
    int side = side_of(c, ray, a);
    if (side == 0 || side_of(c, ray, b) != side || common_corners(c, a, b, &edge) == 0)
        return false;
    scene_tri(&c->scene, a, v);
    scene_tri(&c->scene, b, w);
    for (int i = 0; i < 9; i++)
        flat = flat || (same_place(v[i / 3], w[i % 3]) && around(c, NULL, ray, v[i / 3], side));
    return edge || flat;
}

/* Groups of triangles that exclude each other; each group may have one. */
static size_t groups_of(const struct counted *c, const struct ray *ray, const uint32_t *prim,
                        size_t count)
{
    size_t group[MOST], groups = 0;
    for (size_t i = 0; i < count; i++)
        group[i] = i;
    for (size_t round = 0; round < count; round++)
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < count; k++)
                if (i != k && group[k] < group[i] && excludes(c, ray, prim[i], prim[k]))
                    group[i] = group[k];
    for (size_t i = 0; i < count; i++)
        groups += group[i] == i;
    return groups;
}

/* A triangle whose loss means that a wall was passed through. */
static bool stands(const struct counted *c, const struct model *model, const struct ray *ray,
                   uint32_t prim)
{
    float v[3][3];
    if (model->formula == TWIN_UNKNOWN)
        return true;
    struct twin twin = twin_of(c, model, ray, prim);
    bool all = true;
    scene_tri(&c->scene, prim, v);
    for (int e = 0; e < 3; e++) /* the edge opposite corner e has the other two */
        if (twin.edge[e] == 0)
            all = all && twin.det != 0 && around(c, model, ray, v[(e + 1) % 3], twin.det) &&
                  around(c, model, ray, v[(e + 2) % 3], twin.det);
    return twin.certain || all;
}

static void count_walls(const struct counted *c, const struct model *model, const struct ray *ray,
                        const uint32_t *prim, size_t count, struct leak_tally *tally)
{
    bool lost = false, met[MOST] = {false}, phantom = false, edge;
    for (uint32_t i = 0; i < c->scene.tri_count; i++) {
        struct oracle_pair pair;
        bool beside = false;
        oracle_pair(c->oracle, ray, i, &pair);
        if ((!oracle_is_hit(&pair) && pair.class != ORACLE_IN_PLANE) ||
            !oracle_in_range(&pair, ORACLE_CLOSED))
            continue;
        for (size_t k = 0; k < count; k++)
            if (common_corners(c, prim[k], i, &edge) > 0)
                beside = met[k] = true;
        lost = lost || (pair.class == ORACLE_INSIDE && !beside && stands(c, model, ray, i));
    }
    for (size_t k = 0; k < count; k++)
        phantom = phantom || (!met[k] && (model->formula == TWIN_UNKNOWN ||
                                          !twin_of(c, model, ray, prim[k]).possible));
    tally->lost += lost;
    tally->phantoms += phantom;
}

#endif
