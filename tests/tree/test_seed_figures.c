/* RTRS's published figures on its own default scene (the paper's Figure 8 and the statistics of
 * the trees behind it), and what becomes of flat floors. */
#include "ref/layout.h"
#include "scenes/scenes.h"
#include "tests/support/counted.h"
#include "tests/support/published.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

/* One row of the table: builder rtrs, eps 0.02. */
static const struct figures {
    uint32_t leaf;
    struct bvh_stats tree;
    uint32_t shrunk_leaves, shrunk_inner; /* boxes that lose volume by rounding to nearest */
    uint32_t direct_bytes, rf_bytes;
    uint32_t peak_stack; /* of RTRS's traversal in its reduced-footprint order */
} figures[] = {
    {2, {51, 26, 7, 2, 2}, 23, 23, 2448, 1232, 7},
    {4, {27, 14, 5, 4, 0}, 13, 13, 1296, 656, 6},
    {8, {15, 8, 4, 6, 0}, 7, 7, 720, 368, 5},
};

static void open_seed_scene(struct scene *scene)
{
    struct reason reason = {""};
    if (scene_open("rtrs", 1, scene, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(scene->tri_count, 40);
}

/* Every triangle to the bit, from the same corner on and in the same order: the published layouts
 * leave out the last. Lights, materials and camera likewise. */
static void the_generated_scene_is_the_published_one(void **state)
{
    (void)state;
    struct scene made, read;
    struct reason reason = {""};
    const char *path = published_scene();
    if (!path)
        skip();
    if (scene_read(path, &read, &reason))
        fail_msg("%s", reason.text);
    open_seed_scene(&made);
    assert_int_equal(made.vertex_count, read.vertex_count);
    assert_int_equal(made.tri_count, read.tri_count);
    for (uint32_t i = 0; i < made.tri_count; i++) {
        float a[3][3], b[3][3];
        scene_tri(&made, i, a);
        scene_tri(&read, i, b);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                assert_true(a[c][k] == b[c][k]);
        assert_int_equal(made.material_of[i], read.material_of[i]);
    }
    assert_int_equal(made.light_count, read.light_count);
    assert_memory_equal(made.light, read.light, made.light_count * sizeof *made.light);
    assert_int_equal(made.material_count, read.material_count);
    assert_memory_equal(made.material, read.material, made.material_count * sizeof *made.material);
    assert_memory_equal(made.camera.pos, read.camera.pos, sizeof made.camera.pos);
    assert_memory_equal(made.camera.at, read.camera.at, sizeof made.camera.at);
    assert_true(made.has_camera && made.camera.orbit == read.camera.orbit);
    scene_free(&made);
    scene_free(&read);
}

static struct bvh build_rtrs(const struct scene *scene, uint32_t leaf)
{
    struct bvh bvh;
    struct reason reason = {""};
    struct build_options options = {.leaf = leaf, .eps = 0.02f};
    if (builder_find("rtrs")->build(scene, &options, &bvh, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(bvh_check_form(&bvh, scene, NULL), STATUS_OK);
    return bvh;
}

static void seed_scene_gives_the_published_trees(void **state)
{
    (void)state;
    struct scene scene;
    open_seed_scene(&scene);
    for (size_t i = 0; i < ARRAY_COUNT(figures); i++) {
        struct bvh bvh = build_rtrs(&scene, figures[i].leaf);
        struct bvh_stats stats = bvh_counted(&bvh, &scene);
        assert_memory_equal(&stats, &figures[i].tree, sizeof stats);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* RTRS pops a node and pushes both children, fst on top; its box test culls nothing (F1), so
 * every ray's stack grows as the whole tree makes it. */
static uint32_t peak_of_seed_stack(const struct bvh *bvh)
{
    uint32_t stack[64] = {0}, count = 1, peak = 1;
    while (count > 0) {
        const struct bvh_node *node = &bvh->node[stack[--count]];
        if (node->item_count > 0)
            continue;
        assert_true(count + 2 <= ARRAY_COUNT(stack));
        stack[count++] = node->snd;
        stack[count++] = node->fst;
        peak = count > peak ? count : peak;
    }
    return peak;
}

static void seed_stack_peaks_as_published(void **state)
{
    (void)state;
    struct scene scene;
    open_seed_scene(&scene);
    for (size_t i = 0; i < ARRAY_COUNT(figures); i++) {
        struct bvh bvh = build_rtrs(&scene, figures[i].leaf);
        assert_int_equal(peak_of_seed_stack(&bvh), figures[i].peak_stack);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

static void seed_scene_takes_the_published_bytes(void **state)
{
    (void)state;
    struct scene scene;
    open_seed_scene(&scene);
    for (size_t i = 0; i < ARRAY_COUNT(figures); i++) {
        struct bvh bvh = build_rtrs(&scene, figures[i].leaf);
        struct packed direct, rf;
        assert_int_equal(packed_make(layout_find("rtrs_direct"), &bvh, &scene, &direct, NULL), 0);
        assert_int_equal(packed_make(layout_find("rtrs_rf"), &bvh, &scene, &rf, NULL), 0);
        assert_int_equal(packed_node_bytes(&direct) + packed_item_bytes(&direct),
                         figures[i].direct_bytes);
        assert_int_equal(packed_node_bytes(&rf) + packed_item_bytes(&rf), figures[i].rf_bytes);
        packed_free(&direct);
        packed_free(&rf);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

static void rounding_to_nearest_shrinks_most_boxes_of_the_seed_scene(void **state)
{
    (void)state;
    struct scene scene;
    open_seed_scene(&scene);
    for (size_t i = 0; i < ARRAY_COUNT(figures); i++) {
        struct bvh bvh = build_rtrs(&scene, figures[i].leaf);
        struct packed nearest, outward;
        assert_int_equal(packed_make(layout_find("rtrs_rf"), &bvh, &scene, &nearest, NULL), 0);
        assert_int_equal(packed_make(layout_find("rf16"), &bvh, &scene, &outward, NULL), 0);
        uint32_t shrunk[2] = {0, 0}, record = 0;
        for (uint32_t n = 0; n < bvh.node_count; n++) {
            const struct bvh_node *node = &bvh.node[n];
            struct box box = nearest.layout->box(&nearest, record);
            shrunk[node->item_count == 0] += !box_contains_box(&box, &node->bounds);
            box = outward.layout->box(&outward, record);
            assert_true(box_contains_box(&box, &node->bounds));
            record += node->item_count == 0 ? 1 : 2;
        }
        assert_int_equal(shrunk[0], figures[i].shrunk_leaves);
        assert_int_equal(shrunk[1], figures[i].shrunk_inner);
        packed_free(&nearest);
        packed_free(&outward);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* A floor of quads x quads unit squares at height 0.1, where centroids round out of the plane and
 * nothing is split (F4): one leaf of all. */
static struct scene floor_of(uint32_t quads)
{
    struct scene scene = trees_grid(2 * quads * quads);
    for (uint32_t q = 0; q < quads * quads; q++)
        for (uint32_t c = 0; c < 6; c++) {
            static const float dx[6] = {0, 1, 1, 0, 1, 0}, dz[6] = {0, 0, 1, 0, 1, 1};
            float *p = scene.vertex + 18 * (size_t)q + 3 * (size_t)c;
            p[0] = (float)(q % quads) + dx[c];
            p[1] = 0.1f;
            p[2] = (float)(q / quads) + dz[c];
        }
    return scene;
}

static void flat_floors_end_the_seed(void **state)
{
    (void)state;
    static const struct {
        uint32_t quads, items;
        const char *reason;
    } floors[] = {{2, 8, "RTRS panics (fault F6, docs/rtrs-faults.md)"},
                  {3, 18, "RTRS panics (fault F8, docs/rtrs-faults.md): 18 items"}};
    for (size_t i = 0; i < ARRAY_COUNT(floors); i++) {
        struct scene scene = floor_of(floors[i].quads);
        struct bvh bvh = build_rtrs(&scene, 4);
        struct packed packed;
        struct reason reason = {""};
        assert_int_equal(bvh.node_count, 1);
        assert_int_equal(bvh.node[0].item_count, floors[i].items);
        assert_int_equal(packed_make(layout_find("rtrs_rf"), &bvh, &scene, &packed, &reason),
                         STATUS_LIMIT);
        assert_non_null(strstr(reason.text, floors[i].reason));
        assert_int_equal(packed_make(layout_find("rtrs_direct"), &bvh, &scene, &packed, NULL), 0);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_generated_scene_is_the_published_one),
        cmocka_unit_test(seed_scene_gives_the_published_trees),
        cmocka_unit_test(seed_stack_peaks_as_published),
        cmocka_unit_test(seed_scene_takes_the_published_bytes),
        cmocka_unit_test(rounding_to_nearest_shrinks_most_boxes_of_the_seed_scene),
        cmocka_unit_test(flat_floors_end_the_seed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
