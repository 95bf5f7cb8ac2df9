/* Laws of ref/fast/: every kernel answers as the tests on all triangles do. */
#include "ref/fast/block.h"
#include "ref/fast/decoded.h"
#include "ref/fast/fast.h"
#include "ref/layout.h"
#include "ref/base/rng.h"
#include "tests/support/ray_fixture.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <string.h>

#define RAYS 1600
#define TIED 40u /* rounds, and triangles less 6 */

static const struct tri_test *woop(void)
{
    return tri_test_find("woop");
}

static struct fast_tree make_tree(const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf};
    struct reason reason = {""};
    struct fast_tree tree;
    struct bvh bvh;
    assert_int_equal(builders[0]->build(scene, &options, &bvh, NULL), STATUS_OK);
    if (fast_make(&bvh, scene, &tree, &reason))
        fail_msg("%s", reason.text);
    bvh_free(&bvh);
    return tree;
}

/* The same bits; at the same t another triangle may be named. */
static bool same(const struct hit *a, const struct hit *b)
{
    if (a->prim != b->prim && a->prim != ABI_NO_PRIM && b->prim != ABI_NO_PRIM)
        return a->t == b->t;
    return memcmp(a, b, sizeof *a) == 0;
}

static void check_any(const struct scene *scene, const struct ray *ray, const struct hit *truth,
                      const struct hit *hit)
{
    float v[3][3];
    struct hit one;
    struct tri_ray r = tri_ray_make(ray);
    assert_int_equal(hit->prim == ABI_NO_PRIM, truth->prim == ABI_NO_PRIM);
    if (hit->prim == ABI_NO_PRIM)
        return;
    scene_tri(scene, hit->prim, v);
    assert_true(tri_test_run(ABI_TRI_WOOP, &r, v, &one));
    one.prim = hit->prim;
    assert_memory_equal(&one, hit, sizeof one);
}

static void check_kernel(const struct fast_kernel *kernel, const struct fast_tree *tree,
                         const struct scene *scene, const struct ray *ray, size_t count,
                         const struct hit *truth)
{
    struct hit *hit = calloc(count, sizeof *hit);
    assert_non_null(hit);
    kernel->closest(tree, ray, count, hit);
    for (size_t i = 0; i < count; i++)
        if (!same(&truth[i], &hit[i]))
            fail_msg("%s%s, ray %zu: t %a prim %d, expected t %a prim %d", kernel->name,
                     tree->in_pairs ? " in pairs" : "", i, (double)hit[i].t, (int)hit[i].prim,
                     (double)truth[i].t, (int)truth[i].prim);
    kernel->any(tree, ray, count, hit);
    for (size_t i = 0; i < count; i++)
        check_any(scene, &ray[i], &truth[i], &hit[i]);
    free(hit);
}

/* Ray by ray, and in pairs whatever the size of the tree. */
static void check_rays(struct fast_tree *tree, const struct scene *scene, const struct ray *ray,
                       size_t count)
{
    struct hit *truth = calloc(count, sizeof *truth);
    assert_non_null(truth);
    for (size_t i = 0; i < count; i++)
        trace_brute(scene, woop(), QUERY_CLOSEST, &ray[i], &truth[i]);
    for (size_t k = 0; fast_kernels[k]; k++)
        for (int pairs = 0; pairs < 2 && fast_kernels[k]->runs(); pairs++) {
            tree->in_pairs = pairs;
            check_kernel(fast_kernels[k], tree, scene, ray, count, truth);
        }
    free(truth);
}

static void check_scene(const struct scene *scene, uint64_t seed)
{
    struct ray *ray = calloc(RAYS, sizeof *ray);
    assert_non_null(ray);
    make_rays("mixed", scene, seed, RAYS, ray);
    for (uint32_t leaf = 1; leaf <= 16; leaf *= 16) {
        struct fast_tree tree = make_tree(scene, leaf);
        check_rays(&tree, scene, ray, RAYS);
        fast_free(&tree);
    }
    free(ray);
}

static void kernels_answer_as_all_triangles_do(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=400",
                                         "soup:n=1",
                                         "soup:n=2",
                                         "soup:n=9",
                                         "sphere:n=9",
                                         "grid:n=12",
                                         "platonic",
                                         "cornell",
                                         "needles:n=200",
                                         "terrain:k=4",
                                         "stack",
                                         "flake:depth=1",
                                         "soup:n=200,offset=1000"};
    for (size_t s = 0; s < ARRAY_COUNT(scenes); s++) {
        struct scene scene;
        struct reason reason = {""};
        if (scene_open(scenes[s], 1, &scene, &reason))
            fail_msg("%s", reason.text);
        check_scene(&scene, s + 1);
        scene_free(&scene);
    }
}

/* Some of these rays a kernel leaves to the careful way. */
static void scale_changes_nothing(void **state)
{
    (void)state;
    for (int scale = -30; scale <= 30; scale += 10) {
        struct scene scene = make_scene("sphere", 5);
        struct fast_tree tree;
        struct ray ray[300];
        make_rays("mixed", &scene, 3, ARRAY_COUNT(ray), ray);
        for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
            scene.vertex[i] = ldexpf(scene.vertex[i], scale);
        for (size_t i = 0; i < ARRAY_COUNT(ray); i++)
            for (int k = 0; k < 3; k++) {
                ray[i].org[k] = ldexpf(ray[i].org[k], scale);
                ray[i].dir[k] = ldexpf(ray[i].dir[k], (int)(i % 3) * scale / 2);
            }
        tree = make_tree(&scene, 4);
        check_rays(&tree, &scene, ray, ARRAY_COUNT(ray));
        fast_free(&tree);
        scene_free(&scene);
    }
}

static void far_and_flat_scenes_lose_nothing(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int far = 0; far <= 20; far += 10) {
            struct scene scene = make_scene("sphere", 5);
            struct fast_tree tree;
            struct ray ray[300];
            for (uint32_t i = 0; i < scene.vertex_count; i++) {
                scene.vertex[3 * i + (uint32_t)k] = 1;
                scene.vertex[3 * i + (uint32_t)(k + 1) % 3] += ldexpf(1, far);
            }
            make_rays("mixed", &scene, 3, ARRAY_COUNT(ray), ray);
            tree = make_tree(&scene, 4);
            check_rays(&tree, &scene, ray, ARRAY_COUNT(ray));
            fast_free(&tree);
            scene_free(&scene);
        }
}

static void rays_out_of_contract_end(void **state)
{
    (void)state;
    static const float odd[] = {0.0f, -0.0f, 1.0f, -1.0f, NAN, INFINITY, -INFINITY, 1e38f, 1e-38f};
    const uint32_t n = ARRAY_COUNT(odd);
    struct scene scene = make_scene("sphere", 4);
    struct fast_tree tree = make_tree(&scene, 4);
    uint64_t random = 1;
    for (int i = 0; i < 3000; i++) {
        struct ray ray;
        float *part[8] = {&ray.org[0], &ray.org[1], &ray.org[2], &ray.tmin,
                          &ray.dir[0], &ray.dir[1], &ray.dir[2], &ray.tmax};
        struct hit hit[2];
        for (int k = 0; k < 8; k++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            *part[k] = odd[(random >> 33) % n];
        }
        fast_careful(&tree, &ray, false, &hit[0]);
        for (size_t k = 0; fast_kernels[k]; k++) {
            if (!fast_kernels[k]->runs())
                continue;
            fast_kernels[k]->closest(&tree, &ray, 1, &hit[1]);
            assert_true(same(&hit[0], &hit[1]));
            fast_kernels[k]->any(&tree, &ray, 1, &hit[1]);
            assert_int_equal(hit[0].prim == ABI_NO_PRIM, hit[1].prim == ABI_NO_PRIM);
        }
    }
    fast_free(&tree);
    scene_free(&scene);
}

static void closed_meshes_stay_closed(void **state)
{
    (void)state;
    struct scene scene = make_scene("sphere", 12);
    struct fast_tree tree = make_tree(&scene, 4);
    for (uint32_t e = 0; e < 3 * scene.tri_count; e++) {
        const float *a = scene.vertex + 3 * (size_t)scene.index[e];
        const float *b = scene.vertex + 3 * (size_t)scene.index[e % 3 == 2 ? e - 2 : e + 1];
        for (int part = 0; part < 3; part++) {
            struct ray ray = {.org = {0.125f, -0.0625f, 0.25f}, .tmax = RAY_TMAX};
            struct hit hit;
            for (int k = 0; k < 3; k++)
                ray.dir[k] = a[k] + (b[k] - a[k]) * (float)part * 0.3f - ray.org[k];
            for (size_t k = 0; fast_kernels[k]; k++) {
                if (!fast_kernels[k]->runs())
                    continue;
                fast_kernels[k]->closest(&tree, &ray, 1, &hit);
                assert_int_not_equal(hit.prim, ABI_NO_PRIM);
            }
        }
    }
    fast_free(&tree);
    scene_free(&scene);
}

static void all_hits_are_those_of_all_triangles(void **state)
{
    (void)state;
    struct scene scene = make_scene("soup", 300);
    struct fast_tree tree = make_tree(&scene, 4);
    struct ray ray[400];
    make_rays("mixed", &scene, 5, ARRAY_COUNT(ray), ray);
    uint32_t all = 0;
    for (size_t i = 0; i < ARRAY_COUNT(ray); i++) {
        struct hit truth[300], hit[300];
        uint32_t count = trace_brute_all(&scene, woop(), &ray[i], 300, truth);
        assert_int_equal(fast_all(&tree, &ray[i], 300, hit), count);
        assert_int_equal(fast_all(&tree, &ray[i], 0, NULL), count);
        for (uint32_t a = 0; a < count; a++) {
            uint32_t b = 0;
            while (b < count && hit[b].prim != truth[a].prim)
                b++;
            assert_true(b < count);
            assert_memory_equal(&truth[a], &hit[b], sizeof hit[b]);
        }
        all += count;
    }
    assert_true(all > 100);
    fast_free(&tree);
    scene_free(&scene);
}

/* Triangles that all meet a ray in one point, in boxes that begin one after the other: the answer
 * is that of the first which was visited, so it tells the order of visits. */
static void the_nearest_child_is_visited_first(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 1);
    const struct ray ray[2] = {{.org = {0, 0, -64}, .dir = {0, 0, 1}, .tmax = RAY_TMAX},
                               {.org = {0, 0, -64}, .dir = {0, 0, 1}, .tmax = RAY_TMAX}};
    for (int round = 0; round < (int)TIED; round++) {
        struct scene scene;
        float ahead[6 + TIED];
        const uint32_t count = 6 + (uint32_t)round; /* two children, three, and more */
        assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
        for (uint32_t i = 0; i < count; i++) {
            uint32_t k = rng_below(&rng, i + 1);
            ahead[i] = ahead[k];
            ahead[k] = (float)(i + 1);
        }
        for (uint32_t i = 0; i < count; i++) {
            const float corner[9] = {-1, -1, -ahead[i], 1, -1, -ahead[i], 0, 1, ahead[i]};
            memcpy(scene.vertex + 9 * i, corner, sizeof corner);
            for (uint32_t c = 0; c < 3; c++)
                scene.index[3 * i + c] = 3 * i + c;
        }
        struct fast_tree tree = make_tree(&scene, 1);
        for (size_t k = 0; fast_kernels[k]; k++)
            for (int pairs = 0; pairs < 2 && fast_kernels[k]->runs(); pairs++) {
                struct hit hit[2], watched;
                tree.in_pairs = pairs;
                fast_careful(&tree, ray, false, &watched);
                fast_kernels[k]->closest(&tree, ray, 2, hit);
                assert_true(watched.t == 64);
                assert_memory_equal(&hit[0], &watched, sizeof watched);
                assert_memory_equal(&hit[1], &watched, sizeof watched);
            }
        fast_free(&tree);
        scene_free(&scene);
    }
}

/* --- blocks and trees
 * ----------------------------------------------------------------------------- */

static void blocks_hold_their_triangles(void **state)
{
    (void)state;
    struct scene scene = make_scene("grid", 8);
    uint32_t most = 0;
    for (uint32_t first = 0; first + BLOCK_TRIS <= scene.tri_count; first += 5) {
        struct block block;
        uint32_t prim[BLOCK_TRIS + 1], word[128];
        for (uint32_t i = 0; i <= BLOCK_TRIS; i++)
            prim[i] = (first + i * (first % 3 ? 1 : 2)) % scene.tri_count;
        assert_false(block_make(&scene, prim, BLOCK_TRIS + 1, &block));
        uint32_t count = BLOCK_TRIS;
        while (!block_make(&scene, prim, count, &block))
            count--;
        assert_true(count >= BLOCK_VERTICES / 3);
        assert_true(block_words(&block) <= ARRAY_COUNT(word));
        block_write(&block, word);
        for (uint32_t i = 0; i < count; i++) {
            float v[3][3], w[3];
            scene_tri(&scene, prim[i], v);
            assert_int_equal(block_prim(word, block.vertex_count, i), prim[i]);
            for (int c = 0; c < 3; c++) {
                block_corner(word, block.vertex_count, i, c, w);
                assert_memory_equal(v[c], w, sizeof w);
            }
        }
        most = block.vertex_count > most ? block.vertex_count : most;
    }
    assert_true(most > 8);
    scene_free(&scene);
}

static void bounds_are_conservative(void **state)
{
    (void)state;
    struct scene scene = make_scene("soup", 500);
    struct fast_tree tree = make_tree(&scene, 1);
    uint32_t leaves = 0;
    for (uint32_t n = 0; n < tree.node_count; n++)
        for (uint32_t i = 0; i < FAST_WIDTH; i++) {
            uint32_t ref = tree.node[n].ref[i];
            if (!(ref & FAST_LEAF))
                continue;
            const uint32_t *word = tree.block + (ref & (FAST_LEAF_WORDS - 1));
            uint32_t vertices = (ref >> FAST_LEAF_COUNT & 15u) + 1;
            leaves++;
            for (uint32_t v = 0; v < vertices; v++)
                for (uint32_t k = 0; k < 3; k++) {
                    double x = (double)float_from_bits(word[BLOCK_CORNERS + k * vertices + v]);
                    double lo = (double)tree.lo[k], step = (double)tree.step[k];
                    assert_true(lo + step * tree.node[n].bound[0][k][i] <= x);
                    assert_true(lo + step * tree.node[n].bound[1][k][i] >= x);
                }
        }
    assert_true(leaves > 60);
    fast_free(&tree);
    scene_free(&scene);
}

/* A soup and one triangle, of every layout that loses nothing: a sound tree with each triangle
 * once, and the hits of all triangles. */
static void every_layout_is_decoded(void **state)
{
    (void)state;
    size_t played = 0;
    for (uint32_t n = 1; n <= 120; n += 119) {
        struct scene scene = make_scene("soup", n);
        struct build_options options = {.leaf = 3};
        struct ray ray[200];
        struct bvh bvh;
        make_rays("mixed", &scene, 5, ARRAY_COUNT(ray), ray);
        assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed;
            struct fast_tree tree;
            struct bvh decoded;
            struct reason reason = {""};
            if (layouts_all[l]->faithful ||
                packed_make(layouts_all[l], &bvh, &scene, &packed, &reason))
                continue;
            if (fast_decode(&packed, &scene, &decoded, &reason) ||
                bvh_check(&decoded, &scene, &reason) || fast_make(&decoded, &scene, &tree, &reason))
                fail_msg("%s: %s", layouts_all[l]->name, reason.text);
            check_rays(&tree, &scene, ray, ARRAY_COUNT(ray));
            fast_free(&tree);
            bvh_free(&decoded);
            packed_free(&packed);
            played++;
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
    assert_true(played >= 4);
}

static void empty_and_too_deep_trees(void **state)
{
    (void)state;
    struct scene none, chain = trees_grid(1000);
    struct bvh bvh = {.node = NULL};
    struct fast_tree tree;
    struct reason reason = {""};
    struct ray ray = {.dir = {0, 0, 1}, .tmax = 1};
    struct hit hit;
    assert_int_equal(scene_make(0, 0, &none), STATUS_OK);
    assert_int_equal(fast_make(&bvh, &none, &tree, &reason), STATUS_OK);
    assert_int_equal(tree.node_count, 0);
    assert_int_equal(fast_all(&tree, &ray, 1, &hit), 0);
    fast_free(&tree);
    bvh = trees_make(&chain, 1, TREES_LEFT);
    assert_int_equal(fast_make(&bvh, &chain, &tree, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "256 entries"));
    assert_null(tree.node);
    bvh_free(&bvh);
    scene_free(&chain);
    scene_free(&none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_answer_as_all_triangles_do),
        cmocka_unit_test(scale_changes_nothing),
        cmocka_unit_test(far_and_flat_scenes_lose_nothing),
        cmocka_unit_test(rays_out_of_contract_end),
        cmocka_unit_test(closed_meshes_stay_closed),
        cmocka_unit_test(all_hits_are_those_of_all_triangles),
        cmocka_unit_test(the_nearest_child_is_visited_first),
        cmocka_unit_test(blocks_hold_their_triangles),
        cmocka_unit_test(bounds_are_conservative),
        cmocka_unit_test(every_layout_is_decoded),
        cmocka_unit_test(empty_and_too_deep_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
