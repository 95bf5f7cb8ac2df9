#include "ref/explain/witness.h"

#include "ref/base/rng.h"

#include <string.h>

/* A ray is far from another one if it is moved or turned by more than this share. */
#define FAR 0.0625f

/* How a witness is aimed; they take turns. */
enum witness_aim {
    AIM_FROM_RAY, /* at a place of a triangle, from where the ray starts */
    AIM_MIRRORED, /* from the other side of that place */
    AIM_OUTSIDE,  /* from outside the scene */
    AIM_IN_RANGE, /* from where the ray starts, in its range */
    AIM_BESIDE,   /* the ray itself, its direction a few floats beside */
    AIM_MOVED,    /* the same, moved by a few floats, too */
    AIM_NEAR,     /* the ray itself, turned by anything from an ulp to a right angle */
    AIM_THROUGH,  /* through places of two triangles: a near hit and a far one */
    AIM_COUNT
};

/* x moved by at most three floats; 0 stays. */
static float nudged(float x, struct rng *rng)
{
    return x == 0.0f ? x : float_from_bits(float_bits(x) + rng_below(rng, 7) - 3u);
}

/* A point around the scene, outside of it. */
static void outside(const struct box *bounds, uint32_t i, float out[3])
{
    for (int k = 0; k < 3; k++) {
        float side = bounds->hi[k] - bounds->lo[k] + 1.0f;
        float away = 0.25f + 0.125f * (float)((i >> k) % 5);
        out[k] = i >> k & 1u ? bounds->hi[k] + away * side : bounds->lo[k] - away * side;
    }
}

/* A vertex of a triangle, or its middle. */
static void place(const struct scene *scene, uint32_t prim, uint32_t which, float out[3])
{
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++)
        out[k] = which < 3 ? v[which][k] : (v[0][k] + v[1][k] + v[2][k]) / 3.0f;
}

static float larger_of(const float x[3])
{
    float most = 0;
    for (int k = 0; k < 3; k++) {
        float size = x[k] < 0 ? -x[k] : x[k];
        most = size > most ? size : most;
    }
    return most;
}

/* The ray itself, a little different. */
static void aim_beside(enum witness_aim aim, struct rng *rng, struct ray *ray)
{
    float most = larger_of(ray->dir), turn = rng_scaled(rng, 0.5f, 1, -22, 23) * most;
    for (int k = 0; k < 3; k++) {
        if (aim == AIM_NEAR)
            ray->dir[k] += turn * rng_range(rng, -1, 1);
        else
            ray->dir[k] = nudged(ray->dir[k], rng);
        if (aim == AIM_MOVED)
            ray->org[k] = nudged(ray->org[k], rng);
    }
}

/* A ray at a place, or through two. */
static void aim_at(const struct explain_case *the, enum witness_aim aim, const struct box *bounds,
                   uint32_t prim, uint32_t turn, struct rng *rng, struct ray *ray)
{
    const struct scene *scene = the->replay.scene;
    float at[3], from[3];
    place(scene, prim, turn % 2 ? 3 : turn / 2 % 3, at);
    memcpy(from, ray->org, sizeof from);
    if (aim == AIM_OUTSIDE)
        outside(bounds, turn, from);
    if (aim == AIM_THROUGH)
        place(scene, rng_below(rng, scene->tri_count), 3, from);
    for (int k = 0; k < 3; k++) {
        ray->org[k] = from[k];
        if (aim == AIM_MIRRORED)
            ray->org[k] = at[k] + (at[k] - from[k]);
        if (aim == AIM_THROUGH)
            ray->org[k] = from[k] - 0.5f * (at[k] - from[k]);
        ray->dir[k] = at[k] - ray->org[k];
    }
    if (aim != AIM_IN_RANGE) {
        ray->tmin = 0;
        ray->tmax = 1e30f;
    }
}

/* Whether b is another ray than a, and not a little moved or turned. */
static bool is_far(const struct ray *a, const struct ray *b)
{
    float moved[3], turned[3];
    for (int k = 0; k < 3; k++) {
        moved[k] = b->org[k] - a->org[k];
        turned[k] = b->dir[k] - a->dir[k];
    }
    return larger_of(moved) > FAR * larger_of(a->org) ||
           larger_of(turned) > FAR * larger_of(a->dir);
}

/* At a vertex of a triangle, from the middle of another one. */
static void aim_at_vertex(const struct scene *scene, struct rng *rng, struct ray *ray)
{
    float at[3], from[3], back = rng_range(rng, 0, 4);
    uint32_t prim = rng_below(rng, scene->tri_count);
    place(scene, prim, rng_below(rng, 3), at);
    place(scene, rng_below(rng, scene->tri_count), 3, from);
    for (int k = 0; k < 3; k++) {
        ray->org[k] = from[k] - back * (at[k] - from[k]);
        ray->dir[k] = at[k] - ray->org[k];
    }
    ray->tmin = 0;
    ray->tmax = 1e30f;
}

/* The ray itself, moved along an edge of a triangle by up to half of it: how it passes what lies
 * along that edge stays as it is. */
static void move_along_edge(const struct scene *scene, struct rng *rng, struct ray *ray)
{
    float v[3][3], share = rng_range(rng, -0.5f, 0.5f);
    scene_tri(scene, rng_below(rng, scene->tri_count), v);
    uint32_t corner = rng_below(rng, 3);
    for (int k = 0; k < 3; k++)
        ray->org[k] += share * (v[(corner + 1) % 3][k] - v[corner][k]);
}

void witnesses_make(const struct explain_case *the, uint32_t round, enum witness_kind kind,
                    struct witnesses *w)
{
    const struct scene *scene = the->replay.scene;
    struct rng rng = rng_make(1, round);
    struct box bounds = scene_bounds(scene);
    uint32_t prim = 0;
    w->count = EXPLAIN_WITNESSES;
    for (uint32_t i = 0; i < w->count; i++) {
        enum witness_aim aim = (enum witness_aim)(i % AIM_COUNT);
        if (aim == 0) /* at random: neighbours in order are neighbours in slots */
            prim = rng_below(&rng, scene->tri_count);
        w->ray[i] = the->ray;
        if (kind == WITNESS_VERTICES)
            aim_at_vertex(scene, &rng, &w->ray[i]);
        else if (kind == WITNESS_ALONG)
            move_along_edge(scene, &rng, &w->ray[i]);
        else if (aim == AIM_BESIDE || aim == AIM_MOVED || aim == AIM_NEAR)
            aim_beside(aim, &rng, &w->ray[i]);
        else
            aim_at(the, aim, &bounds, prim, i / AIM_COUNT, &rng, &w->ray[i]);
        w->is_far[i] = is_far(&the->ray, &w->ray[i]);
    }
}

/* Traces ray by ray, since one that is not finished spoils the answers to all. */
static void ask_alone(const struct explain_case *the, struct witnesses *w)
{
    for (uint32_t i = 0; i < w->count; i++)
        w->answer[i].finished = the->ask(the->ask_user, &w->ray[i], 1, &w->answer[i].hit);
}

void witnesses_ask(const struct explain_case *the, struct witnesses *w)
{
    struct hit hit[EXPLAIN_WITNESSES];
    memset(w->answer, 0, sizeof w->answer);
    if (w->count == 0)
        return;
    if (!the->ask(the->ask_user, w->ray, w->count, hit)) {
        ask_alone(the, w);
        return;
    }
    for (uint32_t i = 0; i < w->count; i++)
        w->answer[i] = (struct explain_answer){.finished = true, .hit = hit[i]};
}
