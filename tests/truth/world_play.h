/* One contestant on one world and ray set: traced, judged, wrong answers decided again. */
#ifndef TRUTH_WORLD_PLAY_H
#define TRUTH_WORLD_PLAY_H

#include "ref/oracle/oracle_world.h"
#include "ref/two_level/world_trees.h"
#include "tests/truth/play.h"

/* A world with rays and the truth about them. The campaign owns `ray` and `mode`. */
struct world_ground {
    const char *spec, *rays;
    uint64_t seed;
    struct world world;
    struct world_trees trees;
    struct oracle *oracle;
    struct ray *ray;
    struct ray_mode *mode;
    struct oracle_answer *truth;
    struct hit *hit;
    uint32_t *tag;
    struct judgement *judgement;
    size_t count;
    enum query query; /* closest or any */
};

/* Builds what a world that is open needs for `rays_most` rays, both levels by `builder`; freed by
 * world_ground_free, on error too. Errors: those of world_trees_make, oracle_make_world;
 * STATUS_MEMORY. */
enum status world_ground_make(struct world_ground *ground, size_t rays_most,
                              const struct builder *builder, const struct build_options *options,
                              struct reason *reason) MUST_USE;
void world_ground_free(struct world_ground *ground);

/* Traces and judges all rays; every WRONG is decided again and added to the tally. A layout that
 * cannot hold the world, or an engine that cannot run here, is refused. Errors: STATUS_DEVICE the
 * engine failed; STATUS_MEMORY. */
enum status world_play(const struct world_ground *ground, const struct tally_contestant *who,
                       struct pool *pool, struct tally *tally, struct play_result *out,
                       struct reason *reason) MUST_USE;

#endif
