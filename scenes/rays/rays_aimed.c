/* Random rays, and rays aimed at features of the scene. */
#include "scenes/rays/rays_stage.h"

static void random_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float org[3], dir[3];
    (void)i;
    for (int k = 0; k < 3; k++)
        org[k] = rng_range(rng, stage->box.lo[k] - 0.25f * stage->extent,
                           stage->box.hi[k] + 0.25f * stage->extent);
    stage_direction(rng, dir);
    stage_ray(org, dir, out);
}

/* Aims at `target`, moved by stage_jitter with turn i. */
static void aim(const struct stage *stage, struct rng *rng, size_t i, float target[3],
                struct ray *out)
{
    float org[3];
    bool exact = stage_jitter(stage, rng, i, target);
    stage_origin(stage, rng, exact, org);
    stage_aim(org, target, out);
}

static void vertex_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float v[3][3];
    stage_triangle(stage, rng, v);
    aim(stage, rng, i, v[rng_below(rng, 3)], out);
}

static void edge_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float v[3][3], target[3];
    stage_triangle(stage, rng, v);
    uint32_t a = rng_below(rng, 3), b = (a + 1) % 3;
    float s = rng_below(rng, 4) == 0 ? 0.5f : rng_float(rng); /* midpoints are exact on a lattice */
    for (int k = 0; k < 3; k++)
        target[k] = v[a][k] + s * (v[b][k] - v[a][k]);
    aim(stage, rng, i, target, out);
}

static void corner_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float v[3][3], target[3];
    struct box box = stage->box;
    stage_triangle(stage, rng, v);
    if (rng_below(rng, 4) != 0) {
        box = box_empty();
        for (int c = 0; c < 3; c++)
            box_add_point(&box, v[c]);
    }
    bool corner = rng_below(rng, 2);
    int face = (int)rng_below(rng, 3);
    for (int k = 0; k < 3; k++) {
        bool high = rng_below(rng, 2);
        target[k] = corner || k == face ? (high ? box.hi[k] : box.lo[k])
                                        : rng_range(rng, box.lo[k], box.hi[k]);
    }
    aim(stage, rng, i, target, out);
}

const struct ray_set ray_set_random = {
    .name = "random",
    .summary = "uniform origins in the scene's box enlarged by half, uniform directions",
    .one = random_ray,
    .tag = STAGE_RANDOM,
};
const struct ray_set ray_set_vertices = {
    .name = "vertices",
    .summary = "aimed at vertices, from inside and outside, off by 0, 1e-6 or 1e-3 extents",
    .one = vertex_ray,
    .tag = STAGE_VERTICES,
};
const struct ray_set ray_set_edges = {
    .name = "edges",
    .summary = "aimed at points of edges, from inside and outside, off by 0, 1e-6 or 1e-3 extents",
    .one = edge_ray,
    .tag = STAGE_EDGES,
};
const struct ray_set ray_set_corners = {
    .name = "corners",
    .summary = "aimed at corners and faces of the boxes of scene and triangles, off likewise",
    .one = corner_ray,
    .tag = STAGE_CORNERS,
};
