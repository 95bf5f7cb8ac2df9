#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/truth/truth.h"

#include <stdlib.h>

const char *const truth_scenes[] = {
    "soup:n=4000",
    "soup:n=4000,size=0.01,offset=1000",
    "soup:n=2000,offset=1e6",
    "grid:n=40",
    "grid:n=40,height=0,z=1",
    "needles:n=4000,aspect=1e4",
    "needles:n=2000,aspect=1e7,offset=100",
    "stack:n=500",
    "stack:n=300,copies=9,offset=1000",
    "cornell:n=6",
    "sphere:n=20",
    "flake",
    "terrain:k=6",
    "platonic",
    "scenes/fetched/assimp-wuson.obj",
    "scenes/fetched/utah-teapot.obj",
    "scenes/fetched/dragon-11k.ply.gz",
    "scenes/fetched/glmark2-bunny.obj",
    NULL,
};

static enum status play_ground(const void *ground, const struct tally_contestant *who,
                               struct pool *pool, struct tally *tally, struct play_result *out,
                               struct reason *reason)
{
    return play(ground, who, pool, tally, out, reason);
}

static enum status play_rays(struct truth_campaign *c, void *of, const struct ray_set *set,
                             size_t count, uint64_t seed, struct reason *reason)
{
    struct ground *ground = of;
    const struct tally_contestant embree = {
        .engine = engine_find("embree_robust"), .box = box_tests[0], .tri = tri_test_find("mt")};
    const struct truth_seat seat = {.campaign = c,
                                    .spec = ground->spec,
                                    .rays = set->name,
                                    .ground = ground,
                                    .count = &ground->count,
                                    .play = play_ground};
    ground->rays = set->name;
    ground->seed = seed;
    ground->count = count;
    enum status status = ray_set_make(set, &ground->scene, seed, count, ground->ray, reason);
    if (!status)
        status = oracle_closest(ground->oracle, ORACLE_TREE, ORACLE_CLOSED, ground->ray, count, 0,
                                ground->truth, NULL, reason);
    if (status)
        return status;
    truth_play_own(&seat);
    truth_play(&seat, &embree, GROUP_OTHERS, 1);
    return STATUS_OK;
}

enum status truth_play_scene(struct truth_campaign *c, const char *spec, struct reason *reason)
{
    struct ground ground = {.spec = spec};
    enum status status = scene_open(spec, 1, &ground.scene, reason);
    if (!status)
        status = oracle_make(&ground.scene, &ground.oracle, reason);
    if (!status)
        status = stand_tree(&ground.scene, &ground.bvh, reason);
    ground.ray = alloc_zeroed(BATCH, sizeof *ground.ray);
    ground.truth = alloc_zeroed(BATCH, sizeof *ground.truth);
    ground.hit = alloc_zeroed(BATCH, sizeof *ground.hit);
    ground.judgement = alloc_zeroed(BATCH, sizeof *ground.judgement);
    if (!status && !(ground.ray && ground.truth && ground.hit && ground.judgement))
        status = fail(reason, STATUS_MEMORY, "no memory for %u rays", BATCH);
    if (!status)
        status = truth_each_set(c, &ground, play_rays, reason);
    free(ground.ray);
    free(ground.truth);
    free(ground.hit);
    free(ground.judgement);
    oracle_free(ground.oracle);
    bvh_free(&ground.bvh);
    scene_free(&ground.scene);
    return status;
}
