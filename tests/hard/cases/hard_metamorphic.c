/* Hard cases that compare runs with each other: changed scenes, queries, modes; and trees with
 * their scenes. */
#include "tests/hard/parts.h"
#include "tests/hard/relations.h"

#include <math.h>
#include <stdio.h>

/* Rays at vertices, at points of triangles and at nothing; `snap` keeps all on a lattice of 1/8. */
static void add_rays(struct hard_part *part, uint64_t seed, uint32_t count, float reach, bool snap)
{
    struct rng rng = rng_make(seed, 0x55);
    for (uint32_t i = 0; i < count && !part->failed; i++) {
        float from[3], to[3];
        if (i % 3 == 0)
            part_corner(part, i % part->scene.vertex_count, to);
        else
            part_point(part, &rng, rng_below(&rng, part->scene.tri_count), to);
        random_near(&rng, to, reach, from);
        for (int k = 0; k < 3 && snap; k++) {
            to[k] = 0.125f * roundf(8 * to[k]);
            from[k] = 0.125f * roundf(8 * from[k]);
        }
        if (from[0] == to[0] && from[1] == to[1] && from[2] == to[2])
            from[2] -= 1;
        part_ray(part, ray_at(from, to));
    }
}

/* A height grid of whole numbers with a few triangles over it. */
static struct hard_part *lattice_scene(struct hard_made *made, uint64_t seed)
{
    struct hard_part *part = part_add(made, "lattice");
    struct rng rng = rng_make(seed, 0xA7);
    part_grid(part, 8, 2, 0, 1, -4);
    for (uint32_t i = 0; i < part->scene.vertex_count && !part->failed; i++)
        part->scene.vertex[3 * (size_t)i + 2] = whole(&rng, 4);
    for (int i = 0; i < 20; i++) {
        float v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                v[c][k] = 0.5f * whole(&rng, 17) - 4;
        part_tri_of(part, v);
    }
    return part;
}

/* Adds one part for each relation that is exact for the base part, the last so far. */
static void relate(struct hard_made *made)
{
    size_t base = made->part_count - 1;
    for (size_t r = 0; relations[r].name; r++)
        for (uint64_t seed = 1; seed <= 2; seed++) {
            struct hard_part *part = part_add(made, "%zu %s", base, relations[r].name);
            part->like = base;
            if (relations[r].make(&made->part[base], seed + 10 * r, part) || part->failed)
                continue;
            hard_part_free(part);
            made->part_count--;
        }
}

static void make_relations(struct hard_made *made)
{
    struct hard_part *part = lattice_scene(made, 55);
    add_rays(part, 1, 60, 8, true);
    relate(made);
    part = part_open(made, "soup:n=120,size=0.4");
    add_rays(part, 2, 60, 1, false);
    relate(made);
}

static void make_shifted(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", 8, 16);
    struct rng rng = rng_make(56, 0);
    part->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    for (int i = 0; i < 24; i++) {
        float x = whole(&rng, 8) + 0.25f, y = whole(&rng, 8) + 0.75f;
        float dx = whole(&rng, 5) - 2, dy = whole(&rng, 5) - 2;
        float dz = (float)(1 << rng_below(&rng, 4)), t = 16 / dz;
        size_t base = part->ray_count;
        for (int k = 0; k < 8; k++) { /* k directions farther back */
            float back = (float)k;
            struct ray ray =
                ray_of(x - (t + back) * dx, y - (t + back) * dy, 0 - back * dz, dx, dy, dz);
            expect_id(part, HARD_ALL, ray, grid_tri(8, x, y));
            want_like(part, HARD_ALL, base, 0, -back);
        }
    }
}

static void make_structure(struct hard_made *made)
{
    static const char *const specs[] = {
        "soup:n=300,size=0.2", "soup:n=300,offset=100", "sphere:n=8", "needles", "stack",
        "terrain:k=4",         "flake:depth=1,n=1"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct hard_part *part = part_open(made, specs[s]);
        add_rays(part, s, 16, 1, false);
    }
    for (int shift = -30; shift <= 12; shift += 6) {
        struct hard_part *part = part_open(made, "sphere:n=5");
        snprintf(part->label, sizeof part->label, "sphere * 2^%d", shift);
        for (size_t i = 0; i < 3 * (size_t)part->scene.vertex_count; i++)
            part->scene.vertex[i] = ldexpf(part->scene.vertex[i], shift);
        add_rays(part, 58, 16, ldexpf(2, shift), false);
    }
}

static void make_any(struct hard_made *made)
{
    struct hard_part *part = lattice_scene(made, 59);
    add_rays(part, 3, 200, 8, true);
    part = part_open(made, "soup:n=200,size=0.4");
    add_rays(part, 4, 200, 1, false);
    for (size_t i = 0; i < part->ray_count && !part->failed; i++)
        part->ray[i].tmax = i % 2 ? 0.75f : 1.5f;
}

static void make_modes(struct hard_made *made)
{
    struct hard_part *part = part_open(made, "soup:n=200,size=0.4");
    add_rays(part, 5, 300, 1, false);
    part = lattice_scene(made, 60);
    add_rays(part, 6, 300, 8, true);
}

const struct hard_case hard_metamorphic_cases[] = {
    {
        .number = 55,
        .name = "relations",
        .recipe = "a lattice and a soup mirrored, permuted, rotated, rewound, scaled, moved",
        .expected = "the same triangle; t to the bit where the change is exact in the formula",
        .source = "numerics.md 4, 55: order and axis bugs",
        .make = make_relations,
    },
    {
        .number = 56,
        .name = "shifted-origin",
        .recipe = "the same line from origins 0 to 7 directions farther back, on a lattice",
        .expected = "the same triangle at exactly t + k",
        .source = "numerics.md 4, 56: thresholds relative to t",
        .make = make_shifted,
    },
    {
        .number = 58,
        .name = "structure",
        .recipe = "trees of soups, spheres from 2^-30 to 2^12, needles, duplicates, terrain",
        .expected = "every decoded box contains its triangles, each of which is in one leaf",
        .source = "gkjohnson/three-mesh-bvh#169, madmann91/bvh#84: found without shooting a ray",
        .flags = HARD_TREES_ONLY | HARD_STRUCTURE,
        .make = make_structure,
    },
    {
        .number = 59,
        .name = "any-hit",
        .recipe = "a lattice and a soup, some ranges ending before the target",
        .expected = "any-hit says hit exactly where the closest hit is one",
        .source = "numerics.md 4, 59: separate code paths",
        .flags = HARD_ANY_TOO,
        .make = make_any,
    },
    {
        .number = 60,
        .name = "float-modes",
        .recipe = "the same job with FTZ and DAZ set and not, on one thread and on all",
        .expected = "the same bits",
        .source = "numerics.md 4, 60: the environment leaks in; Embree sets both while it builds",
        .flags = HARD_FLOAT_MODE,
        .make = make_modes,
    },
    {0},
};
