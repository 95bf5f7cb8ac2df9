/* The watertight box test on the running driver: no leak where the robust one has many, and C's
 * bits. */
#include "ref/trace/trace.h"

#include "tests/support/gpu.h"
#include "tests/support/corridor.h"
#include "tests/support/tree_fixture.h"

#define RAYS 60000

/* Traces; returns the misses, all of which are leaks. */
static size_t leaks(struct tracer *tracer, const struct scene *scene, const struct packed *packed,
                    const char *box, const struct ray *ray, struct hit *hit)
{
    struct job job = {.scene = scene,
                      .packed = packed,
                      .box = box_test_find(box),
                      .tri = tri_test_find("woop"),
                      .query = QUERY_CLOSEST};
    struct trace_report report;
    struct reason reason = {""};
    size_t count = 0;
    gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
    gpu_must(tracer_trace(tracer, ray, RAYS, hit, &report, &reason), &reason);
    for (size_t i = 0; i < RAYS; i++) {
        struct hit expected;
        assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                 .packed = packed,
                                                 .box = job.box,
                                                 .tri = job.tri,
                                                 .query = job.query},
                                   &ray[i], &expected, NULL),
                         STATUS_OK);
        assert_memory_equal(&expected, &hit[i], sizeof expected);
        count += hit[i].prim == ABI_NO_PRIM;
    }
    return count;
}

static void long_corridors_are_closed(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct ray *ray = calloc(RAYS, sizeof *ray);
    struct hit *hit = calloc(RAYS, sizeof *hit);
    struct rng rng = rng_make(11, 0);
    struct scene scene = corridor_scene(2, 500.0f);
    struct bvh bvh;
    struct packed packed;
    struct reason reason = {""};
    struct build_options build = {.leaf = 1, .eps = BUILD_EPS_DEFAULT};
    assert_true(ray && hit);
    for (size_t i = 0; i < RAYS; i++)
        ray[i] = corridor_ray(&rng, 2, 0x1p-17);
    gpu_must(builder_find("median")->build(&scene, &build, &bvh, &reason), &reason);
    const char *const layout[] = {"f32", "rf16"};
    for (size_t l = 0; l < ARRAY_COUNT(layout); l++) {
        gpu_must(packed_make(layout_find(layout[l]), &bvh, &scene, &packed, &reason), &reason);
        assert_int_equal(leaks(tracer, &scene, &packed, "watertight", ray, hit), 0);
        assert_true(leaks(tracer, &scene, &packed, "robust", ray, hit) > RAYS / 200);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
    free(ray);
    free(hit);
    gpu_close_tracer(tracer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_corridors_are_closed),
    };
    return cmocka_run_group_tests_name("vulkan_watertight", tests, NULL, NULL) ? 1 : 0;
}
