/* Hard cases of worlds: the ray in the space of the mesh. */
#include "tests/hard/world_parts.h"

#include <math.h>

/* Rays from `distance` away at points inside random triangles of an instance. */
static void aim_at(struct hard_part *part, struct rng *rng, uint32_t instance, uint32_t count,
                   float distance)
{
    const struct instance *at = part_instance(part, instance);
    for (uint32_t i = 0; i < count && !part->failed; i++) {
        const struct scene *scene = part->world.mesh[at->mesh].scene;
        double p[3] = {0, 0, 0}, to[3];
        float v[3][3], from[3], away[3];
        scene_tri(scene, rng_below(rng, scene->tri_count), v);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                p[k] += (c == 0 ? 0.5 : 0.25) * (double)v[c][k];
        placed_point(at, p, to);
        random_far(rng, distance, away);
        for (int k = 0; k < 3; k++)
            from[k] = (float)to[k] + away[k];
        world_ray(part, ray_to(from, to), mode_of(0));
    }
}

/* Three rows that are the same but for 2^-shift: each cofactor cancels to that, the determinant to
 * its square. */
static void near_singular(struct rng *rng, int shift, double m[3][3])
{
    double row[3];
    for (int j = 0; j < 3; j++)
        row[j] = (double)rng_range(rng, 0.5f, 1) * (rng_below(rng, 2) ? 1 : -1);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[i][j] = row[j] + ldexp((double)rng_range(rng, -1, 1), -shift);
}

static void make_inverse(struct hard_made *made)
{
    for (int shift = 4; shift <= 10; shift += 3) {
        struct hard_part *part = part_world(made, 1, 8, "near singular");
        struct rng rng = rng_make(102, (uint64_t)shift);
        mesh_open(part, 0, "sphere:n=3");
        for (uint32_t i = 0; i < 8 && !part->failed; i++) {
            double m[3][3];
            near_singular(&rng, shift, m);
            place_linear(part_instance(part, i), m);
            place_at(part_instance(part, i), 8 * (float)i, 0, 0);
        }
        for (uint32_t i = 0; i < 8; i++)
            aim_at(part, &rng, i, 12, 4);
    }
}

/* Small instances within large ones that are not around the origin, in turn. A ray that went to a
 * large one and back has lost what the small one after it can tell. */
static void make_forth(struct hard_made *made)
{
    struct hard_part *part = part_world(made, 1, 8, "small in large");
    struct rng rng = rng_make(103, 0);
    mesh_open(part, 0, "sphere:n=3");
    for (uint32_t i = 0; i < 8 && !part->failed; i++) {
        const float away = i % 2 ? 0 : 8192;
        double m[3][3];
        rotation_draw(&rng, i % 2 ? 0.5 : 32768, m);
        place_linear(part_instance(part, i), m);
        place_at(part_instance(part, i), away + 2 * (float)i, -away, away / 2);
    }
    for (uint32_t i = 0; i < 8; i++)
        aim_at(part, &rng, i, 24, 3);
}

/* The transforms are exact, so that t is 4 to the bit in every test of differences. */
static void make_length(struct hard_made *made)
{
    static const double size[] = {0x1p-20, 0.0078125, 0.5, 1, 8, 4096, 0x1p20};
    const uint32_t one = 1;
    for (size_t s = 0; s < ARRAY_COUNT(size); s++) {
        const double m[3][3] = {{0, size[s], 0}, {0, 0, -size[s]}, {size[s], 0, 0}};
        struct hard_part *part = part_world(made, 1, 1, "scaled");
        mesh_plates(part, 0, 1, &one);
        place_linear(part_instance(part, 0), m);
        place_at(part_instance(part, 0), (float)size[s], -(float)size[s], 2 * (float)size[s]);
        for (int i = 0; i < 8; i++) {
            world_shot(part, 0, 0, i % 2, 0.25f * (float)i, mode_of(0));
            want_seen(part, 0, 0, i % 2);
            want_t(part, HARD_LEAN, 4);
        }
    }
}

static void make_last(struct hard_made *made)
{
    static const double turn[4][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                         {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{0, 0, 2}, {0.5, 0, 0}, {0, -1, 0}},
                                         {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const uint32_t two = 2;
    struct hard_part *part = part_world(made, 1, 8, "turned in turn");
    mesh_plates(part, 0, 1, &two);
    for (uint32_t i = 0; i < 8; i++) {
        place_linear(part_instance(part, i), turn[i % 4]);
        place_at(part_instance(part, i), 32 * (float)i, 0, 0);
    }
    for (uint32_t i = 0; i < 32; i++) {
        world_shot(part, i % 8, i / 8 % 2, i < 16, 0, mode_of(0));
        want_seen(part, i % 8, i / 8 % 2, i < 16);
    }
    /* At one place: the instance before has another mesh there. */
    part = part_world(made, 2, 2, "two meshes");
    mesh_plates(part, 0, 1, &two);
    mesh_open(part, 1, "sphere:n=3");
    part_instance(part, 1)->mesh = 1;
    place_at(part_instance(part, 1), 0, 16, 0);
    struct rng rng = rng_make(111, 0);
    aim_at(part, &rng, 1, 16, 4);
    world_shot(part, 0, 1, true, 0, mode_of(0));
    want_seen(part, 0, 1, true);
}

const struct hard_case hard_world_transforms_cases[] = {
    {
        .number = 102,
        .name = "inverse",
        .recipe = "spheres placed by matrices whose cofactors cancel to 2^-4, 2^-7, 2^-10",
        .expected = "t within the proven error of the exact inverse, rounded once",
        .source = "design of worlds: the inverse computed in float32 is off by its condition",
        .flags = HARD_WORLD,
        .make = make_inverse,
    },
    {
        .number = 103,
        .name = "forth-and-back",
        .recipe = "small spheres within large ones that lie around another point, in turn, turned",
        .expected = "each instance gets the ray of the world, not one that was taken back",
        .source = "design of worlds: a ray that is transformed back differs by u |T| each time",
        .flags = HARD_WORLD,
        .make = make_forth,
    },
    {
        .number = 109,
        .name = "t-in-lengths",
        .recipe = "a plate scaled by 2^-20 .. 2^20, hit at t = 4",
        .expected = "t counts in multiples of the direction: 4 to the bit",
        .source = "a direction that is normalised after its transform",
        .flags = HARD_WORLD,
        .make = make_length,
    },
    {
        .number = 111,
        .name = "last-transform",
        .recipe = "plates turned, mirrored, sheared in turn; two meshes after each other",
        .expected = "the plate of the instance that was aimed at",
        .source = "a transform that is kept from the instance before",
        .flags = HARD_WORLD,
        .make = make_last,
    },
    {0},
};
