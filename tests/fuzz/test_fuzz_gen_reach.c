/* The map of states on trials: deep trees, cut boxes, and how much of it trials reach. */
#include "tests/fuzz/coverage_fixture.h"

static void a_deep_tree_and_a_cut_box(void **state)
{
    (void)state;
    struct fuzz_trial trial = copies(60, 1, 0, 1);
    struct scene *scene = &trial.scene;
    float *vertex = realloc(scene->vertex, 60 * 36);
    assert_non_null(vertex);
    scene->vertex = vertex;
    scene->vertex_count = 180;
    for (uint32_t i = 0; i < 180; i++) { /* positions 2^-i */
        float at = ldexpf(1, -(int)(i / 3));
        vertex[3 * i] = at + (i % 3 == 0 ? 0.0625f * at : 0);
        vertex[3 * i + 1] = i % 3 == 1 ? 0.0625f * at : 0;
        vertex[3 * i + 2] = 0;
        scene->index[i] = i;
    }
    uint64_t map[COVERAGE_WORDS] = {0};
    add_all(map, &trial, "f32");
    assert_true(has(map, "depth.48-"));
    assert_false(has(map, "shape.mixed_scales"));
    assert_false(has(map, "shape.cut_box"));
    vertex[3] = 0x1p30f; /* one that is far larger than all others */
    add_all(map, &trial, "f32");
    assert_true(has(map, "shape.mixed_scales"));
    vertex[3] = 1;
    struct bvh bvh;
    trial.builder = builder_find("rtrs");
    trial.build.eps = 0x1p-20f;
    assert_int_equal(trial.builder->build(scene, &trial.build, &bvh, NULL), STATUS_OK);
    coverage_add_tree(map, &trial, &bvh);
    assert_true(has(map, "members.rtrs.robust.mt"));
    bvh.node[1].bounds.hi[0] = 2 * bvh.node[0].bounds.hi[0];
    coverage_add_tree(map, &trial, &bvh);
    assert_true(has(map, "shape.cut_box"));
    bvh_free(&bvh);
    fuzz_trial_free(&trial);
}

/* How much of the map plain trials reach by their trees and rays alone. */
static void trials_reach_much_of_it(void **state)
{
    (void)state;
    uint64_t map[COVERAGE_WORDS] = {0};
    static const struct gen_options options = {16, 64, 200, true};
    uint32_t after_ten = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        struct fuzz_trial trial = trial_of(83, i, &options);
        struct bvh bvh;
        struct packed packed;
        if (trial.builder->build(&trial.scene, &trial.build, &bvh, NULL) == STATUS_OK) {
            const struct layout *layout = layout_find(i % 2 ? "rf16" : "rtrs_rf");
            struct box root = bvh.node_count ? bvh.node[0].bounds : box_empty();
            struct oracle_answer miss = {.prim = ABI_NO_PRIM};
            coverage_add_tree(map, &trial, &bvh);
            if (packed_make(layout, &bvh, &trial.scene, &packed, NULL)) {
                coverage_add_refusal(map, layout, &trial, &bvh);
            } else {
                coverage_add_packed(map, &packed);
                packed_free(&packed);
            }
            for (uint32_t r = 0; r < trial.ray_count; r++)
                coverage_add_truth(map, &trial.ray[r], &root, &miss);
            bvh_free(&bvh);
        }
        fuzz_trial_free(&trial);
        after_ten = i == 9 ? coverage_count(map) : after_ten;
    }
    static const char *const reached[] = {"depth.32-47",
                                          "leaf.8",
                                          "leaf.9-15",
                                          "half.infinite",
                                          "half.subnormal",
                                          "half.2^-14",
                                          "half.65504",
                                          "half.minus_zero",
                                          "half.one_step",
                                          "shape.cut_box",
                                          "shape.empty",
                                          "shape.single",
                                          "shape.same_boxes",
                                          "refused.rf16.leaf",
                                          "refused.rf16.bounds",
                                          "ray.nan",
                                          "ray.zero",
                                          "ray.on_face",
                                          "ray.backward",
                                          "ray.subnormal"};
    char text[8192];
    print_map(map, text, sizeof text);
    print_message("%u bits after 10 trials, %u after 1000\n", after_ten, coverage_count(map));
    for (size_t i = 0; i < ARRAY_COUNT(reached); i++)
        if (!has(map, reached[i]))
            fail_msg("1000 trials do not reach %s: %s", reached[i], text);
    assert_true(coverage_count(map) > after_ten + 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_deep_tree_and_a_cut_box),
        cmocka_unit_test(trials_reach_much_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
