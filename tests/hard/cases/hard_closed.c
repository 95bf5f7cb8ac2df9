/* Hard cases of closed meshes: what a watertight test must never miss, and crossings. */
#include "tests/hard/parts.h"

#include <string.h>

#define SPHERE "sphere:n=6"

/* Three closed meshes of extent 1 to 1000 around the origin. */
static struct hard_part *closed_mesh(struct hard_made *made, size_t i, float *reach)
{
    *reach = i == 2 ? 1000.0f : 1.0f;
    if (i == 0)
        return part_open(made, SPHERE);
    if (i == 1) {
        struct hard_part *cube = part_add(made, "cube");
        part_cube(cube, -1, 2);
        return cube;
    }
    struct hard_part *sphere = part_open(made, "sphere:n=5,radius=1000");
    strcpy(sphere->label, "large sphere");
    return sphere;
}

/* Origins well inside a sphere of radius `reach`. */
static void origin_inside(struct rng *rng, float reach, float from[3])
{
    for (int k = 0; k < 3; k++)
        from[k] = reach * rng_range(rng, -0.5f, 0.5f);
}

static void make_edges(struct hard_made *made)
{
    for (size_t m = 0; m < 3; m++) {
        float reach, from[3], to[3];
        struct hard_part *part = closed_mesh(made, m, &reach);
        struct rng rng = rng_make(14, m);
        for (uint32_t i = 0; i < 250 && !part->failed; i++) {
            origin_inside(&rng, reach, from);
            part_edge(part, rng_below(&rng, part->scene.tri_count), (int)(i % 3), to);
            expect_hit(part, HARD_TIGHT, ray_at(from, to));
        }
    }
}

static void make_vertices(struct hard_made *made)
{
    for (size_t m = 0; m < 3; m++) {
        float reach, from[3], to[3];
        struct hard_part *part = closed_mesh(made, m, &reach);
        struct rng rng = rng_make(15, m);
        for (uint32_t i = 0; i < 250 && !part->failed; i++) {
            origin_inside(&rng, reach, from);
            part_corner(part, i % part->scene.vertex_count, to);
            expect_hit(part, HARD_TIGHT, ray_at(from, to));
        }
    }
}

static void make_parity(struct hard_made *made)
{
    for (size_t m = 0; m < 3; m++) {
        float reach, from[3], to[3];
        struct hard_part *part = closed_mesh(made, m, &reach);
        struct rng rng = rng_make(57, m);
        for (uint32_t i = 0; i < 200 && !part->failed; i++) {
            random_far(&rng, 16 * reach, from);
            part_point(part, &rng, rng_below(&rng, part->scene.tri_count), to);
            expect_hit(part, HARD_ALL, ray_at(from, to));
        }
    }
}

/* Neighbours of opposite winding: by Vulkan's rules their edge is not shared, by raydiff's it is. A
 * sheared edge has one sign in either direction. */
static void make_opposite(struct hard_made *made)
{
    struct hard_part *part = part_open(made, SPHERE);
    struct rng rng = rng_make(61, 0);
    for (uint32_t i = 0; i < part->scene.tri_count; i += 2) {
        uint32_t *v = part->scene.index + 3 * (size_t)i;
        uint32_t swap = v[1];
        v[1] = v[2];
        v[2] = swap;
    }
    for (uint32_t i = 0; i < 400 && !part->failed; i++) {
        float from[3], to[3];
        origin_inside(&rng, 1, from);
        if (i % 2)
            part_edge(part, i % part->scene.tri_count, (int)(i % 3), to);
        else
            part_corner(part, i % part->scene.vertex_count, to);
        expect_hit(part, HARD_TIGHT, ray_at(from, to));
    }
}

/* A sphere of separate triangles: equal coordinates, no vertex shared. */
static void make_seam(struct hard_made *made)
{
    struct hard_made halves = {.part_count = 0};
    struct hard_part *part = part_add(made, "split sphere"), *from = part_open(&halves, SPHERE);
    struct rng rng = rng_make(62, 0);
    part_split(part, from);
    part->failed |= from->failed;
    hard_free(&halves);
    for (uint32_t i = 0; i < 400 && !part->failed; i++) {
        float a[3], to[3];
        origin_inside(&rng, 1, a);
        int corner = (int)rng_below(&rng, 3);
        part_edge(part, rng_below(&rng, part->scene.tri_count), corner, to);
        if (i % 2)
            part_corner(part, 3 * (i % part->scene.tri_count), to);
        expect_hit(part, HARD_TIGHT, ray_at(a, to));
    }
}

const struct hard_case hard_closed_cases[] = {
    {
        .number = 14,
        .name = "closed-edges",
        .recipe = "rays from inside closed meshes at the rounded middles of their edges",
        .expected = "watertight tests: always a hit",
        .source = "mitsuba3#1149 and #1300, dimforge/parry#444: leaks at edges",
        .make = make_edges,
    },
    {
        .number = 15,
        .name = "closed-vertices",
        .recipe = "rays from inside closed meshes at their vertices",
        .expected = "watertight tests: always a hit",
        .source = "RenderKit/embree#181, #174; Mesa's lvp_build_intersect_ray_box",
        .make = make_vertices,
    },
    {
        .number = 57,
        .name = "parity",
        .recipe = "rays from far outside through closed meshes, at points inside triangles",
        .expected =
            "an even number of crossings, by the oracle and by every engine that lists them",
        .source = "RenderKit/embree#188: a double hit on an edge",
        .flags = HARD_PARITY,
        .make = make_parity,
    },
    {
        .number = 61,
        .name = "opposite-winding",
        .recipe =
            "a closed sphere with every other triangle's winding flipped, aimed at edges, vertices",
        .expected = "watertight tests: always a hit, since a shared edge has one sign either way",
        .source = "VK-GL-CTS#446: a mesh with flipped windings; dimforge/parry#171: back faces",
        .make = make_opposite,
    },
    {
        .number = 62,
        .name = "seam",
        .recipe = "a closed sphere of triangles that share coordinates but no vertex",
        .expected = "watertight tests: always a hit; what counts are coordinates, not indices",
        .source = "Oblikovati#2146: a crack at a seam; MeshLib#1079: fma changes the triangle test",
        .make = make_seam,
    },
    {0},
};
