/* RTRS's faults that a traversal can show, each alone on a small scene. F1 is case 63. F13 is the
 * paper's and in no layout, F7 is hidden by F2: these have members that are wrong on purpose. */
#include "tests/hard/made.h"
#include "tests/hard/parts.h"

#define SEED "hankotanks/rt_rs at 2150870, "

/* A small triangle at (x, y, 1) and a ray straight at it. */
static void dot(struct hard_part *part, float x, float y)
{
    part_triangle(part, x, y, 1, x + 0.25f, y, 1, x, y + 0.25f, 1);
}

static void aim_at_dot(struct hard_part *part, uint32_t prim, float x, float y)
{
    expect_id(part, HARD_ALL, ray_of(x + 0.0625f, y + 0.0625f, 0, 0, 0, 1), prim);
}

/* Triangle i is at place 7 i mod 300, so that its number and its place in a tree differ. */
static void make_items(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "300 apart");
    for (uint32_t i = 0; i < 300; i++) {
        uint32_t at = 7 * i % 300;
        dot(part, (float)(at % 20), (float)(at / 20));
        aim_at_dot(part, i, (float)(at % 20), (float)(at / 20));
    }
}

static void make_floor(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "y = 0.1");
    part_grid(part, 3, 1, 0.1f, 1, 0);
    for (uint32_t i = 0; i < 18; i++) {
        float z = (float)(i / 2 % 3) + (i % 2 ? 0.25f : 0.75f);
        float x = (float)(i / 6) + (i % 2 ? 0.75f : 0.25f);
        expect_hit(part, HARD_ALL, ray_of(x, 2, z, 0, -1, 0));
    }
}

static void make_cut(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "5 copies");
    struct rng rng = rng_make(72, 0);
    for (int i = 0; i < 5; i++)
        part_triangle(part, 0, 0, 0, 1, 0, 0, 0, 1, 0);
    for (uint32_t i = 0; i < 20; i++) {
        float to[3];
        part_point(part, &rng, 0, to);
        expect_hit(part, HARD_ALL, ray_of(to[0], to[1], -1, 0, 0, 1));
    }
}

/* Clusters far apart, one of eight triangles and seven of five: leaves of eight and of five. */
static void make_slots(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "leaves of 8 and 5");
    part->leaf = 8;
    for (uint32_t c = 0; c < 8; c++)
        for (uint32_t i = 0; i < (c == 0 ? 8u : 5u); i++) {
            float x = 64 * (float)c + 0.5f * (float)i;
            aim_at_dot(part, part->scene.tri_count, x, 0);
            dot(part, x, 0);
        }
}

static void make_records(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "one leaf of 8");
    part->leaf = 8;
    for (uint32_t i = 0; i < 8; i++) {
        aim_at_dot(part, i, (float)i, 0);
        dot(part, (float)i, 0);
    }
}

static void make_halves(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "from 65520");
    part->leaf = 1;
    dot(part, -1000, -1000); /* triangle 0, which the paper's record loses */
    for (int i = 0; i < 3; i++) {
        float x = 65520 + 4 * (float)i;
        part_triangle(part, x, -1, -1, x + 2, 1, -1, x + 1, 0, 1);
    }
    part->must_refuse = "rf16";
    for (int i = -4; i <= 4; i++) {
        float z = 0.03125f * (float)i;
        expect_hit(part, HARD_ALL, ray_of(65000, 0, z, 1, 0, 0));
    }
}

static void make_last(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "one leaf");
    for (int i = 1; i <= 4; i++)
        part_layer(part, (float)i);
    for (int i = 1; i <= 8; i++)
        expect_id(part, HARD_ALL, ray_of(0.25f * (float)i, 0.5f, 0, 0, 0, 1), 0);
}

static void make_parallel(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "x = 100");
    part_triangle(part, 100, -1, -1, 100, 1, -1, 103, 0, 2);
    for (int i = -4; i <= 4; i++)
        part_ray(part, ray_of(100, 0.1875f * (float)i, -5, 0, 0, 1));
}

static void make_threshold(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "3e-4");
    const float s = 3e-4f;
    part_triangle(part, 0, 0, 0, s, 0, 0, 0, s, 0);
    for (int i = 1; i <= 8; i++) {
        float x = 0.0625f * s * (float)i;
        expect_id(part, HARD_ALL, ray_of(x, 0.25f * s, -1, 0, 0, 1), 0);
    }
}

const struct hard_case hard_seed_cases[] = {
    {
        .number = 70,
        .name = "seed-items",
        .recipe = "300 triangles apart, numbered out of order, a ray at each",
        .expected = "its triangle",
        .source = SEED "scene/mod.rs:160 (RTRS's F2), state/mod.rs:328 (F3); Listing 6",
        .make = make_items,
        .defect = {{.fault = "RTRS's fault F2: items are numbered one off",
                    .cause = CAUSE_INDEX_SHIFTED,
                    .members = "closest.*.rtrs_rf.median.robust.mt"},
                   {.fault = "RTRS's fault F3: triangles are reordered after they were uploaded",
                    .cause = CAUSE_WRONG_ITEM,
                    .members = "closest.*.rtrs_direct.median.robust.mt"},
                   {.fault = "the paper's record takes 0 for empty",
                    .cause = CAUSE_SENTINEL,
                    .members = "closest.*.rtrs_rf_paper.median.robust.mt"}},
    },
    {
        .number = 71,
        .name = "seed-floor",
        .recipe = "a flat floor of 18 triangles at y = 0.1, from above",
        .expected = "a hit",
        .source = SEED "bvh/aabb.rs:196 (RTRS's F4), rf.rs:113 (F8)",
        .make = make_floor,
        .defect = {{.fault =
                        "RTRS's fault F4: rounded centroids lie outside, nothing is split, the "
                        "box is cut",
                    .cause = CAUSE_CUT_BOX,
                    .members = "closest.*.f32.rtrs.robust.mt"},
                   {.fault = "RTRS's fault F8: more than 8 items in a leaf end RTRS",
                    .members = "closest.*.rtrs_rf.rtrs.robust.mt",
                    .refuses = "fault F8"}},
    },
    {
        .number = 72,
        .name = "seed-cut",
        .recipe = "five copies of one triangle, which no plane separates",
        .expected = "a hit",
        .source = SEED "bvh/aabb.rs:221 (RTRS's F5)",
        .make = make_cut,
        .defect = {{.fault = "RTRS's fault F5: boxes are cut in half until they hold nothing",
                    .cause = CAUSE_CUT_BOX,
                    .members = "closest.*.f32.rtrs.robust.mt"}},
    },
    {
        .number = 73,
        .name = "seed-slots",
        .recipe = "a leaf of eight items, all with small numbers, among leaves of five",
        .expected = "the triangle aimed at",
        .source = SEED "rf.rs:443 (RTRS's F7)",
        .make = make_slots,
        .defect = {{.fault = "RTRS's fault F7: six of eight slots are read",
                    .cause = CAUSE_SLOT_NOT_READ,
                    .members = "closest.cpu.*",
                    .layout = &layout_rtrs_rf_unshifted}},
    },
    {
        .number = 74,
        .name = "seed-records",
        .recipe = "eight triangles in one leaf, the root",
        .expected = "the triangle aimed at",
        .source = SEED "rf.rs:130 (RTRS's F6)",
        .make = make_records,
        .defect = {{.fault = "RTRS's fault F6: the items of a leaf are taken for nodes, which ends "
                             "RTRS",
                    .members = "closest.*.rtrs_rf.median.*",
                    .refuses = "fault F6"}},
    },
    {
        .number = 75,
        .name = "seed-halves",
        .recipe = "triangles from 65520 on, where the nearest half is infinite",
        .expected = "a hit; rf16 refuses",
        .source = SEED "rf.rs:87 (RTRS's F12)",
        .make = make_halves,
        .defect = {{.fault = "RTRS's fault F12: bounds overflow",
                    .cause = CAUSE_HALF_OVERFLOW,
                    .members = "closest.*.rtrs_rf_paper.median.robust.mt"}},
    },
    {
        .number = 76,
        .name = "seed-last",
        .recipe = "four triangles behind each other in one leaf, the nearest the first",
        .expected = "the nearest",
        .source = "the paper's Figure 7 (RTRS's F13): compares with the best of before the leaf",
        .make = make_last,
        .defect = {{.fault = "RTRS's fault F13: the last accepted triangle of a leaf wins",
                    .cause = CAUSE_STALE_BEST,
                    .members = "closest.last_wins.*",
                    .engine = &engine_last_wins}},
    },
    {
        .number = 77,
        .name = "seed-parallel",
        .recipe = "rays along z in the face x = 100 of a triangle's box",
        .expected = "what brute force hits",
        .source = SEED "rf.rs:417 (RTRS's F15): 0 / 0",
        .make = make_parallel,
        .defect = {{.fault = "RTRS's fault F15: a direction of 0 divides by zero",
                    .cause = CAUSE_PARALLEL_AXIS,
                    .members = "closest.cpu.f32.median.rtrs.mt"}},
    },
    {
        .number = 78,
        .name = "seed-threshold",
        .recipe = "a triangle of 3e-4, straight on",
        .expected = "triangle 0",
        .source = SEED "intrs.wgsl (RTRS's F16): an absolute 1e-7; jbikker/tinybvh#283",
        .make = make_threshold,
        .defect = {{.fault = "RTRS's fault F16: a determinant below 1e-7 is none",
                    .cause = CAUSE_DETERMINANT_THRESHOLD,
                    .members = "closest.*.f32.median.robust.mt_rtrs"},
                   {.fault = "RTRS's fault F16: a determinant below 1e-7 is none",
                    .cause = CAUSE_DETERMINANT_THRESHOLD,
                    .members = "closest.brute.-.-.-.mt_rtrs"}},
    },
    {0},
};
