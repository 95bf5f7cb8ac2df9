/* A scene and a row of raydiff check in which no two numbers are the same. */
#ifndef TESTS_TOLD_CHECK_H
#define TESTS_TOLD_CHECK_H

#include "cmd/check/cmd_check.h"
#include "ref/store.h"

#include "tests/commands/told.h"

#define TRIANGLES 100

/* Its own engine, of all kinds at once. */
static inline struct engine engine_made(void)
{
    struct engine engine = *engine_find("cpu");
    engine.plain = engine_find("brute");
    engine.reference = false;
    return engine;
}

/* A finding of a world, where the bits differ. */
static inline struct finding finding_made(void)
{
    return (struct finding){
        .ray_index = 601,
        .ray = {.org = {1, 2, 3}, .tmin = 0.5f, .dir = {4, 5, 6}, .tmax = 7},
        .got = {.prim = 603, .t = 8},
        .expected = {.prim = 605, .t = 9},
        .judgement = {.verdict = VERDICT_WRONG,
                      .wrong = WRONG_MISSED,
                      .expected = 607,
                      .t_lo = 11,
                      .t_hi = 12,
                      .over = 13,
                      .displacement = 14,
                      .behind = true,
                      .lost = 609},
        .world = {.is = true,
                  .mode = {.mask = 17, .flags = 18},
                  .tag = 611 | ABI_TAG_FRONT,
                  .expected_tag = 613,
                  .got = {.instance = 617, .mesh = 1, .prim = 2, .geometry = 619, .tri = 621},
                  .expected = {.instance = 623, .mesh = 3, .prim = 4, .geometry = 625, .tri = 627}},
    };
}

/* What it counts, one number after the other. */
static inline void tell_counts(struct row *row)
{
    row->lists.triangles = 61;
    row->lists.doubles = 62;
    row->lists.closed = true;
    row->lists.parity = 63;
    row->lists.parity_off = 64;
    row->original.judged = 200000;
    row->original.beyond = 66;
    row->original.lost = 67;
    row->original.phantom = 68;
    row->original.other = 69;
    row->original.allowed = 70;
    row->original.most = 71;
    row->original.most_decoded = 72;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        row->count[v] = 201 + v;
    for (size_t w = 0; w < WRONG_COUNT; w++)
        row->wrong[w] = 301 + w;
    for (size_t c = 0; c < MATCH_EDGES; c++)
        row->edges[c] = (struct edges_lost){.hits = 401 + c, .lost = 411 + c};
}

static inline struct row row_made(const struct engine *engine)
{
    struct row row = {
        .options = {.builder = builders_all[0],
                    .build = {.leaf = 21},
                    .store = tri_stores[0],
                    .box = box_tests[0],
                    .tri = tri_tests[0],
                    .braid = 22,
                    .query = QUERY_ALL},
        .stats = {.node_count = 23, .leaf_count = 24, .depth = 25, .largest_leaf = 26},
        .engine = engine,
        .layout = layout_find("f32"),
        .node_bytes = 31000,
        .item_bytes = 32100,
        .scene_bytes = 33200,
        .memory_bytes = 34300,
        .rays = 41,
        .hits = 42,
        .compared = 43,
        .brute = 44,
        .worst_over = 45.5,
        .displacement =
            {.count = 51, .p50 = 52, .p99 = 53, .most = 54, .fan_lost = 55, .allowed = 56},
        .edges_beyond = 57,
        .fans_lost = 58,
        .bit_differences = 73,
        .against = engine_find("brute"),
        .compiled = {.compiler = "c",
                     .raw = engine_find("brute"),
                     .source = 81,
                     .ops = 1082,
                     .kept = 83,
                     .signs = 84,
                     .foreign = 85,
                     .words = 86},
        .moved = 87,
        .beside = {.both = 91, .own = 92, .plain = 93, .neither = 94},
        .judged = true,
        .differences = 95,
        .mrays = {97, 96, 98},
        .refit = {.sah_before = 101,
                  .sah_after = 102,
                  .build_ns = 10300,
                  .pack_ns = 10410,
                  .refit_ns = 200},
        .life = {.again = true, .wrong_again = 106},
        .boxes = 107,
        .tris = 108,
        .finding_count = 1,
    };
    tell_counts(&row);
    row.finding[0] = finding_made();
    return row;
}

static inline struct check_scene scene_made(struct row *row)
{
    return (struct check_scene){.spec = "s",
                                .tri_count = TRIANGLES,
                                .vertex_count = 501,
                                .instance_count = 502,
                                .modes = "m",
                                .move = 503,
                                .step = 504,
                                .rays = "r",
                                .ray_count = 505,
                                .seed = 506,
                                .row = row,
                                .row_count = 1,
                                .after = "a"};
}

#endif
