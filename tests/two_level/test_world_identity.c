/* A scene is a world of one instance at the identity: the same bits in every layout, storage, box
 * test, triangle test and query. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"

#define RAYS 40

/* One layout and storage. */
struct identity_pair {
    const struct scene *scene;
    const struct world *world;
    struct packed alone;
    struct packed_world packed;
    struct box bounds;
};

static void assert_same_list(const struct job *job, const struct world_job *world,
                             const struct ray *ray)
{
    static struct hit alone[STAND_LIST], both[STAND_LIST];
    static uint32_t tag[STAND_LIST];
    uint32_t alone_count, both_count;
    assert_int_equal(trace_ray_all(job, ray, STAND_LIST, alone, &alone_count, NULL), STATUS_OK);
    assert_int_equal(
        trace_world_ray_all(world, ray, ray_mode_all(), STAND_LIST, both, tag, &both_count, NULL),
        STATUS_OK);
    assert_int_equal(both_count, alone_count);
    assert_memory_equal(alone, both, both_count * sizeof *both);
    for (uint32_t i = 0; i < both_count; i++)
        assert_int_equal(tag[i] & ABI_TAG_CUSTOM, 0);
}

static uint32_t assert_same_ray(const struct job *job, const struct world_job *world,
                                const struct ray *ray)
{
    struct hit alone;
    struct trace_counts one = {0, 0}, two = {0, 0};
    struct tagged both;
    assert_int_equal(trace_ray(job, ray, &alone, &one), STATUS_OK);
    assert_int_equal(trace_world_ray(world, ray, ray_mode_all(), &both.hit, &both.tag, &two),
                     STATUS_OK);
    if (memcmp(&alone, &both.hit, sizeof alone) != 0)
        fail_msg("%s, %s, %s, %s: triangle %u at %a, in the world %u at %a",
                 job->packed->layout->name, job->box->name, job->tri->name, query_name(job->query),
                 alone.prim, (double)alone.t, both.hit.prim, (double)both.hit.t);
    assert_int_equal(two.tris, one.tris);
    assert_true(two.boxes >= one.boxes + (one.boxes > 1)); /* the top's root, or root and leaf */
    return alone.prim != ABI_NO_PRIM;
}

static uint32_t assert_same_answers(const struct identity_pair *pair)
{
    uint32_t hits = 0;
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++) {
            if (!tri_store_answers(pair->alone.store, tri_tests[t]->id))
                continue;
            struct job job = {.scene = pair->scene,
                              .packed = &pair->alone,
                              .box = box_tests[b],
                              .tri = tri_tests[t]};
            struct world_job world = {.world = pair->world,
                                      .packed = &pair->packed,
                                      .box = box_tests[b],
                                      .tri = tri_tests[t]};
            for (uint64_t i = 0; i < RAYS; i++) {
                struct ray ray = stand_ray(&pair->bounds, 3, i);
                for (int q = QUERY_CLOSEST; q <= QUERY_ANY; q++) {
                    job.query = world.query = (enum query)q;
                    hits += assert_same_ray(&job, &world, &ray);
                }
                assert_same_list(&job, &world, &ray);
            }
        }
    return hits;
}

/* Returns false if the layout or the storage cannot hold the scene or the top. */
static bool pair_make(struct identity_pair *pair, const struct bvh *bvh,
                      const struct world_trees *trees, const struct layout *layout,
                      const struct tri_store *store)
{
    struct reason reason = {""};
    if (packed_make_stored(layout, store, bvh, pair->scene, &pair->alone, &reason)) {
        assert_true(layout->item || layout->faithful || store != tri_stores[0]);
        return false;
    }
    /* RTRS's layouts lose the last item, of one item all. */
    const struct layout *top = layout->faithful ? layout_find("f32") : layout;
    if (packed_world_make(pair->world, trees, top, layout, store, &pair->packed, &reason))
        fail_msg("%s: %s", layout->name, reason.text);
    if (!layout->faithful && world_pack_check(pair->world, &pair->packed, NULL, &reason))
        fail_msg("%s: %s", layout->name, reason.text);
    return true;
}

static void assert_scene(const char *spec, const char *builder, uint32_t leaf, bool all_stores)
{
    struct scene scene;
    struct bvh bvh;
    struct world world;
    struct reason reason = {""};
    struct world_build build = stand_build(builder, leaf);
    uint32_t pairs = 0, faithful = 0;
    assert_int_equal(scene_open(spec, 1, &scene, &reason), STATUS_OK);
    assert_int_equal(bvh_build(build.bottom, &scene, &build.bottom_options, &bvh, &reason),
                     STATUS_OK);
    assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
    struct world_trees trees = stand_trees(&world, builder, leaf);
    struct identity_pair pair = {.scene = &scene, .world = &world, .bounds = scene_bounds(&scene)};
    for (size_t i = 0; layouts_all[i]; i++)
        for (size_t s = 0; s == 0 || (all_stores && tri_stores[s]); s++) {
            if (!pair_make(&pair, &bvh, &trees, layouts_all[i], tri_stores[s]))
                continue;
            uint32_t hits = assert_same_answers(&pair);
            assert_true(hits > 0);
            pairs++;
            faithful += layouts_all[i]->faithful;
            packed_free(&pair.alone);
            packed_world_free(&pair.packed);
        }
    assert_true(pairs > (all_stores ? 85u : 50u));
    assert_true(faithful > 0);
    world_trees_free(&trees);
    world_free(&world);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void triangles_at_random(void **state)
{
    (void)state;
    assert_scene("soup:n=120,size=0.4", "median", 4, false);
}

static void every_storage(void **state)
{
    (void)state;
    assert_scene("grid:n=6", "median", 3, true);
}

static void exact_ties(void **state)
{
    (void)state;
    assert_scene("stack:n=30", "sah_binned", 2, false);
}

static void a_split_tree_at_the_bottom(void **state)
{
    (void)state;
    assert_scene("needles:n=60", "sbvh", 2, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_at_random),
        cmocka_unit_test(every_storage),
        cmocka_unit_test(exact_ties),
        cmocka_unit_test(a_split_tree_at_the_bottom),
    };
    return cmocka_run_group_tests_name("world_identity", tests, NULL, NULL);
}
