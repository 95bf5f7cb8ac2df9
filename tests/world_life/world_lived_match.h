/* Matches of worlds after steps: an engine's row of a life. Includes cmocka.h, whose macros must
 * come last. */
#ifndef TESTS_WORLD_LIVED_MATCH_H
#define TESTS_WORLD_LIVED_MATCH_H

#include "ref/match/match.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"

#include "tests/world_life/world_lives.h"

#define WORLD_LIVED_RAYS 200u

/* The engine's row after the last step. `layout` may be NULL. */
static inline struct row world_lived_row(const struct world_lived *lived,
                                         const struct engine *engine, const struct layout *layout,
                                         enum query query, struct pool *pool)
{
    struct ray *ray = NULL;
    struct ray_mode *mode = NULL;
    struct match_life life = {.world = lived->world, .count = lived->count};
    const struct world *world = &lived->world[lived->count];
    struct match_options options = {.builder = builder_find("median"),
                                    .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = query,
                                    .life = &life,
                                    .repeats = 1};
    struct match match;
    struct row row = {.status = ROW_REFUSED};
    struct reason reason = {""};
    for (uint32_t i = 0; i < lived->count; i++)
        life.act[i] = lived->step[i].act;
    if (world_rays_new(world, ray_set_find("mixed"), RAY_MODES_MIXED, 3, WORLD_LIVED_RAYS, &ray,
                       &mode, &reason) ||
        match_make_world(world, ray, mode, WORLD_LIVED_RAYS, &options, pool, &match, &reason))
        fail_msg("%s", reason.text);
    if (!layout || match_pack(&match, layout, &reason) == STATUS_OK)
        match_run(&match, engine, &row);
    match_free(&match);
    free(ray);
    free(mode);
    return row;
}

/* Plays all of world_lived_steps; no answer may be WRONG or, where bits are promised, have others.
 * Returns how often the engine updated what it held. */
static inline uint32_t world_lived_all(const struct engine *engine, const struct layout *layout,
                                       enum query query, struct pool *pool)
{
    uint32_t updated = 0;
    for (size_t i = 0; i < ARRAY_COUNT(world_lived_steps); i++) {
        struct world_lived *lived = world_lived_make("mixed", world_lived_steps[i]);
        const struct row row = world_lived_row(lived, engine, layout, query, pool);
        if (row.status == ROW_OK && row_failed(&row))
            fail_msg("%s %s %s: %zu WRONG, %zu other bits", world_lived_steps[i], engine->name,
                     layout ? layout->name : "-", row.count[VERDICT_WRONG], row.bit_differences);
        if (row.status != ROW_OK && row.status != ROW_REFUSED && row.status != ROW_SKIPPED)
            fail_msg("%s %s: %s", world_lived_steps[i], engine->name, row.reason.text);
        assert_true(row.status != ROW_OK || row.hits > 10);
        updated += row.status == ROW_OK && row.life.updated;
        world_lived_free(lived);
    }
    return updated;
}

#endif
