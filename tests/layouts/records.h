/* Records of wide layouts: their bits, and boxes that are written into one by hand. Include after
 * cmocka.h. */
#ifndef TESTS_RECORDS_H
#define TESTS_RECORDS_H

#include "ref/base/rng.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <string.h>

/* The bits of a record from `at` on, as the published table counts them. */
static inline uint32_t bits(const uint32_t *word, uint32_t at, uint32_t count)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < count; i++)
        value |= (word[(at + i) / 32] >> (at + i) % 32 & 1) << i;
    return value;
}

static inline void pack(struct packed *packed, const char *layout, const struct scene *scene,
                        uint32_t leaf)
{
    struct reason reason = {""};
    struct bvh bvh = trees_make(scene, leaf, TREES_BALANCED);
    if (packed_make(layout_find(layout), &bvh, scene, packed, &reason))
        fail_msg("%s", reason.text);
    bvh_free(&bvh);
}

/* As many triangles, `same` of each, so that leaves have that many. */
static inline struct scene copies(uint32_t count, uint32_t same)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++)
        memcpy(scene.vertex + 9 * (size_t)i, scene.vertex + 9 * (size_t)(i - i % same),
               9 * sizeof *scene.vertex);
    return scene;
}

/* A record of `count` leaves of one triangle each, far from each other. */
static inline struct packed leaves(const char *layout, uint32_t count)
{
    struct packed packed;
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < 9 * count; i++)
        scene.vertex[i] += 100 * (float)(i / 9);
    pack(&packed, layout, &scene, 1);
    scene_free(&scene);
    assert_int_equal(packed.node_count, 1);
    return packed;
}

/* Writes the boxes of all children. */
static inline enum status write_boxes(struct packed *packed, const struct box *box, uint32_t count)
{
    struct wide node;
    struct reason reason = {""};
    packed->layout->load(packed, 0, &node);
    assert_int_equal(node.child_count, count);
    memcpy(node.box, box, count * sizeof *box);
    return packed->layout->rebound(packed, 0, NULL, &node, &reason);
}

static inline float any_bound(struct rng *rng, int kind)
{
    static const float far_off[] = {1, 1e3f, 1e6f, 0x1p24f};
    float x = rng_range(rng, -1, 1);
    switch (kind) {
    case 0:
        return x;
    case 1:
        return far_off[rng_below(rng, 4)] + x;
    case 2:
        return ldexpf(x, (int)rng_below(rng, 248) - 148); /* up to subnormals and to 2^99 */
    case 3:
        return rng_below(rng, 2) ? x : ldexpf(x, -60); /* most a hair beside 0 */
    default:
        return 5; /* flat */
    }
}

#endif
