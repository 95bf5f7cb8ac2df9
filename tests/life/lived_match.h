/* Matches after steps: an engine's row of a life. Includes cmocka.h, whose macros must come
 * last. */
#ifndef TESTS_LIVED_MATCH_H
#define TESTS_LIVED_MATCH_H

#include "ref/match/match.h"
#include "scenes/rays/rays.h"

#include "tests/life/lives.h"

#define LIVED_RAYS 600u

/* The engine's row after the last step. `layout` may be NULL. */
static inline struct row lived_row(const struct lived *lived, const struct engine *engine,
                                   const struct layout *layout, const struct tri_store *store,
                                   struct pool *pool)
{
    struct ray ray[LIVED_RAYS];
    struct match_life life = {.scene = lived->scene, .count = lived->count};
    const struct scene *scene = &lived->scene[lived->count];
    struct match_options options = {.builder = builder_find("median"),
                                    .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                    .store = store,
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = QUERY_CLOSEST,
                                    .life = &life,
                                    .repeats = 1};
    struct match match;
    struct row row = {.status = ROW_REFUSED};
    struct reason reason = {""};
    for (uint32_t i = 0; i < lived->count; i++)
        life.act[i] = lived->step[i].act;
    if (ray_set_make(ray_set_find("mixed"), scene, 3, LIVED_RAYS, ray, &reason) ||
        match_make(scene, ray, LIVED_RAYS, &options, pool, &match, &reason))
        fail_msg("%s", reason.text);
    if (!layout || match_pack(&match, layout, &reason) == STATUS_OK)
        match_run(&match, engine, &row);
    match_free(&match);
    return row;
}

/* Steps of all kinds, that leave something to hit in the end. */
static const char *const lived_steps[] = {
    "refit:jitter:3",
    "refit:swap:5",
    "refit:one:1,refit:mirror:2",
    "refit:jitter:1,rebuild:swap:4,refit:jitter:4",
    "refit:point:1,refit:jitter:7", /* a point has no extent: it stays one */
    "rebuild:far:3,refit:far:2,refit:one:6",
    "refit:zero:2,refit:subnormal:4,refit:jitter:2",
    "refit,rebuild,refit",
};

/* Plays all of these; no answer may be WRONG or, where bits are promised, have others. Returns how
 * often the engine updated what it held. */
static inline uint32_t lived_all(const struct engine *engine, const struct layout *layout,
                                 const struct tri_store *store, struct pool *pool)
{
    uint32_t updated = 0;
    for (size_t i = 0; i < ARRAY_COUNT(lived_steps); i++) {
        struct lived lived = lived_make("soup:n=60", lived_steps[i]);
        const struct row row = lived_row(&lived, engine, layout, store, pool);
        if (row.status == ROW_OK && row_failed(&row))
            fail_msg("%s %s %s: %zu WRONG, %zu other bits", lived_steps[i], engine->name,
                     layout ? layout->name : "-", row.count[VERDICT_WRONG], row.bit_differences);
        if (row.status != ROW_OK && row.status != ROW_REFUSED && row.status != ROW_SKIPPED)
            fail_msg("%s %s: %s", lived_steps[i], engine->name, row.reason.text);
        updated += row.status == ROW_OK && row.life.updated;
        lived_free(&lived);
    }
    return updated;
}

#endif
