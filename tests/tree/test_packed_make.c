/* Laws of packed_make and packed_make_auto. */
#include "tests/tree/packed_fixture.h"

static void packed_make_packs_an_empty_scene_in_every_layout(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh = {0};
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    for (size_t l = 0; layouts[l]; l++) {
        struct packed packed;
        assert_int_equal(packed_make(layouts[l], &bvh, &scene, &packed, NULL), STATUS_OK);
        assert_int_equal(packed.node_count, 0);
        assert_ptr_equal(packed.layout, layouts[l]);
        assert_int_equal(packed_check(&packed, &scene, NULL, NULL), STATUS_OK);
        packed_free(&packed);
    }
    scene_free(&scene);
}

static void packed_make_packs_a_single_leaf_in_every_layout(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    struct bvh bvh = trees_make(&scene, 4, TREES_BALANCED);
    for (size_t l = 0; layouts[l]; l++) {
        struct packed packed;
        assert_int_equal(packed_make(layouts[l], &bvh, &scene, &packed, NULL), STATUS_OK);
        assert_int_equal(packed.stack_need, 0);
        assert_int_equal(packed_check(&packed, &scene, NULL, NULL),
                         layouts[l]->faithful ? STATUS_INPUT : STATUS_OK);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

static void packed_make_refuses_the_tree_of_another_scene(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3), other = trees_grid(4);
    struct bvh bvh = trees_make(&scene, 4, TREES_BALANCED), empty = {0};
    struct packed packed;
    assert_int_equal(packed_make(layouts[0], &bvh, &other, &packed, NULL), STATUS_INPUT);
    assert_int_equal(packed_make(layouts[0], &empty, &scene, &packed, NULL), STATUS_INPUT);
    assert_int_equal(packed_make_auto(&bvh, &other, &packed, NULL, 0, NULL), STATUS_INPUT);
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&other);
}

static void auto_takes_the_smallest_layout_that_holds_the_scene(void **state)
{
    (void)state;
    struct packed packed;
    struct reason reason;
    char refused[400] = "old";
    struct scene scene = trees_grid(40);
    struct bvh bvh = trees_make(&scene, 8, TREES_BALANCED);
    assert_int_equal(packed_make_auto(&bvh, &scene, &packed, refused, sizeof refused, &reason),
                     STATUS_OK);
    assert_string_equal(packed.layout->name, "rf16");
    assert_string_equal(refused, "");
    packed_free(&packed);
    bvh_free(&bvh);

    bvh = trees_make(&scene, 9, TREES_BALANCED);
    assert_int_equal(packed_make_auto(&bvh, &scene, &packed, refused, sizeof refused, &reason),
                     STATUS_OK);
    assert_string_equal(packed.layout->name, "cwbvh80");
    assert_string_equal(refused, "rf16: a leaf holds at most 8 items, this tree has one of 9; use "
                                 "--leaf 8 or less, or --layout auto");
    packed_free(&packed);
    char small[10], none[1] = "x";
    assert_int_equal(packed_make_auto(&bvh, &scene, &packed, small, sizeof small, &reason),
                     STATUS_OK);
    assert_string_equal(small, "rf16: a l");
    packed_free(&packed);
    assert_int_equal(packed_make_auto(&bvh, &scene, &packed, none, 0, &reason), STATUS_OK);
    assert_int_equal(none[0], 'x');
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* The last record that 15 bits name, and the one after; then a bound beyond compact nodes. */
static void auto_takes_wider_indices_and_ranges_where_they_are_needed(void **state)
{
    (void)state;
    static const struct {
        uint32_t triangles; /* three records each but the first */
        float scale;
        const char *layout;
    } border[] = {
        {10923, 1, "rf16"},       {10924, 1, "cwbvh80"}, {70000, 1, "cwbvh80"},
        {64, 0x1p7f, "rf16"},     {64, 0x1p10f, "rf16"}, {512, 0x1p11f, "cwbvh80"},
        {64, 0x1p95f, "cwbvh80"}, {64, 0x1p101f, "f32"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(border); i++) {
        struct scene scene = trees_grid(border[i].triangles);
        for (size_t k = 0; k < 9 * (size_t)border[i].triangles; k++)
            scene.vertex[k] *= border[i].scale;
        struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
        struct packed packed;
        struct reason reason = {""};
        if (packed_make_auto(&bvh, &scene, &packed, NULL, 0, &reason))
            fail_msg("%u: %s", border[i].triangles, reason.text);
        assert_string_equal(packed.layout->name, border[i].layout);
        if (packed_check(&packed, &scene, NULL, &reason))
            fail_msg("%u: %s", border[i].triangles, reason.text);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

static void auto_refuses_what_no_layout_can_hold(void **state)
{
    (void)state;
    struct packed packed;
    struct reason reason;
    char refused[800];
    struct scene scene = trees_grid(66);
    for (size_t k = 0; k < 9 * 66; k++)
        scene.vertex[k] *= 0x1p110f;
    struct bvh bvh = trees_make(&scene, 1, TREES_RIGHT);
    assert_int_equal(packed_make_auto(&bvh, &scene, &packed, refused, sizeof refused, &reason),
                     STATUS_LIMIT);
    assert_null(packed.word);
    assert_non_null(strstr(refused, "rf16: a bound is at most 65504"));
    assert_non_null(strstr(refused, "\ncwbvh80: a bound is at most 1.2676506e+30"));
    assert_non_null(strstr(refused, "\nf32: the traversal stack holds 64 entries"));
    assert_non_null(strstr(reason.text, "no layout can hold this scene: f32: the traversal"));
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed_make_packs_an_empty_scene_in_every_layout),
        cmocka_unit_test(packed_make_packs_a_single_leaf_in_every_layout),
        cmocka_unit_test(packed_make_refuses_the_tree_of_another_scene),
        cmocka_unit_test(auto_takes_the_smallest_layout_that_holds_the_scene),
        cmocka_unit_test(auto_takes_wider_indices_and_ranges_where_they_are_needed),
        cmocka_unit_test(auto_refuses_what_no_layout_can_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
