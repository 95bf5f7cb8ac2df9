/* The reference traversal at the ends of what it counts, lists and compares. */
#include "ref/layout.h"
#include "ref/trace/all_hits.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/candidate.h"
#include "ref/store.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* `count` times the same triangle across the z axis, or `count` of them apart, one per unit. */
static struct scene pile(uint32_t count, float apart)
{
    struct scene scene = {.vertex_count = 3 * count, .tri_count = count};
    scene.vertex = calloc(9 * (size_t)count, sizeof *scene.vertex);
    scene.index = calloc(3 * (size_t)count, sizeof *scene.index);
    assert_non_null(scene.vertex);
    assert_non_null(scene.index);
    for (uint32_t i = 0; i < count; i++) {
        const float z = 1 + apart * (float)i, v[9] = {-1, -1, z, 3, -1, z, -1, 3, z};
        memcpy(scene.vertex + 9 * i, v, sizeof v);
    }
    for (uint32_t i = 0; i < 3 * count; i++)
        scene.index[i] = i;
    return scene;
}

static const struct ray along_z = {.dir = {0, 0, 1}, .tmax = INFINITY};

/* Of so many triangles in leaves that the ray meets one and all: each is tested once. */
static void work_is_counted_up_to_16_bits(void **state)
{
    (void)state;
    for (uint32_t count = 65533; count <= 65538; count++) {
        struct scene scene = pile(count, 0);
        struct bvh bvh;
        struct packed packed;
        const struct build_options options = {.leaf = 8, .eps = BUILD_EPS_DEFAULT};
        assert_int_equal(builder_find("median")->build(&scene, &options, &bvh, NULL), STATUS_OK);
        assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, NULL), STATUS_OK);
        const struct job job = {.scene = &scene,
                                .packed = &packed,
                                .box = box_test_find("robust"),
                                .tri = tri_test_find("mt"),
                                .query = QUERY_CLOSEST};
        struct hit hit;
        struct trace_counts counts = {0};
        uint32_t flag, work;
        assert_int_equal(trace_ray(&job, &along_z, &hit, &counts), STATUS_OK);
        assert_int_equal(counts.tris, count);
        assert_int_equal(trace_rays(&job, &along_z, 1, &hit, &flag, &work), STATUS_OK);
        assert_int_equal(work & 0xFFFF, count < 65535 ? count : 65535);
        assert_int_equal(work >> 16, counts.boxes < 65535 ? counts.boxes : 65535);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Without trees: of equal t the first stays, and what lies behind the last triangle is not read. */
static void brute_force_ends_with_the_last_triangle(void **state)
{
    (void)state;
    struct scene all = pile(6, 0), scene = all;
    struct world world;
    struct instance_record *record;
    for (int c = 0; c < 3; c++) /* the last one is nearer */
        all.vertex[9 * 5 + 3 * c + 2] = 0.5f;
    scene.tri_count = 5;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct hit hit, plain, list[8];
        uint32_t tag, tags[8];
        trace_world_brute(&world, record, tri_test_find("mt"), query, &along_z, ray_mode_all(),
                          &hit, &tag);
        assert_int_equal(hit.prim, 0);
        assert_true(hit.t == 1);
        trace_brute(&scene, tri_test_find("mt"), query, &along_z, &plain);
        assert_memory_equal(&hit, &plain, sizeof hit);
        assert_int_equal(trace_world_brute_all(&world, record, tri_test_find("mt"), &along_z,
                                               ray_mode_all(), 8, list, tags),
                         5);
        assert_int_equal(trace_brute_all(&scene, tri_test_find("mt"), &along_z, 8, list), 5);
    }
    free(record);
    world_free(&world);
    scene_free(&all);
}

/* RTRS's box test enters what lies behind the ray, the others do not: on either level. */
static void both_levels_test_boxes_as_the_job_says(void **state)
{
    (void)state;
    static const struct {
        const char *box;
        uint64_t boxes;
    } tests[] = {{"rtrs", 2}, {"robust", 1}, {"watertight", 1}};
    struct scene scene = pile(1, 0);
    struct world world;
    struct world_trees trees;
    struct packed_world packed;
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    const struct world_build how = {.top = builder_find("median"),
                                    .bottom = builder_find("median"),
                                    .top_options = options,
                                    .bottom_options = options};
    const struct ray away = {.dir = {0.125f, 0.25f, -1}, .tmax = INFINITY};
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(world_trees_make(&world, &how, &trees, NULL), STATUS_OK);
    assert_int_equal(packed_world_make(&world, &trees, layout_find("f32"), layout_find("f32"),
                                       tri_stores[0], &packed, NULL),
                     STATUS_OK);
    for (size_t b = 0; b < ARRAY_COUNT(tests); b++) {
        const struct world_job job = {.world = &world,
                                      .packed = &packed,
                                      .box = box_test_find(tests[b].box),
                                      .tri = tri_test_find("mt"),
                                      .query = QUERY_CLOSEST};
        struct trace_counts counts = {0};
        struct hit hit;
        uint32_t tag;
        assert_int_equal(trace_world_ray(&job, &away, ray_mode_all(), &hit, &tag, &counts),
                         STATUS_OK);
        assert_int_equal(hit.prim, ABI_NO_PRIM);
        assert_int_equal(counts.boxes, tests[b].boxes);
    }
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
    scene_free(&scene);
}

/* The heap does not look behind its last entry, where here a larger one lies. */
static void sorting_leaves_what_is_behind_alone(void **state)
{
    (void)state;
    for (uint32_t count = 0; count < 70; count++)
        for (uint32_t step = 1; step < 70; step += 7) {
            struct hit hit[71];
            uint32_t tag[71];
            for (uint32_t i = 0; i < count; i++) {
                hit[i] = (struct hit){.t = (float)(i * step % 71), .prim = i};
                tag[i] = i;
            }
            hit[count] = (struct hit){.t = 1e9f, .prim = 1000};
            tag[count] = 1000;
            all_hits_sort_tagged(hit, tag, count);
            for (uint32_t i = 1; i < count; i++)
                assert_true(hit[i - 1].t < hit[i].t ||
                            (hit[i - 1].t == hit[i].t && hit[i - 1].prim < hit[i].prim));
            for (uint32_t i = 0; i < count; i++)
                assert_int_equal(hit[i].prim, tag[i]);
            assert_int_equal(tag[count], 1000);
            assert_true(hit[count].t == 1e9f);
        }
}

/* A triangle whose side comes out as 0, of either sign, is seen from its back; turned over, from
 * its front. */
static void no_side_is_the_back(void **state)
{
    (void)state;
    struct scene scene = pile(1, 0);
    struct world world;
    struct instance_record *record;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
    const struct instance_at at = {.world = &world, .record = record, .mode = ray_mode_all()};
    for (int way = -1; way <= 1; way++)
        for (int flipped = 0; flipped < 2; flipped++) {
            const float z = (float)way;
            const float ahead[3] = {way ? 0 : 1, 0, z}, back[3] = {way ? -0.0f : -1, -0.0f, -z};
            uint32_t tag[2] = {0, 0};
            world.instance[0].flags = flipped ? ABI_INSTANCE_FLIP_FACING : 0;
            for (int i = 0; i < 2; i++) {
                struct hit hit = {.t = 1, .u = 0.25f, .v = 0.25f, .prim = 0};
                assert_true(candidate_counts(&at, i ? back : ahead, &hit, &tag[i]));
            }
            assert_int_equal((tag[0] & ABI_TAG_FRONT) != 0, (way < 0) != flipped);
            assert_int_equal((tag[1] & ABI_TAG_FRONT) != 0, (way > 0) != flipped);
        }
    free(record);
    world_free(&world);
    scene_free(&scene);
}

/* A wide triangle that is met at 50 in a box that begins at 0, and many that are met behind it but
 * begin before it: it is found first, and then the stack is too small. What cannot be finished has
 * no hit, whatever was found until then, in every way to trace. */
static void what_is_not_finished_is_a_miss(void **state)
{
    (void)state;
    struct scene scene = pile(65, 0);
    struct bvh bvh;
    const struct build_options options = {.leaf = 1, .eps = BUILD_EPS_DEFAULT};
    size_t unfinished = 0, found = 0;
    for (uint32_t i = 0; i < 65; i++) { /* each slopes along x, and is met at x = 0 */
        const float met = i ? 60 + (float)i : 50, begins = i ? 1 + (float)i / 8 : 0,
                    wide = i ? 1 : 9;
        const float v[9] = {-wide, -wide, begins, wide, -wide, 2 * met - begins, 0, 2 * wide, met};
        memcpy(scene.vertex + 9 * i, v, sizeof v);
    }
    assert_int_equal(builder_find("sah_sweep")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        if (packed_make(layouts_all[l], &bvh, &scene, &packed, NULL))
            continue;
        const uint32_t need = packed.stack_need;
        for (packed.stack_need = 0; packed.stack_need <= need; packed.stack_need++) {
            const struct job job = {.scene = &scene,
                                    .packed = &packed,
                                    .box = box_test_find("robust"),
                                    .tri = tri_test_find("mt"),
                                    .query = QUERY_CLOSEST};
            struct hit one, many[3], miss = hit_none();
            uint32_t flag[3];
            const struct ray rays[3] = {{.org = {99}, .dir = {0, 0, 1}, .tmax = INFINITY},
                                        along_z,
                                        {.org = {99}, .dir = {0, 0, 1}, .tmax = INFINITY}};
            const enum status status = trace_ray(&job, &along_z, &one, NULL);
            for (size_t from = 0; from < 2; from++) { /* another before it, and one behind it */
                assert_int_equal(trace_rays(&job, rays + from, 2, many, flag, NULL), status);
                assert_int_equal(flag[1 - from] == ABI_FLAG_DONE, status == STATUS_OK);
                assert_int_equal(flag[from], ABI_FLAG_DONE);
                assert_memory_equal(&one, &many[1 - from], sizeof one);
                assert_memory_equal(&miss, &many[from], sizeof one);
            }
            if (status)
                assert_memory_equal(&one, &miss, sizeof one);
            else if (!layouts_all[l]->faithful)
                assert_int_equal(one.prim, 0);
            unfinished += status == STATUS_LIMIT;
            found += status == STATUS_OK;
        }
        packed_free(&packed);
    }
    assert_true(unfinished > 50 && found > 50);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(work_is_counted_up_to_16_bits),
        cmocka_unit_test(brute_force_ends_with_the_last_triangle),
        cmocka_unit_test(what_is_not_finished_is_a_miss),
        cmocka_unit_test(both_levels_test_boxes_as_the_job_says),
        cmocka_unit_test(no_side_is_the_back),
        cmocka_unit_test(sorting_leaves_what_is_behind_alone),
    };
    return cmocka_run_group_tests_name("trace_limits", tests, NULL, NULL);
}
