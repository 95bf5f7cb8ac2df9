/* An engine on worlds of every generator, judged against the exact truth. Includes cmocka.h, whose
 * macros must come last. */
#ifndef TESTS_WORLD_JUDGED_H
#define TESTS_WORLD_JUDGED_H

#include "ref/judge/judge_world.h"
#include "ref/match/match.h"
#include "ref/world/bake.h"
#include "scenes/rays/ray_modes.h"
#include "scenes/rays/rays.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Kinds of WRONG that no rounding explains. */
static const enum wrong judged_never[] = {WRONG_MASKED,     WRONG_CULLED,        WRONG_OPACITY,
                                          WRONG_INSTANCE,   WRONG_FACING,        WRONG_TWICE,
                                          WRONG_NOT_FINITE, WRONG_NOT_REPEATABLE};

/* What came of some rows. */
struct judged_sum {
    size_t rows, compared, hits, ill, wrong;
    size_t refused; /* jobs of worlds that the engine refuses by name */
    double most;    /* displacement */
};

/* Prints what is WRONG; fails if no rounding explains it. */
static inline void judged_kinds(const size_t wrong[WRONG_COUNT], size_t compared, const char *what)
{
    for (size_t i = 0; i < ARRAY_COUNT(judged_never); i++)
        if (wrong[judged_never[i]])
            fail_msg("%s: %zu of %zu answers WRONG %s", what, wrong[judged_never[i]], compared,
                     wrong_name(judged_never[i]));
    for (int kind = WRONG_MISSED; kind < WRONG_COUNT; kind++)
        if (wrong[kind])
            print_message("%s: %zu of %zu answers WRONG %s\n", what, wrong[kind], compared,
                          wrong_name((enum wrong)kind));
}

static inline void judged_row(const struct row *row, const char *what, struct judged_sum *sum)
{
    if (row->status == ROW_SKIPPED && strstr(row->reason.text, "near to singular")) {
        sum->refused++;
        return;
    }
    if (row->status != ROW_OK && row->status != ROW_VACUOUS)
        fail_msg("%s: %s: %s", what, row_status_name(row->status), row->reason.text);
    judged_kinds(row->wrong, row->compared, what);
    if (row->count[VERDICT_WRONG])
        print_message("    displacement p50 %.3g p99 %.3g most %.3g units\n", row->displacement.p50,
                      row->displacement.p99, row->displacement.most);
    sum->rows++;
    sum->compared += row->compared;
    sum->hits += row->hits;
    sum->ill += row->count[VERDICT_OUT_OF_CONTRACT];
    sum->wrong += row->count[VERDICT_WRONG];
    sum->most = row->displacement.most > sum->most ? row->displacement.most : sum->most;
}

struct judged_entry {
    struct hit hit;
    uint32_t tag;
};

static inline int judged_order(const void *left, const void *right)
{
    const struct hit *a = left, *b = right; /* the first member */
    if (a->t != b->t)
        return a->t < b->t ? -1 : 1;
    return (a->prim > b->prim) - (a->prim < b->prim);
}

/* Sorts the list of one ray. */
static inline void judged_sort(struct hit *hit, uint32_t *tag, uint32_t count)
{
    struct judged_entry *entry = calloc(count + 1, sizeof *entry);
    assert_non_null(entry);
    for (uint32_t i = 0; i < count; i++)
        entry[i] = (struct judged_entry){hit[i], tag[i]};
    qsort(entry, count, sizeof *entry, judged_order);
    for (uint32_t i = 0; i < count; i++) {
        hit[i] = entry[i].hit;
        tag[i] = entry[i].tag;
    }
    free(entry);
}

/* All lists of a match, whose engine is prepared for them. */
static inline void judged_lists(const struct match *match, const struct engine *engine, void *self,
                                const char *what, struct judged_sum *sum)
{
    const struct model model = engine_model(engine, self, tri_tests[0]);
    const size_t rays = match->ray_count;
    size_t wrong[WRONG_COUNT] = {0};
    struct judge *judge;
    struct reason reason = {""};
    uint32_t *found = calloc(rays, sizeof *found), room = 1;
    assert_non_null(found);
    assert_int_equal(judge_make(match->oracle, &model, QUERY_ALL, &judge, &reason), STATUS_OK);
    struct hit *hit = NULL;
    uint32_t *tag = NULL;
    for (int round = 0; round < 2; round++) { /* how many there are, then which */
        free(hit), free(tag);
        hit = calloc(rays * room, sizeof *hit);
        tag = calloc(rays * room, sizeof *tag);
        assert_true(hit && tag);
        if (engine->worlds->trace_world_all(self, match->ray, match->mode, rays, room, hit, tag,
                                            found, &reason))
            fail_msg("%s: %s", what, reason.text);
        for (size_t i = 0; i < rays && !round; i++)
            room = found[i] > room ? found[i] : room;
    }
    for (size_t i = 0; i < rays; i++) {
        struct list_judgement out;
        judged_sort(&hit[i * room], &tag[i * room], found[i]);
        assert_int_equal(judge_world_list(judge, &match->ray[i], match->mode[i], &hit[i * room],
                                          &tag[i * room], found[i], &out),
                         STATUS_OK);
        wrong[out.judgement.wrong]++;
        sum->wrong += out.judgement.verdict == VERDICT_WRONG;
        sum->ill += out.judgement.verdict == VERDICT_OUT_OF_CONTRACT;
        sum->hits += found[i] > 0;
    }
    sum->rows++;
    sum->compared += rays;
    wrong[WRONG_NOT] = 0;
    judged_kinds(wrong, rays, what);
    judge_free(judge);
    free(hit), free(tag), free(found);
}

/* Every query of one match. */
static inline void judged_match(struct match *match, const struct engine *engine, const char *name,
                                struct judged_sum *sum)
{
    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        char what[200];
        struct row row;
        enum status status;
        struct reason reason = {""};
        const struct world_job job = {
            .world = match->world, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_ALL};
        snprintf(what, sizeof what, "%s %s %s", engine->name, name, query_name((enum query)query));
        match_set(match, box_tests[0], (enum query)query);
        if (query != QUERY_ALL) {
            match_run(match, engine, &row);
            judged_row(&row, what, sum);
            continue;
        }
        void *self = pool_get(match->pool, engine, &status, &reason);
        assert_non_null(self);
        status = engine->worlds->prepare_world(self, &job, &reason);
        if (status == STATUS_UNSUPPORTED && strstr(reason.text, "near to singular"))
            sum->refused++;
        else if (status)
            fail_msg("%s: %s", what, reason.text);
        else
            judged_lists(match, engine, self, what, sum);
    }
}

/* One world, one set of modes, every query. */
static inline void judged_world(const struct engine *engine, const struct engine_options *options,
                                const char *spec, enum ray_modes modes, size_t rays,
                                struct judged_sum *sum)
{
    struct world world;
    struct scene baked;
    struct ray *ray = NULL;
    struct reason reason = {""};
    struct pool pool = {.options = *options};
    struct match match;
    char name[100];
    const struct match_options options_of = {.builder = builder_find("median"),
                                             .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                             .box = box_tests[0],
                                             .tri = tri_tests[0],
                                             .repeats = 1};
    struct ray_mode *mode = calloc(rays, sizeof *mode);
    assert_non_null(mode);
    if (world_open(spec, 3, &world, &reason) || world_bake(&world, 1000, &baked, &reason) ||
        ray_set_new(ray_sets[0], &baked, 3, rays, &ray, &reason))
        fail_msg("%s: %s", spec, reason.text);
    ray_modes_make(modes, 3, rays, mode);
    if (match_make_world(&world, ray, mode, rays, &options_of, &pool, &match, &reason))
        fail_msg("%s: %s", spec, reason.text);
    snprintf(name, sizeof name, "%s %s", spec, ray_modes_name(modes));
    judged_match(&match, engine, name, sum);
    match_free(&match);
    pool_free(&pool);
    scene_free(&baked);
    free(ray);
    free(mode);
    world_free(&world);
}

/* Every generator with every set of modes. */
static inline struct judged_sum judged_everywhere(const struct engine *engine,
                                                  const struct engine_options *options, size_t rays)
{
    struct judged_sum sum = {0};
    for (size_t i = 0; world_generators[i]; i++)
        for (int modes = 0; modes < RAY_MODES_COUNT; modes++)
            judged_world(engine, options, world_generators[i]->name, (enum ray_modes)modes, rays,
                         &sum);
    print_message("%s: %zu rows, %zu answers, %zu hits, %zu not judged, %zu WRONG by geometry, "
                  "displacement up to %.3g; %zu rows refused\n",
                  engine->name, sum.rows, sum.compared, sum.hits, sum.ill, sum.wrong, sum.most,
                  sum.refused);
    return sum;
}

#endif
