/* Hard cases of worlds: the top level. */
#include "tests/hard/world_parts.h"

#include <math.h>

#define FAR_INSTANCES 12

static double axis_of(const struct instance *at, int axis, int corner)
{
    double p[3], out[3];
    for (int k = 0; k < 3; k++)
        p[k] = corner >> k & 1;
    placed_point(at, p, out);
    return out[axis];
}

/* The corner of the unit cube that is placed farthest along sign * axis. */
static int farthest(const struct instance *at, int axis, double sign)
{
    int best = 0;
    for (int c = 1; c < 8; c++)
        if (sign * axis_of(at, axis, c) > sign * axis_of(at, axis, best))
            best = c;
    return best;
}

/* A ray that runs along one face of the instance's world box and meets a face of the cube close
 * to the corner that lies in it. */
static void graze(struct hard_part *part, struct rng *rng, uint32_t instance, int axis, double sign)
{
    const struct instance *at = part_instance(part, instance);
    const int corner = farthest(at, axis, sign), along = (axis + 1 + (int)rng_below(rng, 2)) % 3;
    double p[3], to[3];
    float from[3];
    for (int k = 0; k < 3; k++) { /* between the corner and the middle, on one face */
        const double in = 0.002 + 0.008 * (double)rng_float(rng);
        p[k] = corner >> k & 1 ? 1 - in : in;
    }
    const uint32_t face = rng_below(rng, 3);
    p[face] = corner >> face & 1;
    placed_point(at, p, to);
    for (int k = 0; k < 3; k++)
        from[k] = (float)to[k];
    from[along] += rng_below(rng, 2) ? 64.0f : -64.0f;
    world_ray(part, ray_to(from, to), mode_of(0));
}

/* Cubes turned and moved to where float32 has steps of 1/8: a box of rounded corners is too small
 * by up to half of that. */
static void make_boxes(struct hard_made *made)
{
    for (int far = 0; far < 2; far++) {
        struct hard_part *part = part_world(made, 1, FAR_INSTANCES, far ? "far" : "near");
        struct rng rng = rng_make(101, (uint64_t)far);
        mesh_cube(part, 0);
        for (uint32_t i = 0; i < FAR_INSTANCES && !part->failed; i++) {
            const float size = far ? 0x1p20f : 0x1p4f;
            double m[3][3];
            rotation_draw(&rng, 1, m);
            place_linear(part_instance(part, i), m);
            const float x = whole(&rng, 64), y = whole(&rng, 512);
            place_at(part_instance(part, i), size + 4096 * (float)i + x, -size - y, size);
        }
        for (uint32_t i = 0; i < FAR_INSTANCES && !part->failed; i++)
            for (int k = 0; k < 24; k++)
                graze(part, &rng, i, k % 3, k % 2 ? 1 : -1);
    }
}

/* A row of plates, `count` of them active. */
static struct hard_part *some_active(struct hard_made *made, uint32_t instances, uint32_t active,
                                     const char *label)
{
    const uint32_t one = 1;
    struct hard_part *part = part_world(made, 1, instances, label);
    mesh_plates(part, 0, 1, &one);
    for (uint32_t i = 0; i < instances; i++) {
        place_at(part_instance(part, i), 0, 4 * (float)i, 0);
        part_instance(part, i)->mask = i < active ? 0xFF : 0;
    }
    return part;
}

/* Where the plates are, or were. */
static void shoot_row(struct hard_part *part, uint32_t count, uint32_t seen)
{
    for (uint32_t i = 0; i < 2 * count; i++) {
        const float y = 4 * (float)(i / 2) + 0.25f, z = i % 2 ? 4 : -4;
        world_ray(part, ray_of(0.25f, y, z, 0, 0, -z / 4), mode_of(0));
        if (i / 2 < seen)
            want_seen(part, i / 2, 0, i % 2);
        else
            want(part, HARD_ALL, WANT_MISS);
    }
}

/* The engine is the same from part to part, so that what it keeps of the part before is seen. */
static void make_empty(struct hard_made *made)
{
    const uint32_t none = 0;
    shoot_row(some_active(made, 4, 4, "four"), 4, 4);
    shoot_row(part_world(made, 0, 0, "no instance"), 4, 0);
    shoot_row(some_active(made, 4, 2, "two of four"), 4, 2);
    shoot_row(some_active(made, 4, 0, "none active"), 4, 0);
    struct hard_part *part = part_world(made, 1, 4, "empty mesh");
    mesh_plates(part, 0, 1, &none);
    shoot_row(part, 4, 0);
    part = some_active(made, 4, 4, "one without a mesh");
    part_instance(part, 3)->mesh = WORLD_NO_MESH;
    shoot_row(part, 4, 3);
}

/* The same world twice, its instances elsewhere the second time; rays at both places. */
static void make_moved(struct hard_made *made)
{
    for (int moved = 0; moved < 2; moved++) {
        const uint32_t one = 1;
        struct hard_part *part = part_world(made, 1, 6, moved ? "moved" : "at rest");
        mesh_plates(part, 0, 1, &one);
        for (uint32_t i = 0; i < 6; i++)
            place_at(part_instance(part, i), moved ? 40 + 4 * (float)i : 4 * (float)i, 0,
                     moved ? (float)i : 0);
        for (uint32_t i = 0; i < 6; i++) {
            world_shot(part, i, 0, true, 0, mode_of(0));
            want_seen(part, i, 0, true);
            const float x = moved ? 4 * (float)i + 0.25f : 40.25f + 4 * (float)i;
            world_ray(part, ray_of(x, 0.25f, 20, 0, 0, -1), mode_of(0));
            want(part, HARD_ALL, WANT_MISS);
        }
    }
}

const struct hard_case hard_world_levels_cases[] = {
    {
        .number = 101,
        .name = "world-boxes",
        .recipe = "turned cubes 10^6 away, rays close to corners that lie in faces of world boxes",
        .expected = "what is truly hit lies in the instance's box",
        .source = "Mesa: boxes of eight rounded corners are too small by up to 19 u",
        .flags = HARD_WORLD,
        .make = make_boxes,
    },
    {
        .number = 112,
        .name = "empty-top",
        .recipe = "worlds without instances, without active ones, of an empty mesh, after others",
        .expected = "nothing is hit, also of the world before",
        .source = "a build of no instances that leaves the last tree in place",
        .flags = HARD_WORLD,
        .make = make_empty,
    },
    {
        .number = 116,
        .name = "moved-top",
        .recipe = "a world, then the same world with its instances elsewhere",
        .expected = "the second world's boxes are its own",
        .source = "a stale refit of the top level",
        .flags = HARD_WORLD,
        .make = make_moved,
    },
    {0},
};
