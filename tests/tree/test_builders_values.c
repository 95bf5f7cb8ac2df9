/* Trees by value: every builder makes of drawn scenes the trees that it made, node by node. What is
 * sound is tested elsewhere; here each box, each place and each order is held, since a tree that is
 * only worse is no error. Whatever changes a tree changes a line of the table, and the test prints
 * the new one. */
#include "ref/base/rng.h"
#include "ref/tree/bvh.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include <string.h>

/* --- scenes ----------------------------------------------------------------------------------- */

/* Triangles of any shape around the origin, of very different sizes. */
static void draw_soup(struct rng *rng, float v[3][3], uint32_t i)
{
    float size = i % 7 == 0 ? 0.5f : 0.05f;
    for (int k = 0; k < 3; k++)
        v[0][k] = rng_range(rng, -1, 1);
    for (int c = 1; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = v[0][k] + size * rng_range(rng, -1, 1);
}

/* Long and thin, across the whole scene: what planes divide better. */
static void draw_long(struct rng *rng, float v[3][3], uint32_t i)
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = 8 + rng_range(rng, -2, 2);
    for (int k = 0; k < 3 && i % 3; k++)
        v[2][k] = v[0][k] + rng_range(rng, -0.03f, 0.03f);
}

/* Few coordinates: equal centres, flat boxes, sides on planes between bins, no area. */
static void draw_ties(struct rng *rng, float v[3][3], uint32_t i)
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = (float)rng_below(rng, k == 2 ? 2 : 5) - (i % 2 ? 2 : 1);
}

/* Ten times as far with each sixteenth: a tree that is a chain where sizes decide. */
static void draw_far(struct rng *rng, float v[3][3], uint32_t i)
{
    float size = 1;
    for (uint32_t n = 0; n < i / 16; n++)
        size *= 10;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = size * (1 + rng_float(rng));
}

typedef void draw_fn(struct rng *rng, float v[3][3], uint32_t i);

static struct scene drawn(draw_fn *draw, uint32_t count)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(11, count);
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        draw(&rng, v, i);
        memcpy(scene.vertex + 9 * (size_t)i, v, sizeof v);
    }
    return scene;
}

static const struct {
    draw_fn *draw;
    uint32_t count;
} scenes[] = {
    {draw_soup, 1},   {draw_soup, 2},  {draw_soup, 3},   {draw_soup, 32},
    {draw_soup, 33},  {draw_long, 29}, {draw_soup, 400}, {draw_long, 300},
    {draw_ties, 150}, {draw_far, 160}, {draw_ties, 20},  {draw_far, 40},
};

/* --- values ----------------------------------------------------------------------------------- */

static void mix(uint64_t *hash, uint32_t word)
{
    *hash = (*hash ^ word) * 0x100000001b3u;
    *hash ^= *hash >> 29;
}

static uint64_t hash_of(uint64_t hash, const struct bvh *bvh)
{
    mix(&hash, bvh->node_count);
    mix(&hash, bvh->prim_count);
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        uint32_t word[sizeof *bvh->node / sizeof(uint32_t)];
        memcpy(word, &bvh->node[i], sizeof word);
        for (size_t k = 0; k < sizeof word / sizeof *word; k++)
            mix(&hash, word[k]);
    }
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        mix(&hash, bvh->prim[i]);
    return hash;
}

struct valued_builder {
    const char *builder;
    struct build_options options;
    uint64_t hash;
};

/* Of the trees of all scenes above. */
static const struct valued_builder rows[] = {
    {"median", {.leaf = 1}, 0xc6edb35af467cafd},
    {"median", {.leaf = 4}, 0x9d582ab29fa8f515},
    {"rtrs", {.leaf = 2, .eps = 0.02f}, 0x49b82d0f29a9e0c4},
    {"rtrs", {.leaf = 5, .eps = 0.5f}, 0xebbcabfdf8eec82e},
    {"sah_binned", {.leaf = 1}, 0x6fdc759c8ac6aae4},
    {"sah_binned", {.leaf = 4}, 0x758c975f8279f3a3},
    {"sah_binned", {.leaf = 6, .bins = 5}, 0x3ca2fab7a8812fc1},
    {"sah_binned", {.leaf = 3, .bins = 64}, 0x2014b6321858f467},
    {"sah_sweep", {.leaf = 1}, 0xc27a89ee103f5050},
    {"sah_sweep", {.leaf = 4}, 0xdd3f7231580eb582},
    {"lbvh", {.leaf = 1}, 0x1250aa54ee21c372},
    {"lbvh", {.leaf = 4}, 0x4536fcd8ff0a6ee1},
    {"ploc", {.leaf = 1}, 0x858caf14da334885},
    {"ploc", {.leaf = 4, .radius = 3}, 0x66be6ac9d4d728a3},
    {"sbvh", {.leaf = 1}, 0x0e0913159b74395f},
    {"sbvh", {.leaf = 4}, 0xe5943fca193c2559},
    {"sbvh", {.leaf = 2, .split_budget = 0.25f}, 0xbe717294e6f2efb5},
    {"sbvh", {.leaf = 4, .split_budget = 3, .split_alpha = -1}, 0xc1beda96822cdaa8},
    {"sbvh", {.leaf = 4, .split_alpha = 0.05f}, 0x242f6bb1801e5a65},
    {"sbvh", {.leaf = 3, .split_budget = -1}, 0xcff7f3176a2cf7cc},
    {"trbvh", {.leaf = 1}, 0x2cdaf8f8e1c27da2},
    {"trbvh", {.leaf = 4}, 0x8ba3e0129712b74b},
    {"sah_binned", {.leaf = 4, .passes = 2}, 0x3bed1f85c59a5162},
    {"lbvh", {.leaf = 4, .passes = 2, .rotates = true}, 0xf32b1d540c7bfe80},
    {"ploc", {.leaf = 2, .passes = 1}, 0x2ba4d1f2c3cb3f54},
    {"sbvh", {.leaf = 4, .passes = 3}, 0x599f70097f68a841},
};

/* Of one tree of a soup so large that it is divided and sorted in parts. */
static const struct {
    struct valued_builder row;
    uint32_t count;
} large[] = {
    {{"median", {.leaf = 4}, 0x37720e95cb1f7353}, 70000},
    {{"sah_binned", {.leaf = 4}, 0x4b517688afda48ea}, 70000},
    {{"sah_sweep", {.leaf = 4}, 0x93632222330de051}, 70000},
    {{"lbvh", {.leaf = 4}, 0xf01b51459af52033}, 70000},
    {{"ploc", {.leaf = 4}, 0x2a0d842e99fcb1a6}, 9000},
    {{"sbvh", {.leaf = 4, .split_budget = 0.25f}, 0x77005c9bf3048fa6}, 9000},
    {{"trbvh", {.leaf = 4}, 0xe0329ce52a713a93}, 20000},
    {{"sah_binned", {.leaf = 4, .passes = 1}, 0x7b014cfd8ae205ad}, 9000},
};

#define HASH 0xcbf29ce484222325u

static uint64_t hash_with(uint64_t hash, const struct valued_builder *row, draw_fn *draw,
                          uint32_t count)
{
    struct scene scene = drawn(draw, count);
    struct bvh bvh;
    struct reason reason = {""};
    enum status status =
        bvh_build(builder_find(row->builder), &scene, &row->options, &bvh, &reason);
    if (status && status != STATUS_LIMIT)
        fail_msg("%s: %s", row->builder, reason.text);
    mix(&hash, (uint32_t)status);
    hash = hash_of(hash, &bvh);
    bvh_free(&bvh);
    scene_free(&scene);
    return hash;
}

/* Returns whether the row has another hash, and prints it. */
static bool differs(const struct valued_builder *row, uint64_t hash)
{
    if (hash != row->hash)
        print_error("%s, leaf %u: now 0x%016llx\n", row->builder, row->options.leaf,
                    (unsigned long long)hash);
    return hash != row->hash;
}

static void trees_are_what_they_were(void **state)
{
    (void)state;
    uint32_t others = 0;
    for (size_t r = 0; r < ARRAY_COUNT(rows); r++) {
        uint64_t hash = HASH;
        for (size_t s = 0; s < ARRAY_COUNT(scenes); s++)
            hash = hash_with(hash, &rows[r], scenes[s].draw, scenes[s].count);
        others += differs(&rows[r], hash);
    }
    assert_int_equal(others, 0);
}

static void large_trees_are_what_they_were(void **state)
{
    (void)state;
    uint32_t others = 0;
    for (size_t r = 0; r < ARRAY_COUNT(large); r++)
        others += differs(&large[r].row, hash_with(HASH, &large[r].row, draw_soup, large[r].count));
    assert_int_equal(others, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_what_they_were),
        cmocka_unit_test(large_trees_are_what_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
