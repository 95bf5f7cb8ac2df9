/* A world with its trees, packed, and rays at it. Include after cmocka.h. */
#ifndef TWO_LEVEL_WORLD_STAND_H
#define TWO_LEVEL_WORLD_STAND_H

#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/packed_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <string.h>

#define STAND_RAYS 256
#define STAND_TMAX 1e30f

static inline struct world_build stand_build(const char *builder, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    return (struct world_build){.top = builder_find(builder),
                                .bottom = builder_find(builder),
                                .top_options = options,
                                .bottom_options = options};
}

static inline struct world_trees stand_trees(const struct world *world, const char *builder,
                                             uint32_t leaf)
{
    struct world_trees trees;
    struct reason reason = {""};
    struct world_build build = stand_build(builder, leaf);
    if (world_trees_make(world, &build, &trees, &reason))
        fail_msg("%s", reason.text);
    return trees;
}

static inline struct packed_world stand_packed(const struct world *world,
                                               const struct world_trees *trees, const char *top,
                                               const char *bottom)
{
    struct packed_world packed;
    struct reason reason = {""};
    if (packed_world_make(world, trees, layout_find(top), layout_find(bottom), tri_stores[0],
                          &packed, &reason) ||
        world_pack_check(world, &packed, NULL, &reason))
        fail_msg("%s over %s: %s", top, bottom, reason.text);
    return packed;
}

/* Builds with median, leaves of 2, and packs both levels in one layout. */
static inline struct packed_world stand_world(const struct world *world, const char *layout)
{
    struct world_trees trees = stand_trees(world, "median", 2);
    struct packed_world packed = stand_packed(world, &trees, layout, layout);
    world_trees_free(&trees);
    return packed;
}

static inline struct world_job stand_job(const struct world *world,
                                         const struct packed_world *packed, enum query query)
{
    return (struct world_job){.world = world,
                              .packed = packed,
                              .box = box_test_find("watertight"),
                              .tri = tri_test_find("mt"),
                              .query = query};
}

/* Ray `number` through a box, from outside or inside of it. */
static inline struct ray stand_ray(const struct box *box, uint64_t seed, uint64_t number)
{
    struct rng rng = rng_make(seed, number);
    struct ray ray = {.tmax = STAND_TMAX};
    for (int k = 0; k < 3; k++) {
        float size = box->hi[k] - box->lo[k] + 0.01f;
        float from = box->lo[k] + size * rng_range(&rng, -0.7f, 1.7f);
        float to = box->lo[k] + size * rng_float(&rng);
        ray.org[k] = from;
        ray.dir[k] = to - from;
    }
    return ray;
}

/* Ray `number` towards an instance of a packed world that is active, from around it or from around
 * all. It does not go on for thousands of sizes: from so far triangle tests hit what is not there,
 * and boxes do not keep that. */
static inline struct ray stand_aim(const struct packed_world *packed, uint64_t seed,
                                   uint64_t number)
{
    struct rng rng = rng_make(seed ^ 0x77, number);
    struct box all = box_empty();
    uint32_t at;
    for (uint32_t i = 0; i < packed->instance_count; i++)
        box_add_box(&all, &packed->box[i]);
    do
        at = rng_below(&rng, packed->instance_count);
    while (packed->record[at].mesh == WORLD_NO_MESH);
    struct ray near = stand_ray(&packed->box[at], seed, number);
    struct ray far = stand_ray(&all, seed, number);
    bool wide = box_half_area(&all) > 1e6 * box_half_area(&packed->box[at]);
    near.tmax = wide ? 100 : near.tmax;
    for (int k = 0; k < 3 && number % 2 && !wide; k++) {
        near.dir[k] += near.org[k] - far.org[k];
        near.org[k] = far.org[k];
    }
    return near;
}

/* A hit and its tag. */
struct tagged {
    struct hit hit;
    uint32_t tag;
};

static inline struct tagged stand_trace(const struct world_job *job, const struct ray *ray,
                                        struct ray_mode mode)
{
    struct tagged out;
    memset(&out, 0xAA, sizeof out);
    assert_int_equal(trace_world_ray(job, ray, mode, &out.hit, &out.tag, NULL), STATUS_OK);
    return out;
}

#define STAND_LIST 4096

/* All hits of a ray, sorted by t, then by prim; each once. */
struct tagged_list {
    struct tagged entry[STAND_LIST];
    uint32_t count;
};

static inline int tagged_order(const void *left, const void *right)
{
    const struct tagged *a = left, *b = right;
    if (a->hit.t != b->hit.t)
        return (a->hit.t > b->hit.t) - (a->hit.t < b->hit.t);
    return (a->hit.prim > b->hit.prim) - (a->hit.prim < b->hit.prim);
}

static inline void tagged_fill(struct tagged_list *list, const struct hit *hit, const uint32_t *tag,
                               bool repeats)
{
    uint32_t count = list->count;
    for (uint32_t i = 0; i < count; i++)
        list->entry[i] = (struct tagged){hit[i], tag[i]};
    qsort(list->entry, count, sizeof *list->entry, tagged_order);
    list->count = 0;
    for (uint32_t i = 0; i < count; i++)
        if (!repeats || i == 0 ||
            memcmp(&list->entry[list->count - 1], &list->entry[i], sizeof *list->entry) != 0)
            list->entry[list->count++] = list->entry[i];
}

static inline void stand_all(const struct world_job *job, const struct ray *ray,
                             struct ray_mode mode, struct tagged_list *out)
{
    static struct hit hit[STAND_LIST];
    static uint32_t tag[STAND_LIST];
    assert_int_equal(trace_world_ray_all(job, ray, mode, STAND_LIST, hit, tag, &out->count, NULL),
                     STATUS_OK);
    assert_true(out->count <= STAND_LIST);
    tagged_fill(out, hit, tag, job->packed->split);
}

#endif
