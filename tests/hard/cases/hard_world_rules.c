/* Hard cases of worlds: what a ray may meet. */
#include "tests/hard/world_parts.h"

static const double turns[4][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                      {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                      {{0, 2, 0}, {2, 0, 0}, {0, 0, 2}},
                                      {{0.5, 0, 0}, {0, 0, 0.5}, {0, 0.5, 0}}};

/* An instance of two plates; turns 1 to 3 are mirrors. */
static struct hard_part *turned(struct hard_made *made, size_t turn, uint32_t flags,
                                const char *label)
{
    const uint32_t two = 2;
    struct hard_part *part = part_world(made, 1, 1, label);
    mesh_plates(part, 0, 1, &two);
    place_linear(part_instance(part, 0), turns[turn]);
    place_at(part_instance(part, 0), 3, -5, 7);
    part_instance(part, 0)->flags = flags;
    return part;
}

/* Both sides of both plates with each flag of culling by side. */
static void shoot_sides(struct hard_part *part)
{
    const uint32_t flags = part_instance(part, 0)->flags;
    const bool flipped = flags & ABI_INSTANCE_FLIP_FACING;
    for (uint32_t k = 0; k < 12; k++) {
        const uint32_t cull[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT}, by = cull[k / 4];
        const bool front = (k % 2 == 1) != flipped;
        const bool culled = by == (front ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK);
        world_shot(part, 0, k / 2 % 2, k % 2, 0, mode_of(by));
        if (culled && !(flags & ABI_INSTANCE_CULL_DISABLE))
            want(part, HARD_ALL, WANT_MISS);
        else
            want_seen(part, 0, k / 2 % 2, front);
    }
}

static void make_mirror(struct hard_made *made)
{
    for (size_t t = 0; t < ARRAY_COUNT(turns); t++) {
        shoot_sides(turned(made, t, 0, t ? "mirrored" : "as it is"));
        shoot_sides(turned(made, t, ABI_INSTANCE_FLIP_FACING, t ? "mirrored, flipped" : "flipped"));
    }
}

static void make_disable(struct hard_made *made)
{
    for (size_t t = 0; t < ARRAY_COUNT(turns); t++)
        for (uint32_t flip = 0; flip < 2; flip++)
            shoot_sides(turned(made, t, ABI_INSTANCE_CULL_DISABLE | flip * ABI_INSTANCE_FLIP_FACING,
                               flip ? "not culled, flipped" : "not culled"));
}

static void make_masks(struct hard_made *made)
{
    static const uint32_t of_instance[] = {0x81, 0x01, 0xFF, 0x80, 0x7F};
    static const uint32_t of_ray[] = {0x01, 0x80, 0xFF, 0x81, 0x7E, 0x00};
    const uint32_t one = 1;
    struct hard_part *part = part_world(made, 1, ARRAY_COUNT(of_instance), "masks");
    mesh_plates(part, 0, 1, &one);
    for (uint32_t i = 0; i < ARRAY_COUNT(of_instance); i++) {
        place_at(part_instance(part, i), 0, 4 * (float)i, 0);
        part_instance(part, i)->mask = of_instance[i];
    }
    for (uint32_t i = 0; i < ARRAY_COUNT(of_instance); i++)
        for (uint32_t r = 0; r < ARRAY_COUNT(of_ray); r++) {
            world_shot(part, i, 0, true, 0, (struct ray_mode){of_ray[r], 0});
            if (of_instance[i] & of_ray[r])
                want_seen(part, i, 0, true);
            else
                want(part, HARD_ALL, WANT_MISS);
        }
}

/* A pile of plates that are not opaque, under a filter that passes some of them over. */
static void make_first(struct hard_made *made)
{
    const uint32_t sizes[] = {0, 8};
    for (uint32_t seed = 0; seed < 4; seed++) {
        struct hard_part *part = part_world(made, 1, 8, "pile");
        mesh_plates(part, 0, 2, sizes);
        part->world.filter = (struct filter_rule){FILTER_TRIANGLES, seed, 96};
        for (uint32_t i = 0; i < 8; i++)
            place_at(part_instance(part, i), 0, 0, -(float)i);
        for (uint32_t k = 0; k < 16; k++) {
            struct place place = {.geometry = 1, .prim = k / 2, .tri = k / 2};
            bool some = false;
            for (; place.instance < 8 && !some; place.instance++)
                some = filter_passes(&part->world.filter, &place, 0.25f, 0.25f);
            world_shot(part, 0, k / 2, true, 0, mode_of(k % 2 ? ABI_RAY_FIRST : 0));
            want(part, HARD_ALL, some ? WANT_HIT : WANT_MISS);
        }
    }
}

/* The instance is sheared along x by 4 z: M n is (4, 0, 1), where the normal is (0, 0, 1). A
 * slanted ray meets them from other sides. */
static void make_normals(struct hard_made *made)
{
    static const double shear[2][3][3] = {{{1, 0, 4}, {0, 1, 0}, {0, 0, 1}},
                                          {{1, 0, 0}, {0, 1, 0}, {0, 0, -0.0625}}};
    const uint32_t two = 2;
    for (size_t s = 0; s < 2; s++) {
        struct hard_part *part = part_world(made, 1, 1, s ? "flattened mirror" : "sheared");
        mesh_plates(part, 0, 1, &two);
        place_linear(part_instance(part, 0), shear[s]);
        for (uint32_t k = 0; k < 12; k++) {
            const bool above = k % 2;
            world_shot(part, 0, k / 6, above, above ? 8.0f : -8.0f,
                       mode_of(k % 3 ? ABI_RAY_CULL_BACK : 0));
            if (k % 3 && !above)
                want(part, HARD_ALL, WANT_MISS);
            else
                want_seen(part, 0, k / 6, above);
        }
    }
}

const struct hard_case hard_world_rules_cases[] = {
    {
        .number = 104,
        .name = "mirror-facing",
        .recipe = "plates in three mirrors, flipped and not, from both sides, each side culled",
        .expected = "a mirror exchanges no sides",
        .source = "Vulkan specification, Ray Traversal: facing is decided in object space",
        .flags = HARD_WORLD,
        .make = make_mirror,
    },
    {
        .number = 107,
        .name = "masks",
        .recipe = "masks of instances and rays with one bit in common, with all, with none",
        .expected = "met where one bit is in common",
        .source = "masks compared with ==",
        .flags = HARD_WORLD,
        .make = make_masks,
    },
    {
        .number = 108,
        .name = "cull-disabled",
        .recipe = "instances that are not culled by side, rays that cull front or back",
        .expected = "both sides are hit",
        .source = "Vulkan specification: TRIANGLE_FACING_CULL_DISABLE",
        .flags = HARD_WORLD,
        .make = make_disable,
    },
    {
        .number = 110,
        .name = "first-passed",
        .recipe = "8 plates that are not opaque behind each other; a filter passes some over",
        .expected = "a ray that ends at its first hit ends at one that counts",
        .source = "terminate on first hit at a candidate that was not confirmed",
        .flags = HARD_WORLD,
        .make = make_first,
    },
    {
        .number = 117,
        .name = "normals",
        .recipe = "a sheared plate and a flattened one, slanted rays, back faces culled",
        .expected = "the side that is seen in the space of the mesh",
        .source = "normals transformed by M, not by the inverse's transpose",
        .flags = HARD_WORLD,
        .make = make_normals,
    },
    {0},
};
