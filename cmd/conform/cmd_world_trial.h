/* A trial of a world, and its name. Commands only.
 *   world.query.engine.layout.builder.box.tri.transform.masks.flags.geometry.filter.rays.count.seed
 *   world.closest.vulkan.rf16.median.robust.woop.mirrored.bits.flip.mixed.cells.cull-back.12.1
 * The axes from transform to count are those of scenes/worlds/composed.h. Engines without a tree
 * have "-" for layout, builder and box; "f32/rf16" is the layout of the top, then that of the
 * meshes, and so for builders. */
#ifndef CMD_WORLD_TRIAL_H
#define CMD_WORLD_TRIAL_H

#include "ref/match/match.h"
#include "scenes/worlds/composed.h"

#define WORLD_TRIAL_PREFIX "world."
#define WORLD_NAME_MOST    384

struct world_trial {
    enum query query;
    const struct engine *engine;
    const struct layout *layout, *top_layout; /* NULL for engines without a tree, as the next are */
    const struct builder *builder, *top_builder;
    const struct box_test *box;
    const struct tri_test *tri;
    struct composition of;
    uint64_t seed;
};

/* What takes part of the name between two dots, from WORLD_FIELD_QUERY on. */
enum world_field {
    WORLD_FIELD_QUERY,
    WORLD_FIELD_ENGINE,
    WORLD_FIELD_LAYOUT,
    WORLD_FIELD_BUILDER,
    WORLD_FIELD_BOX,
    WORLD_FIELD_TRI,
    WORLD_FIELD_OF, /* COMPOSED_AXES of them */
    WORLD_FIELDS = WORLD_FIELD_OF + COMPOSED_AXES
};

#define WORLD_FIELD_MOST 140 /* bytes of one */

/* Writes one field of the trial's name. */
void world_trial_field(const struct world_trial *trial, enum world_field field,
                       char text[WORLD_FIELD_MOST]);

void world_trial_print(const struct world_trial *trial, char name[WORLD_NAME_MOST]);

/* The inverse of world_trial_print. Errors: STATUS_INPUT with the wrong field. */
enum status world_trial_parse(const char *name, struct world_trial *out,
                              struct reason *reason) MUST_USE;

/* Runs trials. Keeps the last world with its truth and trees for the next trial. */
struct world_stage {
    struct pool pool;
    size_t ray_count;
    uint64_t brute_budget;
    struct composition of;
    uint64_t seed;
    struct world world;
    struct ray *ray;
    struct ray_mode *mode;
    struct match match;
    bool has_match;
};

/* Runs one trial. Errors: those of making the world or the truth; everything else is in *row. */
enum status world_stage_run(struct world_stage *stage, const struct world_trial *trial,
                            struct row *row, struct reason *reason) MUST_USE;

void world_stage_free(struct world_stage *stage);

#endif
