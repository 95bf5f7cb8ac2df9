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
const char *const truth_rays[TRUTH_SETS] = {"random", "vertices", "edges", "corners", "axis"};

struct scene_play {
    struct truth_campaign *campaign;
    struct ground *ground;
};

static void play_one(void *self, const struct tally_contestant *who, enum truth_group group,
                     uint32_t share)
{
    struct scene_play *p = self;
    struct truth_campaign *c = p->campaign;
    struct ground *ground = p->ground;
    struct play_result result;
    struct reason reason = {""};
    char where[160];
    const size_t count = ground->count;
    ground->count = count / share;
    if (ground->count > 0) {
        snprintf(where, sizeof where, "%s, %s rays", ground->spec, ground->rays);
        progress_step(&c->progress, "%s, %s %s %s", where, who->engine->name,
                      who->layout ? who->layout->name : "", who->tri->name);
        enum status status = play(ground, who, &c->pool, &c->tally, &result, &reason);
        truth_count(c, where, who, group, status, &result, &reason);
    }
    ground->count = count;
}

static void play_all(struct truth_campaign *c, struct ground *ground)
{
    struct scene_play p = {c, ground};
    truth_own(&p, play_one);
    const struct tally_contestant embree = {
        .engine = engine_find("embree_robust"), .box = box_tests[0], .tri = tri_test_find("mt")};
    play_one(&p, &embree, GROUP_OTHERS, 1);
}

static enum status play_rays(struct truth_campaign *c, struct ground *ground,
                             const struct ray_set *set, size_t count, uint64_t seed,
                             struct reason *reason)
{
    ground->rays = set->name;
    ground->seed = seed;
    ground->count = count;
    enum status status = ray_set_make(set, &ground->scene, seed, count, ground->ray, reason);
    if (!status)
        status = oracle_closest(ground->oracle, ORACLE_TREE, ORACLE_CLOSED, ground->ray, count, 0,
                                ground->truth, NULL, reason);
    if (!status)
        play_all(c, ground);
    return status;
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
    for (size_t s = 0; s < TRUTH_SETS && !status; s++) {
        size_t left = (size_t)c->options.rays / TRUTH_SETS;
        for (uint64_t part = 0; left > 0 && !status; part++) {
            size_t count = left < BATCH ? left : BATCH;
            status = play_rays(c, &ground, ray_set_find(truth_rays[s]), count,
                               c->options.seed + 1000 * part + s, reason);
            left -= count;
        }
    }
    free(ground.ray);
    free(ground.truth);
    free(ground.hit);
    free(ground.judgement);
    oracle_free(ground.oracle);
    bvh_free(&ground.bvh);
    scene_free(&ground.scene);
    return status;
}
