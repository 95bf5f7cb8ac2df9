#include "ref/judge/judge_world.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"
#include "tests/truth/truth.h"
#include "tests/truth/world_play.h"

#include <stdlib.h>

const char *const truth_worlds[] = {
    "placed-identity:count=3",
    "placed-far",
    "placed-turned:count=8",
    "placed-scaled:count=8",
    "placed-tiny",
    "placed-stretched",
    "placed-mirrored",
    "placed-sheared",
    "placed-thin",
    "wall:n=12",
    "nest",
    "crowd:n=1000",
    "twins:k=5",
    "room",
    "mixed:count=64",
    "mixed:count=48,filter=2,share=200",
    NULL,
};

struct world_campaign {
    struct truth_campaign *campaign;
    struct world_ground *ground;
};

static void play_one(void *self, const struct tally_contestant *who, enum truth_group group,
                     uint32_t share)
{
    struct world_campaign *p = self;
    struct truth_campaign *c = p->campaign;
    struct world_ground *ground = p->ground;
    struct play_result result;
    struct reason reason = {""};
    char where[160];
    const size_t count = ground->count;
    ground->count = count / share;
    if (ground->count > 0) {
        snprintf(where, sizeof where, "%s, %s rays", ground->spec, ground->rays);
        progress_step(&c->progress, "%s, %s %s %s", where, who->engine->name,
                      who->layout ? who->layout->name : "", who->tri->name);
        enum status status = world_play(ground, who, &c->pool, &c->tally, &result, &reason);
        truth_count(c, where, who, group, status, &result, &reason);
    }
    ground->count = count;
}

static void play_all(struct truth_campaign *c, struct world_ground *ground)
{
    static const char *const others[] = {"embree", "embree_robust", "rayquery"};
    struct world_campaign p = {c, ground};
    truth_own(&p, play_one);
    const struct tally_contestant fast = {.engine = engine_find("fast"),
                                          .layout = layout_find("f32"),
                                          .box = box_tests[0],
                                          .tri = tri_test_find("mt")};
    play_one(&p, &fast, GROUP_FAST, 1);
    for (size_t e = 0; e < ARRAY_COUNT(others); e++) {
        const struct tally_contestant other = {
            .engine = engine_find(others[e]), .box = box_tests[0], .tri = tri_test_find("mt")};
        if (other.engine)
            play_one(&p, &other, GROUP_OTHERS, 1);
    }
}

static enum status play_rays(struct truth_campaign *c, struct world_ground *ground,
                             const struct ray_set *rays, size_t count, uint64_t seed,
                             struct reason *reason)
{
    ground->rays = rays->name;
    ground->seed = seed;
    ground->count = count;
    enum status status = world_rays_new(&ground->world, rays, RAY_MODES_MIXED, seed, count,
                                        &ground->ray, &ground->mode, reason);
    if (!status)
        status = oracle_closest_world(ground->oracle, ORACLE_AUTO, ORACLE_CLOSED, ground->ray,
                                      ground->mode, count, 0, ground->truth, NULL, reason);
    if (!status)
        play_all(c, ground);
    free(ground->ray);
    free(ground->mode);
    ground->ray = NULL;
    ground->mode = NULL;
    return status;
}

enum status truth_play_world(struct truth_campaign *c, const char *spec, struct reason *reason)
{
    struct world_ground ground = {.spec = spec, .query = QUERY_CLOSEST};
    const struct build_options options = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    enum status status = world_open(spec, 1, &ground.world, reason);
    if (!status)
        status = world_ground_make(&ground, BATCH, builders[0], &options, reason);
    for (size_t s = 0; s < TRUTH_SETS && !status; s++) {
        size_t left = (size_t)c->options.rays / TRUTH_SETS;
        for (uint64_t part = 0; left > 0 && !status; part++) {
            size_t count = left < BATCH ? left : BATCH;
            status = play_rays(c, &ground, ray_set_find(truth_rays[s]), count,
                               c->options.seed + 1000 * part + s, reason);
            left -= count;
        }
    }
    world_ground_free(&ground);
    return status;
}
