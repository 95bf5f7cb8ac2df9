/* Members of the grid family over scenes that press on their frames. */
#include "tests/tree/grid_fixture.h"

/* Moves and scales a random soup; the last are flat, a point, and few triangles. */
static const struct pressed {
    const char *what;
    float centre, size;
    uint32_t count;
} pressed[] = {
    {"unit", 0, 1, 60},
    {"far", 1e30f, 1e24f, 60},
    {"huge", 0, 0x1p100f, 60},
    {"tiny", 0, 0x1p-100f, 60},
    {"subnormal", 0, 1e-39f, 60},
    {"beside 0", 2e-38f, 2e-38f, 60},
    {"offset", 1e4f, 1, 60},
    {"a point", -7.3f, 0, 9},
    {"zero", 0, 0, 5},
    {"one", 3, 1, 1},
    {"two", -3, 1, 2},
    {"coarse", 1e30f, 1e23f, 60},
    {"ends", 0, 0x1.8p125f, 60},
    {"halves' end", 0, 65000, 60},
    {"slow", 0, 1, 400},
};

static struct scene press(const struct pressed *p, struct rng *rng)
{
    struct scene scene = trees_grid(p->count);
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t c = 0; c < 3; c++)
            for (uint32_t k = 0; k < 3; k++) {
                float *x = &scene.vertex[9 * i + 3 * c + k];
                bool flat = k == 1 && p->count == 400;
                *x = flat ? -0.0f : p->centre + p->size * rng_range(rng, -1, 1);
                if (c > 0 && !flat) /* triangles of a tenth */
                    *x = scene.vertex[9 * i + k] * 0.9f + *x * 0.1f;
            }
    return scene;
}

static struct bvh tree_of(const struct scene *scene, uint32_t leaf)
{
    struct bvh bvh;
    const struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    assert_int_equal(builder_find("median")->build(scene, &options, &bvh, NULL), STATUS_OK);
    return bvh;
}

static bool is_grid(const struct layout *layout)
{
    return strncmp(layout_shader(layout), "grid", 4) == 0;
}

static void check_subnormals(const struct packed *packed)
{
    for (uint32_t ref = packed->root; ref < packed->ref_count; ref++) {
        struct wide node;
        if (ref >= packed->node_count)
            break;
        packed->layout->load(packed, ref, &node);
        for (uint32_t i = 0; i < node.child_count; i++)
            for (int k = 0; k < 3; k++)
                if (is_subnormal((double)node.box[i].lo[k]) ||
                    is_subnormal((double)node.box[i].hi[k]) || !isfinite(node.box[i].lo[k]) ||
                    !isfinite(node.box[i].hi[k]))
                    fail_msg("%s: record %u: bounds [%a, %a]", packed->layout->name, ref,
                             (double)node.box[i].lo[k], (double)node.box[i].hi[k]);
    }
}

static void members_hold_scenes_or_say_why_not(void **state)
{
    (void)state;
    struct rng rng = rng_make(14, 0);
    for (size_t s = 0; s < ARRAY_COUNT(pressed); s++) {
        struct scene scene = press(&pressed[s], &rng);
        struct bvh bvh = tree_of(&scene, 1 + (uint32_t)s % 5);
        size_t refused = 0;
        for (size_t l = 0; layouts_all[l]; l++) {
            const struct layout *layout = layouts_all[l];
            struct packed packed;
            struct reason reason = {""};
            if (!is_grid(layout))
                continue;
            enum status status = packed_make(layout, &bvh, &scene, &packed, &reason);
            if (status) {
                assert_int_equal(status, STATUS_LIMIT);
                assert_non_null(strstr(reason.text, "at most 65504 in magnitude, the tree has "));
                assert_non_null(strstr(layout->name, "f16_world"));
                refused++;
                continue;
            }
            if (packed_check(&packed, &scene, NULL, &reason))
                fail_msg("%s: %s", pressed[s].what, reason.text);
            check_subnormals(&packed);
            assert_int_equal(packed.word_count, packed.node_count * layout->node_bytes / 4);
            packed_free(&packed);
        }
        assert_int_equal(refused, pressed[s].size > 66000 ? 3 : 0);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

static void members_refuse_what_no_frame_holds(void **state)
{
    (void)state;
    struct scene scene = trees_grid(4);
    scene.vertex[3] = 0x1.8p126f;
    struct bvh bvh = tree_of(&scene, 1);
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct reason reason = {""};
        if (!is_grid(layouts_all[l]))
            continue;
        const char *name = layouts_all[l]->name;
        enum status status = packed_make(layouts_all[l], &bvh, &scene, &packed, &reason);
        bool whole_range = strstr(name, "bf16_world") || strstr(name, "f32_world");
        assert_int_equal(status, whole_range ? STATUS_OK : STATUS_LIMIT);
        if (status)
            assert_non_null(strstr(reason.text, " in magnitude, the tree has 1.27605888e+38; "));
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* The closest hits are those of brute force, but for a tie's triangle. */
static void members_find_what_brute_force_finds(void **state)
{
    (void)state;
    struct rng rng = rng_make(15, 0);
    const struct pressed soup = {"soup", 5, 3, 150};
    struct scene scene = press(&soup, &rng);
    struct bvh bvh = tree_of(&scene, 4);
    const struct tri_test *tri = tri_test_find("woop");
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct reason reason = {""};
        if (!is_grid(layouts_all[l]))
            continue;
        assert_int_equal(packed_make(layouts_all[l], &bvh, &scene, &packed, &reason), 0);
        uint32_t hits = 0;
        for (int i = 0; i < 300; i++) {
            struct ray ray = {.tmin = 0, .tmax = 1e30f};
            struct hit one, all;
            for (int k = 0; k < 3; k++) {
                const float *v = scene.vertex + 9 * (size_t)(i % 150) + k;
                ray.org[k] = rng_range(&rng, 0, 10);
                ray.dir[k] = (v[0] + v[3] + v[6]) / 3 - ray.org[k];
            }
            trace_brute(&scene, tri, QUERY_CLOSEST, &ray, &all);
            assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                     .packed = &packed,
                                                     .box = box_test_find("watertight"),
                                                     .tri = tri,
                                                     .query = QUERY_CLOSEST},
                                       &ray, &one, NULL),
                             STATUS_OK);
            hits += all.prim != ABI_NO_PRIM;
            if ((one.prim == ABI_NO_PRIM) != (all.prim == ABI_NO_PRIM) || one.t != all.t)
                fail_msg("%s: ray %d: triangle %u at %a, not %u at %a", layouts_all[l]->name, i,
                         one.prim, (double)one.t, all.prim, (double)all.t);
        }
        assert_int_equal(hits, 300);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Triangles one behind the other, seen from both ends: the nearest is found, after at most the
 * leaves of two nodes. */
static void nearest_child_is_visited_first(void **state)
{
    (void)state;
    for (uint32_t count = 1; count <= 32; count++) {
        struct scene scene = trees_grid(count);
        for (uint32_t i = 0; i < 9 * count; i++) {
            const float corner[3][2] = {{-1, -1}, {1, -1}, {0, 1}};
            scene.vertex[i] = i % 3 < 2 ? corner[i / 3 % 3][i % 3] : (float)(i / 9);
        }
        struct bvh bvh = tree_of(&scene, 1);
        for (int from = 0; from < 2; from++) {
            const struct ray ray = {{0, 0, from ? 100 : -100}, 0, {0, 0, from ? -1 : 1}, 1e30f};
            struct packed packed;
            struct trace_counts counts = {0};
            struct hit hit;
            assert_int_equal(packed_make(layout_find("bvh8_u8_node"), &bvh, &scene, &packed, NULL),
                             STATUS_OK);
            assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                     .packed = &packed,
                                                     .box = box_test_find("watertight"),
                                                     .tri = tri_test_find("woop"),
                                                     .query = QUERY_CLOSEST},
                                       &ray, &hit, &counts),
                             STATUS_OK);
            assert_int_equal(hit.prim, from ? count - 1 : 0);
            assert_in_range(counts.tris, 1, 2 * GRID_LEAF_MOST);
            packed_free(&packed);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Ends, without reading outside anything, on any words. */
static void members_survive_garbage(void **state)
{
    (void)state;
    struct rng rng = rng_make(16, 0);
    struct scene scene = trees_grid(30);
    struct bvh bvh = tree_of(&scene, 2);
    for (size_t l = 0; layouts_all[l]; l++)
        for (int round = 0; round < 20 && is_grid(layouts_all[l]); round++) {
            struct packed packed;
            struct hit hit;
            assert_int_equal(packed_make(layouts_all[l], &bvh, &scene, &packed, NULL), 0);
            for (uint32_t i = 0; i < packed.word_count; i++)
                if (round % 2 || rng_below(&rng, 8) == 0)
                    packed.word[i] = (uint32_t)rng_u64(&rng) & (round % 3 ? 0x87078707u : ~0u);
            assert_int_equal(packed_check(&packed, &scene, NULL, NULL), STATUS_INPUT);
            const struct ray ray = {{0.1f, 0.1f, 5}, 0, {0.01f, 0.02f, -1}, 1e30f};
            enum status status = trace_ray(&(struct job){.scene = &scene,
                                                         .packed = &packed,
                                                         .box = box_test_find("robust"),
                                                         .tri = tri_test_find("mt"),
                                                         .query = QUERY_CLOSEST},
                                           &ray, &hit, NULL);
            assert_true(status == STATUS_OK || status == STATUS_LIMIT);
            packed_free(&packed);
        }
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_hold_scenes_or_say_why_not),
        cmocka_unit_test(members_refuse_what_no_frame_holds),
        cmocka_unit_test(members_find_what_brute_force_finds),
        cmocka_unit_test(nearest_child_is_visited_first),
        cmocka_unit_test(members_survive_garbage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
