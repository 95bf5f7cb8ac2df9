/* The map of states that trials reach: each bit means what its name says, for deep trees and cut
 * boxes too, and trials reach much of it. */
#include "tests/fuzz/coverage_fixture.h"

static bool is_named(char (*name)[COVERAGE_NAME_MOST], const char *group, const char *member)
{
    for (uint32_t bit = 0; bit < coverage_known(); bit++)
        if (strncmp(name[bit], group, strlen(group)) == 0 && strstr(name[bit], member))
            return true;
    return false;
}

static void every_bit_has_a_name_of_its_own(void **state)
{
    (void)state;
    char name[COVERAGE_BITS][COVERAGE_NAME_MOST];
    assert_true(coverage_known() > 200 && coverage_known() <= COVERAGE_BITS);
    for (uint32_t bit = 0; bit < COVERAGE_BITS; bit++) {
        assert_int_equal(coverage_name(bit, name[bit]), bit < coverage_known());
        assert_int_equal(name[bit][0] != '\0', bit < coverage_known());
        if (bit < coverage_known())
            assert_non_null(strchr(name[bit], '.'));
    }
    /* Each of these members has a place of its own. */
    for (size_t i = 0; builders_all[i]; i++)
        assert_true(is_named(name, "members.", builders_all[i]->name));
    for (size_t i = 0; tri_tests[i]; i++)
        assert_true(is_named(name, "members.", tri_tests[i]->name));
    for (size_t i = 0; tri_stores[i]; i++)
        assert_true(is_named(name, "store.", tri_stores[i]->name));
    for (size_t i = 0; layouts_all[i]; i++)
        assert_true(is_named(name, "layout.", layouts_all[i]->name));
    /* Places of members that no table has yet share the name "more". */
    for (uint32_t a = 0; a < coverage_known(); a++)
        for (uint32_t b = 0; b < a; b++)
            if (!strstr(name[a], "more"))
                assert_string_not_equal(name[a], name[b]);
    assert_false(coverage_name(UINT32_MAX, name[0]));
}

static void maps_are_merged_and_counted(void **state)
{
    (void)state;
    uint64_t all[COVERAGE_WORDS] = {1, 0, 0, 1}, one[COVERAGE_WORDS] = {3, 0, 1u << 5, 1};
    assert_int_equal(coverage_count(one), 4);
    assert_int_equal(coverage_merge(all, one), 2);
    assert_int_equal(coverage_merge(all, one), 0);
    assert_int_equal(coverage_count(all), 4);
}

static void answers_and_verdicts(void **state)
{
    (void)state;
    static const struct {
        enum query query;
        struct judgement judgement;
        const char *expected;
    } row[] = {
        {QUERY_CLOSEST, {.verdict = VERDICT_RIGHT}, "verdict.closest.right error.0"},
        {QUERY_ANY, {.verdict = VERDICT_TIE, .over = 0.3}, "verdict.any.tie error.-0.5"},
        {QUERY_ANY,
         {.verdict = VERDICT_WRONG, .wrong = WRONG_ORDER, .over = 2},
         "verdict.any.wrong wrong.order error.1-"},
        {QUERY_CLOSEST,
         {.verdict = VERDICT_BOUNDARY, .displacement = 5},
         "verdict.closest.boundary error.0 displacement.-16"},
    };
    char text[1024];
    for (size_t i = 0; i < ARRAY_COUNT(row); i++) {
        uint64_t map[COVERAGE_WORDS] = {0};
        coverage_add_answer(map, row[i].query, &row[i].judgement);
        print_map(map, text, sizeof text);
        assert_string_equal(text, row[i].expected);
    }
    uint64_t map[COVERAGE_WORDS] = {0};
    coverage_add_verdicts(map, 1u << VERDICT_TIE);
    assert_int_equal(coverage_count(map), 0);
    coverage_add_verdicts(map, 1u << VERDICT_TIE | 1u << VERDICT_RIGHT | 1u << VERDICT_WRONG);
    print_map(map, text, sizeof text);
    assert_string_equal(text, "both.right.tie both.right.wrong both.tie.wrong");
}

static void rays_and_truth(void **state)
{
    (void)state;
    const struct box root = {{-1, -1, -1}, {1, 1, 1}};
    static const struct {
        struct ray ray;
        struct oracle_answer truth;
        const char *expected;
    } row[] = {
        {{{0, 0, 0}, 0, {0, 0, 1}, 1e30f},
         {.prim = ABI_NO_PRIM, .class = ORACLE_MISS},
         "truth.miss ray.one_axis ray.from_inside"},
        {{{0, 0, -1}, 0, {-0.0f, 1, 0x1p-140f}, INFINITY},
         {.prim = 3,
          .class = ORACLE_VERTEX,
          .tie_count = 6,
          .t_lo = 1,
          .t_hi = 1,
          .t_next = 9,
          .flags = ORACLE_SAW_EXACT | ORACLE_SAW_IN_PLANE},
         "truth.vertex truth.saw_plane truth.by_integers ties.5-8 ray.out_of_contract "
         "ray.parallel ray.minus_zero ray.subnormal ray.on_face ray.endless"},
        {{{5, 0, 0}, 1, {0x1p30f, 1, 1}, 1},
         {.prim = 0, .class = ORACLE_INSIDE, .tie_count = 1, .t_lo = 1, .t_hi = 1, .t_next = 1},
         "truth.inside truth.on_tmin truth.on_tmax truth.close_next ray.point ray.fast"},
        {{{5, NAN, 0}, 1, {1, 1, 1}, 0},
         {.prim = ABI_NO_PRIM, .flags = ORACLE_REFUSED},
         "truth.miss truth.refused ray.out_of_contract ray.nan ray.backward"},
        {{{5, 0, 0}, 0, {0, -0.0f, 0}, 1},
         {.prim = ABI_NO_PRIM},
         "truth.miss ray.out_of_contract ray.minus_zero ray.zero"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(row); i++) {
        uint64_t map[COVERAGE_WORDS] = {0};
        char text[1024];
        coverage_add_truth(map, &row[i].ray, &root, &row[i].truth);
        print_map(map, text, sizeof text);
        assert_string_equal(text, row[i].expected);
    }
}

/* The bit agrees with ray_in_contract on every kind of ray. */
static void out_of_contract_is_what_the_library_says(void **state)
{
    (void)state;
    uint32_t out = 0, all = 0;
    for (uint32_t i = 0; i < 400; i++) {
        struct fuzz_trial trial = trial_of(89, i, &ordinary);
        struct box root = scene_bounds(&trial.scene);
        struct rng rng = rng_make(97, i);
        for (uint32_t r = 0; r < trial.ray_count; r++) {
            struct ray ray = trial.ray[r];
            struct oracle_answer miss = {.prim = ABI_NO_PRIM};
            uint64_t map[COVERAGE_WORDS] = {0};
            if (r % 4 == 0) /* to the ends of the contract */
                ray.dir[rng_below(&rng, 3)] *= ldexpf(1, (int)rng_below(&rng, 130) - 65);
            if (r % 8 == 1)
                ray.org[rng_below(&rng, 3)] = ldexpf(1.0f + rng_float(&rng), 39 + (int)(r % 3));
            coverage_add_truth(map, &ray, &root, &miss);
            bool is_out =
                map[COVERAGE_RAY / 64] >> COVERAGE_RAY % 64 & 1; /* COVERAGE_RAY_OUT is 0 */
            assert_int_equal(is_out, !ray_in_contract(&ray));
            out += is_out;
            all++;
        }
        fuzz_trial_free(&trial);
    }
    assert_true(out > all / 50 && out < all / 2);
}

static void trees_and_bytes(void **state)
{
    (void)state;
    static const struct {
        uint32_t n, leaf;
        float x, z;
        const char *layout, *expected;
    } row[] = {
        {1, 4, 1, 0.3f, "f32",
         "depth.0 leaf.1 members.median.robust.mt scale.-2^0 shape.single shape.flat stack.0 "
         "store.indexed layout.f32"},
        {4, 1, 3, 2, "rf16",
         "depth.2 leaf.1 members.median.robust.mt scale.-2^10 shape.flat shape.same_boxes stack.2 "
         "half.zero half.no_width half.power_of_two store.indexed layout.rf16"},
        {9, 9, 3, 3, "rf16",
         "depth.0 leaf.9-15 members.median.robust.mt scale.-2^10 shape.single shape.flat "
         "refused.rf16.leaf store.indexed"},
        {2, 2, 1e5f, 3, "rf16",
         "depth.0 leaf.2 members.median.robust.mt scale.-2^24 shape.single shape.flat "
         "refused.rf16.bounds store.indexed"},
        {2, 2, 1e5f, 0x1p-20f, "rtrs_rf",
         "depth.0 leaf.2 members.median.robust.mt scale.-2^24 shape.single shape.flat stack.0 "
         "half.infinite half.subnormal half.zero half.no_width store.indexed layout.rtrs_rf"},
        {2, 2, 65504, 0x1.004p-14f, "rf16",
         "depth.0 leaf.2 members.median.robust.mt scale.-2^16 shape.single shape.flat stack.0 "
         "half.65504 half.zero half.no_width store.indexed layout.rf16"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(row); i++) {
        struct fuzz_trial trial = copies(row[i].n, row[i].x, row[i].z, row[i].leaf);
        uint64_t map[COVERAGE_WORDS] = {0};
        char text[1024];
        add_all(map, &trial, row[i].layout);
        print_map(map, text, sizeof text);
        assert_string_equal(text, row[i].expected);
        fuzz_trial_free(&trial);
    }
    uint64_t map[COVERAGE_WORDS] = {0};
    char text[256];
    coverage_add_motion(map, false);
    print_map(map, text, sizeof text);
    assert_string_equal(text, "tree.refitted");
    coverage_add_motion(map, true);
    print_map(map, text, sizeof text);
    assert_string_equal(text, "tree.refitted tree.rebuilt");
}

static void numbers_beside_limits(void **state)
{
    (void)state;
    static const struct {
        uint32_t n, leaf;
        const char *expected;
    } row[] = {
        {10923, 1, NULL},
        {10924, 1, "count.records_32769-"},
        {32767, 8, "count.items_32767"},
        {32768, 8, "count.items_32768"},
        {65535, 8, "count.items_65535"},
        {65536, 8, "count.items_65536"},
        {65537, 8, "count.items_65537-"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(row); i++) {
        struct fuzz_trial trial = copies(row[i].n, 1, 1, row[i].leaf);
        uint64_t map[COVERAGE_WORDS] = {0};
        add_all(map, &trial, "rf16");
        if (row[i].expected)
            assert_true(has(map, row[i].expected));
        else
            assert_false(has(map, "count.records_32767"));
        assert_int_equal(has(map, "refused.rf16.records"), row[i].n == 10924);
        assert_int_equal(has(map, "refused.rf16.indices"), row[i].n == 65537);
        fuzz_trial_free(&trial);
    }
}

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
    static const struct gen_options options = {
        .triangles_least = 16, .triangles_most = 64, .rays = 200, .faithful = true};
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
        cmocka_unit_test(every_bit_has_a_name_of_its_own),
        cmocka_unit_test(maps_are_merged_and_counted),
        cmocka_unit_test(answers_and_verdicts),
        cmocka_unit_test(rays_and_truth),
        cmocka_unit_test(out_of_contract_is_what_the_library_says),
        cmocka_unit_test(trees_and_bytes),
        cmocka_unit_test(numbers_beside_limits),
        cmocka_unit_test(a_deep_tree_and_a_cut_box),
        cmocka_unit_test(trials_reach_much_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
