/* Tracing on the running driver: its answers are C's, bit for bit, and what cannot be answered
 * fails loudly. */
#include "tests/gpu/vulkan_trace_fixture.h"

static const struct {
    const char *box, *tri;
    enum query query;
} mixes[] = {
    {"robust", "mt", QUERY_CLOSEST},
    {"robust", "woop", QUERY_ANY},
    {"rtrs", "mt_rtrs", QUERY_CLOSEST},
    {"watertight", "pluecker", QUERY_CLOSEST},
    {"robust", "baldwin_webber", QUERY_CLOSEST},
};

/* Every layout with every box and triangle test; `raydiff conform` has all combinations. */
static void trace_agrees_with_c_in_every_layout(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    for (size_t l = 0; layouts[l]; l++) {
        struct gpu_case f = fixture(layouts[l]->name, 4, RAYS);
        size_t least = layouts[l]->faithful ? 10 : RAYS / 20; /* RTRS's lose most */
        for (size_t m = 0; m < ARRAY_COUNT(mixes); m++) {
            struct job job = job_of(&f, mixes[m].box, mixes[m].tri, mixes[m].query);
            assert_true(must_agree(tracer, &f, &job) >= least);
        }
        release(&f);
    }
    gpu_close_tracer(tracer);
}

static void trace_agrees_with_c_on_full_leaves(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = fixture("rf16", 8, RAYS);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    assert_true(must_agree(tracer, &f, &job) > RAYS / 20);
    release(&f);
    gpu_close_tracer(tracer);
}

/* Zero, negative zero and tiny components, origins on box planes, ranges that end in infinity. */
static void trace_agrees_with_c_on_parallel_axes(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = fixture("f32", 4, RAYS);
    static const float component[] = {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-61f, 0x1p-59f, -0x1p-60f};
    const size_t kinds = ARRAY_COUNT(component);
    for (size_t i = 0; i < f.ray_count; i++) {
        const struct box *bounds = &f.bvh.node[i % f.bvh.node_count].bounds;
        for (size_t k = 0, rest = i; k < 3; k++, rest /= kinds) {
            f.ray[i].dir[k] = component[rest % kinds];
            f.ray[i].org[k] = i % 2 ? bounds->lo[k] : bounds->hi[(k + i) % 3];
        }
        f.ray[i].tmin = 0;
        f.ray[i].tmax = i % 3 ? HUGE_VALF : 1e30f;
    }
    for (size_t m = 0; m < ARRAY_COUNT(mixes); m++) {
        struct job job = job_of(&f, mixes[m].box, mixes[m].tri, mixes[m].query);
        (void)must_agree(tracer, &f, &job);
    }
    release(&f);
    gpu_close_tracer(tracer);
}

/* Random bits are out of contract: no promise but that every ray ends. On lavapipe, which is IEEE,
 * they agree too. */
static void trace_ends_on_random_bits(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    bool ieee = gpu_is_lavapipe(vk);
    gpu_close(vk);
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = fixture("f32", 4, RAYS);
    uint32_t word = 1;
    for (size_t i = 0; i < f.ray_count; i++)
        for (int k = 0; k < 8; k++) {
            word = word * 1664525u + 1013904223u;
            if ((word >> 8) % 3 == 0)
                ((float *)&f.ray[i])[k] = float_from_bits(word ^ word >> 15);
        }
    for (size_t m = 0; m < ARRAY_COUNT(mixes); m++) {
        struct job job = job_of(&f, mixes[m].box, mixes[m].tri, mixes[m].query);
        struct reason reason = {""};
        struct trace_report report;
        gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
        gpu_must(tracer_trace(tracer, f.ray, f.ray_count, f.got, &report, &reason), &reason);
        if (ieee)
            (void)must_agree(tracer, &f, &job);
    }
    release(&f);
    gpu_close_tracer(tracer);
}

static void trace_answers_any_number_of_rays(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    static const size_t counts[] = {0, 1, 63, 64, 65, 1000, 20000, 2};
    static const uint32_t workgroups[] = {0, 1, 100};
    for (size_t w = 0; w < ARRAY_COUNT(workgroups); w++) {
        struct tracer *tracer = gpu_tracer(&options, workgroups[w]);
        struct gpu_case f = fixture("rf16", 4, 20000);
        struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
        for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
            f.ray_count = counts[i];
            (void)must_agree(tracer, &f, &job);
        }
        assert_int_equal(tracer_pipelines(tracer), 1);
        release(&f);
        gpu_close_tracer(tracer);
    }
}

static void trace_through_staging_agrees(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    options.staging = true;
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = fixture("f32", 4, RAYS);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    assert_true(must_agree(tracer, &f, &job) > RAYS / 20);
    release(&f);
    gpu_close_tracer(tracer);
}

static void trace_under_validation_says_nothing(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    options.validate = true;
    for (int staging = 0; staging < 2; staging++) {
        options.staging = staging;
        struct tracer *tracer = gpu_tracer(&options, 0);
        struct gpu_case f = fixture("rf16", 4, 200);
        struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
        (void)must_agree(tracer, &f, &job);
        release(&f);
        gpu_close_tracer(tracer); /* fails on any message */
    }
}

static void trace_of_an_empty_scene_misses(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct scene scene;
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    struct gpu_case f = pack(scene, (struct bvh){0}, "f32", 1);
    f.ray[0] = (struct ray){{0, 0, 0}, 0, {1, 0, 0}, 1};
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    assert_int_equal(must_agree(tracer, &f, &job), 0);
    assert_int_equal(f.got[0].prim, ABI_NO_PRIM);
    assert_int_equal(float_bits(f.got[0].t), 0);
    release(&f);
    gpu_close_tracer(tracer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trace_agrees_with_c_in_every_layout),
        cmocka_unit_test(trace_agrees_with_c_on_full_leaves),
        cmocka_unit_test(trace_agrees_with_c_on_parallel_axes),
        cmocka_unit_test(trace_ends_on_random_bits),
        cmocka_unit_test(trace_answers_any_number_of_rays),
        cmocka_unit_test(trace_through_staging_agrees),
        cmocka_unit_test(trace_under_validation_says_nothing),
        cmocka_unit_test(trace_of_an_empty_scene_misses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
