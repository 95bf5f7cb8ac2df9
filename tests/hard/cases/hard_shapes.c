/* Hard cases of shapes: slivers, needles, no area, duplicates, overlaps. */
#include "tests/hard/parts.h"

static void make_slivers(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "slivers");
    struct rng rng = rng_make(28, 0);
    for (int i = 0; i < 100; i++) {
        float v[3][3];
        for (int k = 0; k < 3; k++) {
            v[0][k] = rng_range(&rng, -1, 1);
            v[1][k] = v[0][k] + rng_range(&rng, -1, 1);
            v[2][k] = 0.5f * (v[0][k] + v[1][k]) + 1e-6f * rng_range(&rng, -1, 1);
        }
        part_tri_of(part, v);
    }
    for (uint32_t i = 0; i < 400 && !part->failed; i++) {
        float from[3], to[3];
        if (i % 2)
            part_point(part, &rng, i % 100, to);
        else
            part_edge(part, i % 100, (int)(i / 100 % 3), to);
        random_point(&rng, -2, 2, from);
        part_ray(part, ray_at(from, to));
    }
}

static void make_needles(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "needles");
    struct rng rng = rng_make(29, 0);
    for (int i = 0; i < 100; i++) {
        float v[3][3], width = 1e-7f * (float)(1 + i % 9);
        int along = i % 3, across = (along + 1) % 3;
        for (int k = 0; k < 3; k++)
            v[0][k] = v[1][k] = v[2][k] = rng_range(&rng, -1, 1);
        v[1][along] += 1;
        v[2][along] += 1;
        v[2][across] += width;
        part_tri_of(part, v);
    }
    for (uint32_t i = 0; i < 400 && !part->failed; i++) {
        float from[3], to[3];
        part_point(part, &rng, i % 100, to);
        random_near(&rng, to, i % 2 ? 1e-3f : 1.0f, from);
        if (i % 2)
            from[i % 100 % 3] -= 3; /* nearly along the needle */
        part_ray(part, ray_at(from, to));
    }
}

#define N 8

static void make_no_area(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "before a grid", N, 4);
    struct rng rng = rng_make(30, 0);
    for (int i = 0; i < 60; i++) { /* points and segments on the lattice, at z = 1 to 3 */
        float v[3][3];
        for (int k = 0; k < 3; k++)
            v[0][k] = v[1][k] = v[2][k] = whole(&rng, N - 2);
        v[0][2] = v[1][2] = v[2][2] = (float)(1 + i % 3);
        if (i % 4 == 1)
            v[1][i / 4 % 2] += 2; /* v0 = v2 */
        if (i % 4 >= 2) {
            v[1][0] += 2; /* three on a line, in all orders */
            v[1][1] += i % 4 == 2 ? 2.0f : 0.0f;
            v[2][0] += 1;
            v[2][1] += i % 4 == 2 ? 1.0f : 0.0f;
        }
        part_tri_of(part, v);
    }
    for (uint32_t i = 0; i < 240 && !part->failed; i++) {
        float p[3];
        part_corner(part, part->scene.index[6 * N * N + 3 * (i % 60) + i / 60 % 3], p);
        struct ray ray = ray_of(p[0], p[1], 0, 0, 0, 1);
        if (i % 2) { /* slanted through the vertex: at z = 4 still on the grid */
            ray.dir[0] = p[0] < 4 ? 1.0f : -1.0f;
            ray.dir[2] = p[2];
            ray.org[0] -= ray.dir[0];
        }
        part_ray(part, ray);
        want_range(part, HARD_OWN, 0, 2 * N * N);
    }
}

static void make_duplicates(struct hard_made *made)
{
    for (uint32_t most = 8; most <= 9; most++) {
        struct hard_part *part = part_add(made, "up to %u", most);
        struct rng rng = rng_make(31, most);
        for (uint32_t k = 2; k <= most; k++) { /* k copies of a triangle at x = 4 k */
            float x = 4 * (float)k;
            uint32_t first = part->scene.tri_count;
            for (uint32_t c = 0; c < k; c++)
                part_triangle(part, x, 0, 1, x + 2, 0, 1, x, 2, 1);
            for (int i = 0; i < 12; i++) {
                float a = 0.125f * (1 + whole(&rng, 6)), d = i % 2 ? 1.0f : -1.0f;
                part_ray(part, ray_of(x + a, 0.5f, 1 - d, 0, 0, d));
                want_range(part, HARD_ALL, first, k);
                want_t(part, HARD_OWN, 1);
            }
        }
    }
}

static void make_coplanar(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "overlaps");
    struct rng rng = rng_make(32, 0);
    for (int i = 0; i < 60; i++) {
        float s = (float)(1 << i % 4), x = whole(&rng, 12), y = whole(&rng, 12);
        float v[3][3] = {{x, y, 2}, {x + s, y, 2}, {x, y + s, 2}};
        if (i % 2) {
            v[0][0] += s;
            v[0][1] += s;
        }
        part_tri_of(part, v);
    }
    for (uint32_t i = 0; i < 240 && !part->failed; i++) {
        float v[3][3];
        scene_tri(&part->scene, i % 60, v);
        float x = 0.5f * v[0][0] + 0.25f * (v[1][0] + v[2][0]);
        float y = 0.5f * v[0][1] + 0.25f * (v[1][1] + v[2][1]);
        float d = i % 2 ? 2.0f : -2.0f;
        expect_t(part, HARD_OWN, ray_of(x, y, 2 - d, 0, 0, d), 1);
    }
}

static void make_windings(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "both sides");
    struct rng rng = rng_make(33, 0);
    for (uint32_t i = 0; i < 40; i++) {
        float x = 4 * (float)(i % 8), y = 4 * (float)(i / 8);
        uint32_t a = part_triangle(part, x, y, 1, x + 2, y, 1, x, y + 2, 1);
        part_tri(part, 3 * a, 3 * a + 2, 3 * a + 1);
        /* the flipped one has its own vertices, so that vertex 3 i is triangle i's */
        part_vertex(part, x, y, 1);
        part_vertex(part, x + 2, y, 1);
        part_vertex(part, x, y + 2, 1);
        for (int way = 0; way < 4; way++) {
            float s = 0.125f * (1 + whole(&rng, 6)), d = way % 2 ? 1.0f : -1.0f;
            part_ray(part, ray_of(x + s, y + 0.5f, 1 - d, 0, 0, d));
            want_range(part, HARD_ALL, a, 2);
            want_t(part, HARD_OWN, 1);
        }
    }
}

const struct hard_case hard_shapes_cases[] = {
    {
        .number = 28,
        .name = "slivers",
        .recipe = "triangles whose third vertex is the middle of the others + 1e-6, aimed at",
        .expected = "what the oracle says, within the proven bounds",
        .source = "numerics.md 4, 28: mt's band is wide there, woop's is not",
        .make = make_slivers,
    },
    {
        .number = 29,
        .name = "needles",
        .recipe = "triangles of 1 : 1e-7, seen across and nearly along",
        .expected = "what the oracle says, within the proven bounds",
        .source = "RenderKit/embree#387: t = 12291 on a skinny triangle seen at grazing angle",
        .make = make_needles,
    },
    {
        .number = 30,
        .name = "no-area",
        .recipe =
            "triangles that are points or segments, before a grid; rays through their vertices",
        .expected = "the grid behind them",
        .source = "numerics.md 4, 30: NaN u and v, n / 0; Vulkan: never a hit",
        .make = make_no_area,
    },
    {
        .number = 31,
        .name = "duplicates",
        .recipe = "2 to 8 and 2 to 9 copies of a triangle",
        .expected = "any of the copies, t = 1",
        .source = "numerics.md 4, 31: order, leaves that cannot be split; RTRS's F8",
        .make = make_duplicates,
    },
    {
        .number = 32,
        .name = "coplanar",
        .recipe = "overlapping triangles of sizes 1 to 8 in one lattice plane",
        .expected = "one of those at the point, t = 1",
        .source = "numerics.md 4, 32: order of coplanar triangles",
        .make = make_coplanar,
    },
    {
        .number = 33,
        .name = "windings",
        .recipe = "each triangle twice, with opposite windings, from both sides",
        .expected = "either of the two, t = 1: nothing is culled",
        .source = "numerics.md 4, 33: the sign of the determinant",
        .make = make_windings,
    },
    {0},
};
