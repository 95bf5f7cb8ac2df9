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

static enum status play_ground(const void *ground, const struct tally_contestant *who,
                               struct pool *pool, struct tally *tally, struct play_result *out,
                               struct reason *reason)
{
    return world_play(ground, who, pool, tally, out, reason);
}

static void play_all(const struct truth_seat *seat)
{
    static const char *const others[] = {"embree", "embree_robust", "rayquery"};
    const struct tally_contestant fast = {.engine = engine_find("fast"),
                                          .layout = layout_find("f32"),
                                          .box = box_tests[0],
                                          .tri = tri_test_find("mt")};
    truth_play_own(seat);
    truth_play(seat, &fast, GROUP_FAST, 1);
    for (size_t e = 0; e < ARRAY_COUNT(others); e++) {
        const struct tally_contestant other = {
            .engine = engine_find(others[e]), .box = box_tests[0], .tri = tri_test_find("mt")};
        if (other.engine)
            truth_play(seat, &other, GROUP_OTHERS, 1);
    }
}

static enum status play_rays(struct truth_campaign *c, void *of, const struct ray_set *set,
                             size_t count, uint64_t seed, struct reason *reason)
{
    struct world_ground *ground = of;
    const struct truth_seat seat = {.campaign = c,
                                    .spec = ground->spec,
                                    .rays = set->name,
                                    .ground = ground,
                                    .count = &ground->count,
                                    .play = play_ground};
    ground->rays = set->name;
    ground->seed = seed;
    ground->count = count;
    enum status status = world_rays_new(&ground->world, set, RAY_MODES_MIXED, seed, count,
                                        &ground->ray, &ground->mode, reason);
    if (!status)
        status = oracle_closest_world(ground->oracle, ORACLE_AUTO, ORACLE_CLOSED, ground->ray,
                                      ground->mode, count, 0, ground->truth, NULL, reason);
    if (!status)
        play_all(&seat);
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
    if (!status)
        status = truth_each_set(c, &ground, play_rays, reason);
    world_ground_free(&ground);
    return status;
}
