/* Matches over worlds. Includes cmocka.h. */
#ifndef TWO_LEVEL_WORLD_MATCH_H
#define TWO_LEVEL_WORLD_MATCH_H

#include "ref/match/match.h"
#include "ref/world/bake.h"
#include "scenes/rays/ray_modes.h"
#include "scenes/rays/rays.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/two_level/two_level_fixture.h"

#include <stdlib.h>
#include <string.h>

/* A world, which is borrowed, rays at it and the match of both. */
struct world_play {
    const struct world *world;
    struct ray *ray;
    struct ray_mode *mode;
    size_t count;
    struct match_options options;
    struct pool pool;
    struct match match;
    struct row row;
    struct reason reason;
};

static inline struct match_options play_options(void)
{
    return (struct match_options){.builder = builder_find("median"),
                                  .build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT},
                                  .box = box_test_find("robust"),
                                  .tri = tri_test_find("mt"),
                                  .query = QUERY_CLOSEST,
                                  .repeats = 2,
                                  .brute_budget = 200000};
}

/* Rays of the set "mixed" at the world as one scene, in f32. */
static inline struct world_play *play_world(const struct world *world, enum ray_modes modes,
                                            size_t count)
{
    struct world_play *p = calloc(1, sizeof *p);
    struct scene baked;
    assert_non_null(p);
    *p = (struct world_play){.world = world, .count = count, .options = play_options()};
    p->mode = calloc(count, sizeof *p->mode);
    assert_non_null(p->mode);
    if (world_bake(world, 1u << 20, &baked, &p->reason) ||
        ray_set_new(ray_sets[0], &baked, 1, count, &p->ray, &p->reason))
        fail_msg("%s", p->reason.text);
    scene_free(&baked);
    ray_modes_make(modes, 1, count, p->mode);
    if (match_make_world(world, p->ray, p->mode, count, &p->options, &p->pool, &p->match,
                         &p->reason) ||
        match_pack(&p->match, layout_find("f32"), &p->reason))
        fail_msg("%s", p->reason.text);
    return p;
}

static inline void play_done(struct world_play *p)
{
    match_free(&p->match);
    pool_free(&p->pool);
    free(p->ray);
    free(p->mode);
    free(p);
}

static inline void play_run(struct world_play *p, const struct engine *engine, enum query query)
{
    match_set(&p->match, p->options.box, query);
    match_run(&p->match, engine, &p->row);
}

static inline bool same_place(const struct place *a, const struct place *b)
{
    return a->instance == b->instance && a->mesh == b->mesh && a->prim == b->prim &&
           a->geometry == b->geometry && a->tri == b->tri;
}

/* What a finding has of the world is the ray's mode, and the places of both triangles. */
static inline void assert_found_in_world(const struct world_play *p)
{
    const uint32_t all = world_tri_count(p->world);
    for (size_t i = 0; i < p->row.finding_count; i++) {
        const struct finding *f = &p->row.finding[i];
        const uint32_t expected = f->bits ? f->expected.prim : f->judgement.expected;
        assert_true(f->world.is);
        assert_memory_equal(&f->ray, &p->ray[f->ray_index], sizeof f->ray);
        assert_memory_equal(&f->world.mode, &p->mode[f->ray_index], sizeof f->world.mode);
        if (f->got.prim < all) {
            const struct place place = world_place(p->world, f->got.prim);
            assert_true(same_place(&f->world.got, &place));
        }
        if (expected < all) {
            const struct place place = world_place(p->world, expected);
            assert_true(same_place(&f->world.expected, &place));
        }
    }
}

static inline void assert_world_agrees(const struct world_play *p, const char *what)
{
    const struct row *row = &p->row;
    size_t sum = 0;
    for (int v = 0; v < VERDICT_COUNT; v++)
        sum += row->count[v];
    if (row->status != ROW_OK || row->differences > 0 || row->finding_count > 0)
        fail_msg("%s: %s %s: %s, %zu differences, first %s: %s", what, row->engine->name,
                 query_name(row->options.query), row_status_name(row->status), row->differences,
                 row->finding_count ? wrong_name(row->finding[0].judgement.wrong) : "-",
                 row->reason.text);
    assert_false(row_failed(row));
    assert_true(row->of_world);
    assert_int_equal(sum, row->rays);
    assert_int_equal(row->compared, row->rays);
    assert_true(row->worst_over <= 1.0);
    assert_false(row->lists.closed);
    assert_int_equal(row->lists.doubles + row->lists.parity + row->lists.parity_off, 0);
    assert_true((row->lists.triangles > 0) == (row->options.query == QUERY_ALL));
}

#endif
