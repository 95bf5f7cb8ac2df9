/* Hard cases of worlds: which instance, geometry and triangle was hit. */
#include "tests/hard/world_parts.h"

/* One shot at every plate of every instance that has some, from both sides. */
static void shoot_all(struct hard_part *part, uint32_t plates)
{
    for (uint32_t i = 0; !part->failed && i < part->world.instance_count; i++)
        for (uint32_t k = 0; k < 2 * plates; k++) {
            const struct instance *at = part_instance(part, i);
            world_shot(part, i, k / 2, k % 2, 0, mode_of(0));
            if (at->mesh == WORLD_NO_MESH || at->mask == 0)
                want(part, HARD_ALL, WANT_MISS);
            else
                want_seen(part, i, k / 2, k % 2);
        }
}

/* Instances in a row along y, of one mesh of `plates` plates. */
static struct hard_part *row_of(struct hard_made *made, uint32_t instances, uint32_t plates,
                                const char *label)
{
    struct hard_part *part = part_world(made, 1, instances, label);
    mesh_plates(part, 0, 1, &plates);
    for (uint32_t i = 0; i < instances; i++)
        place_at(part_instance(part, i), 0, 4 * (float)i, 0);
    return part;
}

static void make_first(struct hard_made *made)
{
    shoot_all(row_of(made, 1, 5, "one instance"), 5);
    struct hard_part *part = row_of(made, 2, 2, "two at the identity");
    place_at(part_instance(part, 1), 0, 0, -4); /* below the first: hidden by it from above */
    for (int i = 0; i < 8; i++) {
        world_shot(part, 0, (uint32_t)i % 2, true, 0, mode_of(0));
        want_seen(part, 0, (uint32_t)i % 2, true);
    }
    part = row_of(made, 3, 2, "no custom index");
    for (uint32_t i = 0; i < 3; i++)
        part_instance(part, i)->custom = 0;
    shoot_all(part, 2);
}

static void make_custom(struct hard_made *made)
{
    static const uint32_t custom[] = {0,        1,        0xFF,     0x100,    0xFFFF,
                                      0x10000,  0x10001,  0x123456, 0x7FFFFF, 0x800000,
                                      0xABCDEF, 0xFFFFFE, 0xFFFFFF, 0xFFFFFF};
    struct hard_part *part = row_of(made, ARRAY_COUNT(custom), 1, "24 bits");
    for (uint32_t i = 0; i < ARRAY_COUNT(custom); i++)
        part_instance(part, i)->custom = custom[i];
    shoot_all(part, 1);
}

/* Instances without a mesh, and with mask 0, first, last and in between. */
static void make_inactive(struct hard_made *made)
{
    struct hard_part *part = row_of(made, 9, 2, "inactive");
    for (uint32_t i = 0; i < 9; i++) {
        if (i % 4 == 0)
            part_instance(part, i)->mesh = WORLD_NO_MESH;
        else if (i % 4 == 2)
            part_instance(part, i)->mask = 0;
    }
    shoot_all(part, 2);
    part = row_of(made, 3, 2, "the middle one");
    part_instance(part, 1)->mask = 0;
    shoot_all(part, 2);
}

static void make_geometries(struct hard_made *made)
{
    static const uint32_t sizes[] = {2, 0, 3, 1, 0, 4, 1}, after[] = {1, 6};
    struct hard_part *part = part_world(made, 2, 4, "seven geometries");
    mesh_plates(part, 0, ARRAY_COUNT(sizes), sizes);
    mesh_plates(part, 1, ARRAY_COUNT(after), after);
    for (uint32_t i = 0; i < 4; i++) {
        place_at(part_instance(part, i), 0, 4 * (float)i, 0);
        part_instance(part, i)->mesh = i % 2;
    }
    for (uint32_t i = 0; i < 4; i++)
        for (uint32_t k = 0; k < (i % 2 ? 7u : 11u); k++) {
            world_shot(part, i, k, true, 0, mode_of(0));
            want_seen(part, i, k, true);
        }
}

static void make_exchanged(struct hard_made *made)
{
    struct hard_part *part = row_of(made, 7, 2, "a permutation");
    for (uint32_t i = 0; i < 7; i++)
        part_instance(part, i)->custom = (3 * i + 1) % 7;
    shoot_all(part, 2);
    part = row_of(made, 2, 3, "two, exchanged");
    for (uint32_t i = 0; i < 2; i++)
        part_instance(part, i)->custom = 1 - i;
    shoot_all(part, 3);
}

const struct hard_case hard_world_names_cases[] = {
    {
        .number = 105,
        .name = "instance-0",
        .recipe = "plates of instance 0, alone, before others, with custom index 0",
        .expected = "the plate of instance 0",
        .source = "RTRS's fault F2 is the same of triangle 0: 0 stands for none",
        .flags = HARD_WORLD,
        .make = make_first,
    },
    {
        .number = 106,
        .name = "custom-index",
        .recipe = "instances with custom indices 0, 0xFFFF, 0x10000, 0xFFFFFF, two alike",
        .expected = "all 24 bits",
        .source = "a custom index that is kept in 16 bits, or signed",
        .flags = HARD_WORLD,
        .make = make_custom,
    },
    {
        .number = 113,
        .name = "inactive-between",
        .recipe = "instances without a mesh and with mask 0 between active ones",
        .expected = "inactive ones are missed and keep their numbers",
        .source = "Vulkan specification, Acceleration Structures: reference 0; a compacted list",
        .flags = HARD_WORLD,
        .make = make_inactive,
    },
    {
        .number = 114,
        .name = "geometries",
        .recipe = "two meshes of 7 and 2 geometries, some empty, in turn",
        .expected = "the triangle that was aimed at, whatever geometry it is in",
        .source =
            "a primitive index that counts within its geometry, a geometry index across meshes",
        .flags = HARD_WORLD,
        .make = make_geometries,
    },
    {
        .number = 115,
        .name = "index-exchanged",
        .recipe = "custom indices that are numbers of other instances",
        .expected = "the instance that was aimed at, with its custom index",
        .source = "gl_InstanceID and gl_InstanceCustomIndexEXT taken for each other",
        .flags = HARD_WORLD,
        .make = make_exchanged,
    },
    {0},
};
