/* Hard cases of limits: leaf slots, triangle and node numbers, depth, empty and tiny scenes. */
#include "tests/hard/made.h"
#include "tests/hard/parts.h"

#include <math.h>

/* `count` triangles in rows of 256 cells of 1/4 in the plane z = 1; numbers below 2^9 and multiples
 * of 1/8. A ray at cell i hits triangle i only. */
static void speckles(struct hard_part *part, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        float x = 0.25f * (float)(i % 256), y = 0.25f * (float)(i / 256);
        part_triangle(part, x, y, 1, x + 0.125f, y, 1, x, y + 0.125f, 1);
    }
}

static void aim_at_speckle(struct hard_part *part, uint32_t i)
{
    float x = 0.25f * (float)(i % 256) + 0.03125f, y = 0.25f * (float)(i / 256) + 0.03125f;
    float d = i % 2 ? 1.0f : -1.0f;
    struct ray ray = i % 3 ? ray_of(x, y, 1 - d, 0, 0, d) : ray_of(x - 0.5f, y, 1 - d, 0.5f, 0, d);
    expect_id(part, HARD_ALL, ray, i);
}

static void leaves_of(struct hard_made *made, uint32_t count, uint32_t leaf)
{
    struct hard_part *part = part_add(made, "%u in leaves of %u", count, leaf);
    part->leaf = leaf;
    part->must_refuse = leaf == 9 && count % 9 == 0 ? "rf16" : NULL;
    speckles(part, count);
    for (uint32_t i = 0; i < count; i++)
        aim_at_speckle(part, i);
}

static void make_leaves(struct hard_made *made)
{
    static const uint32_t others[][2] = {{16, 1}, {7, 7}, {14, 7}, {9, 9}, {16, 9}, {18, 9}};
    for (uint32_t count = 1; count <= 16; count++)
        leaves_of(made, count, 8);
    for (size_t i = 0; i < ARRAY_COUNT(others); i++)
        leaves_of(made, others[i][0], others[i][1]);
}

static void make_index_zero(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "only one");
    speckles(part, 1);
    aim_at_speckle(part, 0);
    part = part_add(made, "nearest of 16");
    for (int i = 1; i <= 16; i++)
        part_layer(part, (float)i);
    for (int i = 0; i < 32; i++) {
        float x = 0.125f * (float)(1 + i % 8), y = 0.25f * (float)(1 + i / 8);
        expect_id(part, HARD_ALL, ray_of(x, y, 0, 0, 0, 1), 0);
    }
}

static void make_indices(struct hard_made *made)
{
    static const uint32_t at[] = {0, 1, 2, 32766, 32767, 32768, 32769, 65533, 65534, 65535, 65536};
    for (uint32_t count = 65536; count <= 65537; count++) {
        struct hard_part *part = part_add(made, "%u triangles", count);
        part->leaf = 8;
        part->must_refuse = count > 65536 ? "rf16" : NULL;
        speckles(part, count);
        for (size_t a = 0; a < ARRAY_COUNT(at); a++)
            if (at[a] < count)
                aim_at_speckle(part, at[a]);
    }
}

static void make_nodes(struct hard_made *made)
{
    for (uint32_t count = 10923; count <= 10924; count++) { /* 3 L - 1 records: 32768 and 32771 */
        struct hard_part *part = part_add(made, "%u leaves", count);
        part->leaf = 1;
        part->must_refuse = count > 10923 ? "rf16" : NULL;
        speckles(part, count);
        for (uint32_t i = 0; i < 32; i++)
            aim_at_speckle(part, 1 + (i < 16 ? i * 682 : count - 2 - (i - 16) * 5));
    }
    struct hard_part *part = part_add(made, "12000 leaves"); /* 3 * 1077 records beyond */
    part->leaf = 1;
    part->must_refuse = "rf16";
    speckles(part, 12000);
    for (uint32_t i = 0; i < 64; i++)
        aim_at_speckle(part, 187 * (i + 1));
}

/* Triangle i is scaled by 1 + i / 8; all have one centroid, in the plane z = 1. */
static void make_concentric(struct hard_made *made)
{
    static const uint32_t counts[] = {2, 7, 8, 9, 64};
    for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
        struct hard_part *part = part_add(made, "%u", counts[c]);
        for (uint32_t i = 0; i < counts[c]; i++) {
            float s = 1 + 0.125f * (float)i;
            part_triangle(part, -s, -s, 1, s, -s, 1, 0, 2 * s, 1);
        }
        for (uint32_t i = 0; i < counts[c]; i++) { /* between the borders of i - 1 and i */
            float y = -1 - 0.125f * (float)i + 0.0625f;
            for (int way = 0; way < 2; way++) {
                float d = way ? 1.0f : -1.0f;
                part_ray(part, ray_of(0.0625f, y, 1 - d, 0, 0, d));
                want_range(part, HARD_ALL, i, counts[c] - i);
            }
        }
    }
}

static void make_series(struct hard_made *made)
{
    for (int deep = 0; deep < 2; deep++)
        for (int count = 30; count <= 58; count += 28) {
            struct hard_part *part = part_add(made, "%d%s", count, deep ? ", no least size" : "");
            part->leaf = 1;
            part->deep = deep;
            for (int i = 0; i < count; i++) {
                float x = ldexpf(1, -i), s = 0.125f * x;
                part_triangle(part, x, 0, 0, x, s, 0, x, 0, s);
            }
            for (int i = 0; i < count; i++) {
                float x = ldexpf(1, -i), s = 0.03125f * x;
                part_ray(part, ray_of(1.25f * x, s, s, -0.25f * x, 0, 0));
                if (i < 24)
                    want_id(part, HARD_ALL, (uint32_t)i);
                struct ray slanted = ray_of(1.25f * x, 0, s, -0.25f * x, s, 0);
                if (i < 24)
                    expect_id(part, HARD_OWN, slanted, (uint32_t)i);
            }
        }
}

static void make_nothing(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "empty");
    for (int i = 0; i < 130; i++)
        expect_miss(part, HARD_ALL, ray_of((float)i, 0, 0, i % 2 ? 0.0f : 1.0f, 0, 1));
}

static void make_one(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "one");
    struct rng rng = rng_make(52, 0);
    part_triangle(part, 1, 2, 3, 3, 2, 4, 1, 5, 4);
    for (int i = 0; i < 100; i++) {
        float from[3], to[3];
        part_point(part, &rng, 0, to);
        random_near(&rng, to, 4, from);
        from[2] = to[2] + (i % 2 ? 6.0f : -6.0f);
        expect_id(part, HARD_ALL, ray_at(from, to), 0);
        to[i % 2] += 9; /* and past it */
        expect_miss(part, HARD_ALL, ray_at(from, to));
    }
}

/* 65,536 triangles, all hit by every ray, the nearest the last: a loop that ends early is found. */
static void make_stack(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "65536 deep");
    uint32_t count = 65536;
    part->leaf = 8;
    for (uint32_t i = 0; i < count; i++)
        part_layer(part, 0.5f * (float)(count - i));
    for (int i = 0; i < 8; i++) {
        float x = 0.25f * (float)(1 + i % 4), y = 0.5f * (float)(1 + i / 4);
        expect_id(part, HARD_ALL, ray_of(x, y, 0, 0, 0, 1), count - 1);
        expect_id(part, HARD_ALL, ray_of(x, y, 40000, 0, 0, -1), 0);
    }
}

static void make_counts(struct hard_made *made)
{
    static const size_t counts[] = {0, 1, 63, 64, 65, 127, 1000};
    for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
        struct hard_part *part = part_add(made, "%zu rays", counts[c]);
        speckles(part, 64);
        for (size_t i = 0; i < counts[c]; i++)
            aim_at_speckle(part, (uint32_t)(i % 64));
    }
}

const struct hard_case hard_limits_cases[] = {
    {
        .number = 45,
        .name = "leaf-slots",
        .recipe = "1 to 18 triangles in leaves of 1, 7, 8 and 9",
        .expected = "each triangle hit in turn; rf16 refuses a leaf of 9",
        .source = "jbikker/tinybvh#28; hankotanks/rt_rs: slots 7 and 8 are not read (RTRS's F7), "
                  "panics (RTRS's F6, F8)",
        .make = make_leaves,
    },
    {
        .number = 46,
        .name = "index-zero",
        .recipe = "triangle 0 alone, and as the nearest of 16",
        .expected = "triangle 0",
        .source = "hankotanks/rt_rs: 0 means empty; RTRS's F2",
        .make = make_index_zero,
    },
    {
        .number = 47,
        .name = "triangle-numbers",
        .recipe = "65536 and 65537 triangles, aimed at 0, 32767, 32768, 65535, 65536",
        .expected = "the triangle aimed at; beyond 65535 rf16 refuses",
        .source = "numerics.md 4, 47: numbers cut to 15 or 16 bits; RTRS's F10",
        .make = make_indices,
        .defect = {{.fault = "RTRS's fault F10: item numbers are cut to 15 and 16 bits",
                    .cause = CAUSE_INDEX_TRUNCATED,
                    .members = "closest.cpu.rtrs_rf_paper.median.robust.mt"}},
    },
    {
        .number = 48,
        .name = "node-numbers",
        .recipe = "trees of 10923, 10924 and 12000 leaves: 32768, 32771 and 35999 records",
        .expected = "the triangle aimed at; beyond record 32767 rf16 refuses, and does not wrap",
        .source = "numerics.md 4, 48: the leaf mark, bit 31, collides; RTRS's F9",
        .make = make_nodes,
        .defect = {{.fault = "RTRS's fault F9: record numbers from 32768 on set the leaf bit",
                    .cause = CAUSE_REFERENCE_TRUNCATED,
                    .members = "closest.cpu.*",
                    .layout = &layout_rtrs_rf_unshifted},
                   {.fault = "RTRS's fault F9: record numbers from 32768 on are cut to 15 bits",
                    .cause = CAUSE_REFERENCE_TRUNCATED,
                    .members = "closest.cpu.rtrs_rf_paper.median.robust.mt"}},
    },
    {
        .number = 49,
        .name = "concentric",
        .recipe = "2, 7, 8, 9 and 64 triangles of one centroid, each larger than the last",
        .expected = "builds; between two borders one of the larger ones",
        .source = "hoverinc/ray-tracing-renderer#81: equal centroids recurse for ever; RTRS's F19",
        .make = make_concentric,
    },
    {
        .number = 50,
        .name = "series",
        .recipe = "30 and 58 triangles at 2^-i, one to a leaf; the rtrs builder also without a "
                  "least size",
        .expected = "the triangle aimed at, or the tree is refused as too deep",
        .source = "jbikker/tinybvh#192, #164: stacks overrun on deep trees",
        .make = make_series,
    },
    {
        .number = 51,
        .name = "empty-scene",
        .recipe = "no triangle at all",
        .expected = "a miss",
        .source = "gfx-rs/wgpu#6731, #8637: crashes; RTRS's F20 reads node 0",
        .flags = HARD_NO_HITS,
        .make = make_nothing,
    },
    {
        .number = 52,
        .name = "one-triangle",
        .recipe = "a single triangle, so that the root is a leaf; aimed at and past it",
        .expected = "triangle 0; past it a miss",
        .source = "numerics.md 4, 52: the root's own box; RTRS's F2: a blank picture",
        .make = make_one,
    },
    {
        .number = 53,
        .name = "long-loop",
        .recipe = "65,536 triangles one behind the other, the nearest the last; from both ends",
        .expected = "the nearest; as the tree says, so brute force in one shader loop",
        .source =
            "Mesa's LP_MAX_TGSI_LOOP_ITERATIONS: lavapipe 22.3.6 ends loops after 65,535 rounds",
        .make = make_stack,
        .defect = {{.fault = "a loop ends after 65,535 rounds: RTRS's fault F1 makes it as long as "
                             "the tree",
                    .cause = CAUSE_LOOP_CAP,
                    .members = "closest.vulkan.f32.median.rtrs.mt",
                    .version = "Mesa 22.3.6"}},
    },
    {
        .number = 54,
        .name = "ray-counts",
        .recipe = "0, 1, 63, 64, 65, 127 and 1000 rays",
        .expected = "every ray's own triangle, and nothing written behind the last answer",
        .source = "numerics.md 4, 54: the bound of a dispatch; RTRS's F25",
        .make = make_counts,
    },
    {0},
};
