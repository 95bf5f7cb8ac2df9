#include "ref/explain/witness.h"

#include "ref/rng.h"

/* How a witness is aimed; they take turns. */
enum aim { AIM_FROM_RAY, AIM_MIRRORED, AIM_OUTSIDE, AIM_IN_RANGE, AIM_BESIDE, AIM_COUNT };

/* x moved by at most three floats. */
static float nudged(float x, struct rng *rng)
{
    return float_from_bits(float_bits(x) + rng_below(rng, 7) - 3u);
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

/* Rays through all of the scene, at middles and at vertices of triangles: from where the ray starts
 * (also in its own range), from the other side, from outside; and the ray itself, a few floats
 * beside. */
static void make_witnesses(const struct explain_case *the, uint32_t round, struct ray *ray)
{
    const struct scene *scene = the->replay.scene;
    const uint32_t aimed = 2 * AIM_COUNT;
    struct rng rng = rng_make(1, round);
    uint32_t prim = 0;
    struct box bounds = scene_bounds(scene);
    for (uint32_t i = 0; i < EXPLAIN_WITNESSES; i++) {
        enum aim aim = (enum aim)(i % AIM_COUNT);
        uint32_t place = i / aimed;
        if (i % aimed == 0) /* at random: neighbours in order are neighbours in slots */
            prim = rng_below(&rng, scene->tri_count);
        float v[3][3], from[3];
        scene_tri(scene, prim, v);
        outside(&bounds, place, from);
        ray[i] = the->ray;
        if (aim == AIM_BESIDE) {
            for (int k = 0; k < 3; k++)
                ray[i].dir[k] = nudged(the->ray.dir[k], &rng);
            continue;
        }
        if (aim != AIM_IN_RANGE) {
            ray[i].tmin = 0;
            ray[i].tmax = 1e30f;
        }
        for (int k = 0; k < 3; k++) {
            float at = v[place % 3][k];
            if (i % aimed < AIM_COUNT)
                at = (v[0][k] + v[1][k] + v[2][k]) / 3.0f;
            ray[i].org[k] = aim == AIM_OUTSIDE ? from[k] : the->ray.org[k];
            if (aim == AIM_MIRRORED)
                ray[i].org[k] = at + (at - the->ray.org[k]);
            ray[i].dir[k] = at - ray[i].org[k];
        }
    }
}

/* Asks ray by ray, since one that is not finished spoils the answers to all. */
static void ask_alone(const struct explain_case *the, struct witnesses *w)
{
    for (uint32_t i = 0; i < EXPLAIN_WITNESSES; i++)
        w->answer[i].finished = the->ask(the->ask_user, &w->ray[i], 1, &w->answer[i].hit);
}

void witnesses_ask(const struct explain_case *the, uint32_t round, struct witnesses *w)
{
    struct hit hit[EXPLAIN_WITNESSES];
    w->count = 0;
    if (!the->ask || the->replay.scene->tri_count == 0)
        return;
    w->count = EXPLAIN_WITNESSES;
    make_witnesses(the, round, w->ray);
    if (!the->ask(the->ask_user, w->ray, EXPLAIN_WITNESSES, hit)) {
        ask_alone(the, w);
        return;
    }
    for (uint32_t i = 0; i < EXPLAIN_WITNESSES; i++)
        w->answer[i] = (struct explain_answer){.finished = true, .hit = hit[i]};
}
