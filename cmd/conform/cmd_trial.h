/* A trial: one reproducible comparison, and its name. Commands only.
 *   query.engine.layout.builder.box.tri.scene.rays.seed
 *   closest.vulkan.rf16.median.robust.woop.sphere.edges.7
 * Engines without a tree have "-" for layout, builder and box. A triangle storage other than
 * `indexed` follows its layout, as in f32:compact. The scene may be any spec that scene_open takes,
 * including dots. */
#ifndef CMD_TRIAL_H
#define CMD_TRIAL_H

#include "cmd/common/cmd_tables.h"
#include "ref/match/match.h"
#include "scenes/rays/rays.h"

#define TRIAL_NAME_MOST 384

struct trial {
    enum query query;
    const struct engine *engine;
    const struct layout *layout; /* NULL for engines without a tree, as are the next three */
    const struct tri_store *store;
    const struct builder *builder;
    const struct box_test *box;
    const struct tri_test *tri;
    const struct ray_set *rays;
    uint64_t seed;
    char scene[128];
};

/* Writes the name, at most TRIAL_NAME_MOST bytes with the terminator. */
void trial_print(const struct trial *trial, char name[TRIAL_NAME_MOST]);

/* The inverse of trial_print. Errors: STATUS_INPUT with the wrong field. */
enum status trial_parse(const char *name, struct trial *out, struct reason *reason) MUST_USE;

/* Runs trials. Keeps the last scene, rays, tree and packed layout for the next trial. */
struct trial_stage {
    struct pool pool;
    size_t ray_count;
    uint64_t brute_budget;
    struct match_demands demands;
    char scene_spec[128];
    uint64_t seed;
    const struct ray_set *rays;
    struct scene scene;
    struct ray *ray;
    bool has_scene;
    struct match match;
    bool has_match;
};

/* Runs one trial. Errors: those of reading the scene, making rays or the reference; everything else
 * is in *row. A builder that would never end and a layout that refuses give ROW_REFUSED. */
enum status trial_stage_run(struct trial_stage *stage, const struct trial *trial, struct row *row,
                            struct reason *reason) MUST_USE;

void trial_stage_free(struct trial_stage *stage);

#endif
