/* Laws of ref/fast/, of all forms of trees: every kernel answers as the tests on all triangles
 * do. */
#include "tests/fast/fast_fixture.h"

#define RAYS 1600
#define TIED 40u /* rounds, and triangles less 6 */
#define SAME 20u /* rays: enough for every way to trace them */

static void check_scene(struct scene *scene, uint64_t seed)
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

/* Kernels leave rays of very long and very short directions to the careful way. */
static void the_length_of_directions_changes_nothing(void **state)
{
    (void)state;
    struct scene scene = make_scene("sphere", 5);
    struct fast_tree tree = make_tree(&scene, 4);
    struct ray ray[300];
    struct hit hit;
    size_t hits = 0;
    make_rays("mixed", &scene, 3, ARRAY_COUNT(ray), ray);
    for (size_t i = 0; i < ARRAY_COUNT(ray); i++) {
        for (int k = 0; k < 3; k++)
            ray[i].dir[k] = ldexpf(ray[i].dir[k], 50 * ((int)(i % 3) - 1));
        ray[i].tmax = INFINITY;
        trace_brute(&scene, woop(), QUERY_CLOSEST, &ray[i], &hit);
        hits += i % 3 != 1 && hit.prim != ABI_NO_PRIM;
    }
    assert_true(hits > 20);
    check_rays(&tree, &scene, ray, ARRAY_COUNT(ray));
    fast_free(&tree);
    scene_free(&scene);
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
        for (size_t k = 0; kernels()[k]; k++) {
            if (!kernels()[k]->runs())
                continue;
            kernels()[k]->closest(&tree, &ray, 1, &hit[1]);
            assert_true(same(&hit[0], &hit[1]));
            kernels()[k]->any(&tree, &ray, 1, &hit[1]);
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
            for (size_t k = 0; kernels()[k]; k++) {
                if (!kernels()[k]->runs())
                    continue;
                kernels()[k]->closest(&tree, &ray, 1, &hit);
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
    struct ray ray[SAME];
    for (size_t i = 0; i < SAME; i++)
        ray[i] = (struct ray){.org = {0, 0, -64}, .dir = {0, 0, 1}, .tmax = RAY_TMAX};
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
        for (size_t k = 0; kernels()[k]; k++)
            for (int way = 0; way < TREE_WAYS && kernels()[k]->runs(); way++) {
                struct hit hit[SAME], watched;
                set_way(&tree, way);
                fast_careful(&tree, ray, false, &watched);
                kernels()[k]->closest(&tree, ray, SAME, hit);
                assert_true(watched.t == 64);
                for (size_t i = 0; i < SAME; i++)
                    assert_memory_equal(&hit[i], &watched, sizeof watched);
            }
        fast_free(&tree);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_answer_as_all_triangles_do),
        cmocka_unit_test(scale_changes_nothing),
        cmocka_unit_test(the_length_of_directions_changes_nothing),
        cmocka_unit_test(far_and_flat_scenes_lose_nothing),
        cmocka_unit_test(rays_out_of_contract_end),
        cmocka_unit_test(closed_meshes_stay_closed),
        cmocka_unit_test(all_hits_are_those_of_all_triangles),
        cmocka_unit_test(the_nearest_child_is_visited_first),
    };
    int failed = 0;
    for (size_t i = 0; i < ARRAY_COUNT(fast_forms); i++) {
        tested = &fast_forms[i];
        failed += cmocka_run_group_tests_name(tested->name, tests, NULL, NULL);
    }
    return failed;
}
