/* What a traversal reads: the lines of small trees that are known by hand; and that watching
 * changes no answer. */
#include "bench/measure/shadow_rays.h"
#include "bench/measure/touch.h"
#include "scenes/rays/rays.h"
#include "tests/support/tree_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/trace_fixture.h"
#include "ref/store.h"

#include <math.h>

#define RAYS 500

static const struct cache_size large[CACHE_SIM_LEVELS] = {{1024, 64}, {1, 1}};

struct watching {
    struct cache_sim cache;
    struct packed packed;
    struct touch touch;
    struct job job;
};

static void watch(struct watching *w, const char *layout, const char *store, bool gathered,
                  const struct bvh *bvh, const struct scene *scene)
{
    struct reason reason = {""};
    if (cache_sim_make(large, &w->cache, &reason) ||
        packed_make_stored(layout_find(layout), tri_store_find(store), bvh, scene, &w->packed,
                           &reason) ||
        touch_make(&w->packed, scene, gathered, &w->cache, &w->touch, &reason))
        fail_msg("%s %s: %s", layout, store, reason.text);
    w->job = (struct job){.scene = scene,
                          .box = box_test_find("watertight"),
                          .tri = tri_test_find("woop"),
                          .query = QUERY_CLOSEST};
}

static void unwatch(struct watching *w)
{
    touch_free(&w->touch);
    packed_free(&w->packed);
    cache_sim_free(&w->cache);
}

/* 4 copies of a triangle in one leaf: a node, 4 items of 4 bytes, 4 times 12 bytes of indices, and
 * 36 bytes of vertices; the node is one line, the items one, indices one, vertices one. */
static void one_leaf_is_a_line_of_each_array(void **state)
{
    (void)state;
    const float v[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    const struct ray ray = {.org = {0, 0, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    struct scene scene = trees_copies(4, v);
    struct bvh bvh = median(&scene, 4);
    struct watching w;
    struct hit hit;
    watch(&w, "f32", "indexed", false, &bvh, &scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, &ray, &hit), STATUS_OK);
    assert_int_equal(hit.prim, 0);
    /* the node's box, and the node; of each triangle an item, indices and three vertices */
    assert_int_equal(w.cache.counts.lines, 2 + 4 * 5);
    assert_int_equal(w.cache.counts.beyond[0], 4);
    unwatch(&w);
    watch(&w, "f32", "indexed", true, &bvh, &scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, &ray, &hit), STATUS_OK);
    /* 36 bytes each: 144 bytes from the first on are three lines, the second and fourth straddle */
    assert_int_equal(w.cache.counts.lines, 2 + 4 * 2 + 2);
    assert_int_equal(w.cache.counts.beyond[0], 1 + 1 + 3);
    unwatch(&w);
    /* Four triangles of 36 bytes and their numbers, 160 bytes: three lines at once. */
    watch(&w, "f32", "gathered", false, &bvh, &scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, &ray, &hit), STATUS_OK);
    assert_int_equal(w.packed.item_count, 40);
    assert_int_equal(w.cache.counts.lines, 2 + 3);
    unwatch(&w);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Two triangles over four vertices in a block of 3 + 12 + 2 words: the last begins a line. */
static void all_words_of_a_block_are_read(void **state)
{
    (void)state;
    static const float corner[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const struct ray ray = {.org = {0.5f, 0.25f, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    struct scene scene;
    assert_int_equal(scene_make(4, 2, &scene), STATUS_OK);
    memcpy(scene.vertex, corner, sizeof corner);
    memcpy(scene.index, index, sizeof index);
    struct bvh bvh = median(&scene, 4);
    struct watching w;
    struct hit hit;
    watch(&w, "f32", "compact", false, &bvh, &scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, &ray, &hit), STATUS_OK);
    assert_true(hit.t == 2);
    assert_int_equal(w.packed.item_count, 17);
    assert_int_equal(w.cache.counts.lines, 2 + 2);
    unwatch(&w);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* The root of amd64 is of float32, two records; its leaf is decoded from there once more. */
static void records_that_are_two_are_read_as_two(void **state)
{
    (void)state;
    const float v[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    const struct ray ray = {.org = {0, 0, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    struct scene scene = trees_copies(4, v);
    struct bvh bvh = median(&scene, 4);
    struct watching w;
    struct hit hit;
    watch(&w, "amd64", "indexed", false, &bvh, &scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, &ray, &hit), STATUS_OK);
    assert_int_equal(hit.prim, 0);
    assert_int_equal(w.cache.counts.lines, 2 + 2 + 4 * 5);
    assert_int_equal(w.cache.counts.beyond[0], 2 + 3);
    unwatch(&w);
    bvh_free(&bvh);
    scene_free(&scene);
}

static uint64_t lines_of(const char *layout, const struct bvh *bvh, const struct scene *scene,
                         const struct ray *ray, uint64_t *cold)
{
    struct watching w;
    struct hit hit;
    const char *store = layout_find(layout)->item ? "indexed" : "gathered";
    watch(&w, layout, store, false, bvh, scene);
    assert_int_equal(touch_ray(&w.touch, &w.job, ray, &hit), STATUS_OK);
    uint64_t lines = w.cache.counts.lines;
    *cold = w.cache.counts.beyond[0];
    unwatch(&w);
    return lines;
}

/* Two triangles side by side, a root and two leaves. In f32 a box is read where its node lies: the
 * root's, then those of both leaves, whatever the ray meets; in a wide layout the root has them. */
static void a_box_is_read_where_it_lies(void **state)
{
    (void)state;
    static const float corner[6][3] = {{-3, 0, 0}, {-2, 0, 0}, {-2, 1, 0},
                                       {2, 0, 0},  {3, 0, 0},  {3, 1, 0}};
    static const uint32_t index[6] = {0, 1, 2, 3, 4, 5};
    const struct ray past = {.org = {0, 9, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    const struct ray between = {.org = {0, 0.5f, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    const struct ray one = {.org = {-2.25f, 0.25f, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    struct scene scene;
    uint64_t cold;
    assert_int_equal(scene_make(6, 2, &scene), STATUS_OK);
    memcpy(scene.vertex, corner, sizeof corner);
    memcpy(scene.index, index, sizeof index);
    struct bvh bvh = median(&scene, 1);
    assert_int_equal(bvh.node_count, 3);
    assert_int_equal(lines_of("f32", &bvh, &scene, &past, &cold), 1);
    assert_int_equal(lines_of("f32", &bvh, &scene, &between, &cold), 2 + 2);
    assert_int_equal(cold, 2); /* three records of 32 bytes */
    /* the leaf, and its words: three vertices and a number */
    assert_int_equal(lines_of("f32", &bvh, &scene, &one, &cold), 2 + 2 + 1 + 1);
    assert_int_equal(cold, 2 + 1);
    assert_int_equal(lines_of("bvh4_f32_world", &bvh, &scene, &past, &cold), 0);
    assert_int_equal(cold, 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Answers are trace_ray's; in a cache that holds everything no more lines are missed than the tree
 * and the scene have. */
static void watching_changes_no_answer(void **state)
{
    (void)state;
    static const char *const layout[] = {"f32",   "rf16",  "bvh8_u8_node", "cwbvh80",
                                         "tiny8", "amd64", "half4"};
    static struct ray ray[RAYS];
    struct scene scene = generated("sphere:n=8");
    struct bvh bvh = median(&scene, 1);
    assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 3, RAYS, ray, NULL), STATUS_OK);
    for (size_t l = 0; l < ARRAY_COUNT(layout); l++) {
        struct watching w;
        watch(&w, layout[l], "indexed", false, &bvh, &scene);
        size_t hits = 0;
        for (size_t i = 0; i < RAYS; i++) {
            struct hit plain, watched;
            assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                     .packed = &w.packed,
                                                     .box = w.job.box,
                                                     .tri = w.job.tri,
                                                     .query = QUERY_CLOSEST},
                                       &ray[i], &plain, NULL),
                             STATUS_OK);
            assert_int_equal(touch_ray(&w.touch, &w.job, &ray[i], &watched), STATUS_OK);
            assert_memory_equal(&plain, &watched, sizeof plain);
            hits += plain.prim != ABI_NO_PRIM;
        }
        uint64_t all = packed_node_bytes(&w.packed) + packed_item_bytes(&w.packed) +
                       12 * ((uint64_t)scene.vertex_count + scene.tri_count);
        assert_in_range(hits, RAYS / 10, RAYS);
        assert_in_range(w.cache.counts.beyond[0], all / CACHE_SIM_LINE / 4,
                        all / CACHE_SIM_LINE + 8);
        unwatch(&w);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* The same of the trees of the fast engines: the kernels' hits, and no more lines than they
 * have. */
static void check_watched(const struct fast_form *form)
{
    const struct fast_kernel *best = form->kernel();
    static struct ray ray[RAYS];
    static struct fast_tree tree;
    struct scene soup = generated("soup:n=900"), scene;
    struct quantised quantised;
    struct reason reason;
    struct cache_sim cache;
    assert_int_equal(scene_quantise(&soup, 16, &scene, &quantised, &reason), STATUS_OK);
    struct bvh bvh = median(&scene, 1);
    assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 3, RAYS, ray, NULL), STATUS_OK);
    assert_int_equal(form->make(&bvh, &scene, &tree, &reason), STATUS_OK);
    assert_int_equal(cache_sim_make(large, &cache, &reason), STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) {
        struct hit kernel, watched;
        best->closest(&tree, &ray[i], 1, &kernel);
        touch_fast(&tree, &ray[i], false, &cache, &watched);
        assert_int_equal(kernel.prim, watched.prim);
    }
    uint64_t all = fast_bytes(&tree) / CACHE_SIM_LINE;
    assert_in_range(cache.counts.beyond[0], all / 4, all + 2);
    cache_sim_free(&cache);
    fast_free(&tree);
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&soup);
}

static void watching_fast_changes_no_answer(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(fast_forms); i++)
        check_watched(&fast_forms[i]);
}

/* --- shadow rays ------------------------------------------------------------------------------ */

/* On a square that faces the eye, with the light behind the eye: no shadow ray is blocked. */
static void add_lines(void *lines, uint32_t word, uint32_t words)
{
    *(uint64_t *)lines += (word + words - 1) / 16 - word / 16 + 1;
}

/* Five copies of a triangle, a leaf each: 4 nodes of 12 bytes and 5 of 8, in two lines, and all are
 * read; of each triangle an item, indices and three vertices. */
static void words_of_a_dual_split_tree_are_read(void **state)
{
    (void)state;
    const float v[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    const struct ray ray = {.org = {0, 0, -2}, .dir = {0, 0, 1}, .tmax = TMAX};
    struct scene scene = trees_copies(5, v);
    struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
    struct watching w;
    struct dual_tree tree;
    struct hit hit;
    uint64_t lines = 0;
    watch(&w, "f32", "indexed", false, &bvh, &scene);
    assert_int_equal(dual_make(&w.packed, DUAL_BY_COST, &tree, NULL), STATUS_OK);
    assert_int_equal(dual_node_bytes(&tree), 4 * 12 + 5 * 8);
    touch_dual(&w.touch, &tree, &w.job, &ray, &hit);
    assert_int_equal(hit.t, 2);
    w.job.packed = &w.packed;
    (void)dual_watched(&tree, &w.job, &ray, add_lines, &lines);
    assert_int_equal(w.cache.counts.lines, lines + 5 * 5);
    assert_int_equal(w.cache.counts.beyond[0], 2 + 1 + 1 + 1);
    dual_free(&tree);
    unwatch(&w);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void shadow_rays_begin_before_the_surface(void **state)
{
    (void)state;
    struct scene scene = generated("grid:n=4,height=0");
    struct box box = scene_bounds(&scene);
    struct ray ray[64], out[64];
    struct hit hit[64];
    struct reason reason;
    size_t hits = 0;
    for (size_t i = 0; i < 64; i++) {
        /* Above the middle of the square, or far beside it, down the axis that it is flat in. */
        ray[i] = (struct ray){.tmax = TMAX};
        for (int k = 0; k < 3; k++) {
            bool flat = box.lo[k] == box.hi[k];
            float at = box.lo[k] + (box.hi[k] - box.lo[k]) * (0.1f + 0.0125f * (float)i);
            ray[i].org[k] = flat ? 3 : i % 2 ? at : box.hi[k] + 5;
            ray[i].dir[k] = flat ? -2 : 0;
        }
        trace_brute(&scene, tri_test_find("woop"), QUERY_CLOSEST, &ray[i], &hit[i]);
        hits += hit[i].prim != ABI_NO_PRIM;
    }
    assert_int_equal(hits, 32);
    assert_int_equal(shadow_rays_make(&scene, ray, hit, 64, out, &reason), STATUS_OK);
    for (size_t i = 0; i < 64; i++) {
        struct hit any;
        trace_brute(&scene, tri_test_find("woop"), QUERY_ANY, &out[i], &any);
        assert_int_equal(any.prim, ABI_NO_PRIM);
        assert_true(out[i].tmin == 0 && out[i].tmax == 1);
        assert_memory_equal(&out[i], &out[i % 32], sizeof out[i]); /* in order, then again */
    }
    for (size_t i = 0; i < 64; i++)
        hit[i].prim = ABI_NO_PRIM;
    assert_int_equal(shadow_rays_make(&scene, ray, hit, 64, out, &reason), STATUS_INPUT);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_leaf_is_a_line_of_each_array),
        cmocka_unit_test(all_words_of_a_block_are_read),
        cmocka_unit_test(records_that_are_two_are_read_as_two),
        cmocka_unit_test(a_box_is_read_where_it_lies),
        cmocka_unit_test(watching_changes_no_answer),
        cmocka_unit_test(watching_fast_changes_no_answer),
        cmocka_unit_test(words_of_a_dual_split_tree_are_read),
        cmocka_unit_test(shadow_rays_begin_before_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
