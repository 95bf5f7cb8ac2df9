#include "scenes/rays/rays_inside.h"

#include "scenes/rays/rays_stage.h"

#include <math.h>
#include <stdlib.h>

#define TRIES      4096
#define DIRECTIONS 16   /* tried per point before it is given up */
#define SAMPLES    1000 /* rays checked for passing near an edge */
#define NEAR       0x1p-12

/* State for aiming rays. */
struct aimer {
    struct stage stage;
    const struct topology *topology;
    const struct oracle *oracle;
    float origin[INSIDE_ORIGINS][3];
    size_t origins;
};

enum status point_is_inside(const struct oracle *oracle, const float point[3], struct rng *rng,
                            bool *inside, struct reason *reason)
{
    struct oracle_crossing *crossing = NULL;
    size_t capacity = 0, count = 0;
    enum status status = STATUS_OK;
    bool decided = false;
    *inside = false;
    for (int turn = 0; turn < DIRECTIONS && !decided && !status; turn++) {
        struct ray ray = {.tmin = 0, .tmax = INFINITY};
        for (int k = 0; k < 3; k++)
            ray.org[k] = point[k];
        stage_direction(rng, ray.dir);
        status = oracle_crossings(oracle, &ray, INFINITY, &crossing, &capacity, &count, reason);
        bool generic = true, on_surface = false;
        for (size_t i = 0; i < count && !status; i++) {
            generic = generic && crossing[i].pair.class == ORACLE_INSIDE;
            on_surface = on_surface || crossing[i].pair.range == ORACLE_AT_TMIN;
        }
        decided = !status && (generic || on_surface);
        *inside = decided && !on_surface && count % 2 == 1;
    }
    free(crossing);
    return status;
}

/* The centre of mass of the solid, from signed tetrahedra: the lower corner of the box if the
 * volume is 0, the centre of the box if the result is outside it. */
static void centre_of_mass(const struct stage *stage, float out[3])
{
    const struct box *box = &stage->box;
    double sum[3] = {0, 0, 0}, volume = 0;
    for (uint32_t i = 0; i < stage->scene->tri_count; i++) {
        float v[3][3];
        double p[3][3];
        scene_tri(stage->scene, i, v);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) /* relative to the box's corner: less cancellation */
                p[c][k] = (double)v[c][k] - (double)box->lo[k];
        double part = 0;
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            part += p[0][k] * (p[1][l] * p[2][m] - p[1][m] * p[2][l]);
        }
        volume += part;
        for (int k = 0; k < 3; k++)
            sum[k] += 0.25 * part * (p[0][k] + p[1][k] + p[2][k]);
    }
    for (int k = 0; k < 3; k++) {
        double mean = volume != 0 ? sum[k] / volume : 0;
        out[k] = (float)(mean + (double)box->lo[k]);
        if (!(out[k] >= box->lo[k] && out[k] <= box->hi[k]))
            out[k] = 0.5f * box->lo[k] + 0.5f * box->hi[k];
    }
}

/* Candidate points in turn: the centre of mass; between it and the surface; anywhere in the box; a
 * little below a triangle, for thin walls. Except for the last kind and the first turn, every other
 * turn is snapped to a coarse lattice, so that differences to vertices are often exact. */
static void candidate(const struct stage *stage, struct rng *rng, int turn, const float centre[3],
                      float out[3])
{
    float v[3][3], s = rng_float(rng), depth = ldexpf(1.0f, -(int)rng_below(rng, 12));
    int exponent;
    stage_triangle(stage, rng, v);
    frexpf(stage->extent, &exponent);
    float e1[3], e2[3], n[3], length = 0;
    for (int k = 0; k < 3; k++) {
        e1[k] = (v[1][k] - v[0][k]) / stage->extent;
        e2[k] = (v[2][k] - v[0][k]) / stage->extent;
    }
    for (int k = 0; k < 3; k++) {
        n[k] = e1[(k + 1) % 3] * e2[(k + 2) % 3] - e1[(k + 2) % 3] * e2[(k + 1) % 3];
        length += n[k] * n[k];
    }
    length = length > 0 ? sqrtf(length) : 1.0f;
    for (int k = 0; k < 3; k++) {
        float middle = v[0][k] / 3 + v[1][k] / 3 + v[2][k] / 3;
        if (turn == 0)
            out[k] = centre[k];
        else if (turn % 3 == 0)
            out[k] = middle - 0.25f * depth * stage->extent * n[k] / length;
        else if (turn % 3 == 1)
            out[k] = centre[k] + s * (middle - centre[k]);
        else
            out[k] = rng_range(rng, stage->box.lo[k], stage->box.hi[k]);
    }
    if (turn % 3 != 0 && turn % 2 != 0)
        stage_snap(ldexpf(1.0f, exponent - 9), out);
}

static enum status find_origins(struct aimer *aimer, struct reason *reason)
{
    struct rng rng = stage_rng(&aimer->stage, SIZE_MAX);
    float centre[3];
    centre_of_mass(&aimer->stage, centre);
    for (int turn = 0; turn < TRIES && aimer->origins < INSIDE_ORIGINS; turn++) {
        float *point = aimer->origin[aimer->origins];
        bool inside;
        candidate(&aimer->stage, &rng, turn, centre, point);
        enum status status = point_is_inside(aimer->oracle, point, &rng, &inside, reason);
        if (status)
            return status;
        aimer->origins += inside;
    }
    if (aimer->origins == 0)
        return fail(reason, STATUS_INPUT, "no point inside was found in %d tries", TRIES);
    return STATUS_OK;
}

static void target_of(const struct aimer *aimer, struct rng *rng, enum leak_aim aim, float out[3])
{
    const struct topology *topology = aimer->topology;
    const struct topology_edge *edge = &topology->edge[rng_below(rng, topology->edge_count)];
    const float *vertex = aimer->stage.scene->vertex;
    const float *a = vertex + 3 * (size_t)topology->vertex[edge->a];
    const float *b = vertex + 3 * (size_t)topology->vertex[edge->b];
    float s = aim == LEAK_VERTEX     ? (float)rng_below(rng, 2)
              : aim == LEAK_MIDPOINT ? 0.5f
                                     : rng_float(rng);
    for (int k = 0; k < 3; k++)
        out[k] = s == 1.0f ? b[k] : a[k] + s * (b[k] - a[k]);
    if (aim != LEAK_BESIDE)
        return;
    float away[3], reach = ldexpf(aimer->stage.extent, -8 - (int)rng_below(rng, 17));
    stage_direction(rng, away);
    for (int k = 0; k < 3; k++)
        out[k] += reach * away[k];
}

static bool is_exact(const struct ray *ray, const float target[3])
{
    bool exact = true;
    for (int k = 0; k < 3; k++)
        exact = exact && (double)target[k] - (double)ray->org[k] == (double)ray->dir[k];
    return exact;
}

/* Sets *near if the exact ray meets an edge or vertex, or passes one within NEAR. */
static enum status comes_near(const struct oracle *oracle, const struct ray *ray, bool *near,
                              struct reason *reason)
{
    struct oracle_crossing *crossing = NULL;
    size_t capacity = 0, count = 0;
    *near = false;
    enum status status =
        oracle_crossings(oracle, ray, INFINITY, &crossing, &capacity, &count, reason);
    for (size_t i = 0; i < count && !status; i++)
        *near = *near || crossing[i].pair.margin <= NEAR;
    free(crossing);
    return status;
}

enum status rays_inside_make(const struct scene *scene, const struct topology *topology,
                             const struct oracle *oracle, uint64_t seed, size_t count,
                             struct ray *out, uint8_t *aim, struct inside *inside,
                             struct reason *reason)
{
    struct aimer aimer = {
        .stage = stage_make(scene, seed, STAGE_INSIDE), .topology = topology, .oracle = oracle};
    *inside = (struct inside){0};
    enum status status = find_origins(&aimer, reason);
    size_t step = count / SAMPLES / LEAK_AIMS * LEAK_AIMS + 1; /* samples all aims */
    for (size_t i = 0; i < count && !status; i++) {
        struct rng rng = stage_rng(&aimer.stage, i);
        float target[3];
        aim[i] = (uint8_t)(i % LEAK_AIMS);
        target_of(&aimer, &rng, (enum leak_aim)aim[i], target);
        stage_aim(aimer.origin[rng_below(&rng, (uint32_t)aimer.origins)], target, &out[i]);
        inside->exact += is_exact(&out[i], target);
        if (i % step != 0 || aim[i] == LEAK_BESIDE)
            continue;
        bool near;
        status = comes_near(oracle, &out[i], &near, reason);
        inside->sampled++;
        inside->near += near;
    }
    inside->origins = aimer.origins;
    return status;
}
