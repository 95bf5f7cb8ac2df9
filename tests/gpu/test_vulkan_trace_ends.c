/* Where tracing on the running driver ends: stacks, cycles, loops and words that no layout would
 * write. */
#include "tests/gpu/vulkan_trace_fixture.h"

static void trace_without_prepare_fails(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct ray ray = {{0, 0, 0}, 0, {1, 0, 0}, 1};
    struct hit hit;
    struct trace_report report;
    struct reason reason = {""};
    assert_int_equal(tracer_trace(tracer, &ray, 1, &hit, &report, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "prepared"));
    gpu_close_tracer(tracer);
}

/* Copies of one triangle in a chain of `depth` inner nodes, all of whose boxes every ray hits. */
static struct gpu_case chain(const char *layout, uint32_t depth)
{
    static const float v[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(depth + 1, v);
    struct gpu_case f = pack(scene, trees_make(&scene, 1, TREES_LEFT), layout, 70);
    for (size_t i = 0; i < f.ray_count; i++)
        f.ray[i] = (struct ray){{0.001f * (float)i, 0, -1}, 0, {0, 0, 1}, 10};
    return f;
}

static void trace_takes_the_smallest_stack_that_is_enough(void **state)
{
    (void)state;
    static const uint32_t depths[] = {16, 15, 17, 32, 33, 64};
    static const uint32_t pipelines[] = {1, 1, 2, 2, 3, 3};
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    for (size_t i = 0; i < ARRAY_COUNT(depths); i++) {
        struct gpu_case f = chain("f32", depths[i]);
        struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
        assert_int_equal(f.packed.stack_need, depths[i]);
        assert_int_equal(must_agree(tracer, &f, &job), f.ray_count);
        assert_int_equal(tracer_pipelines(tracer), pipelines[i]);
        release(&f);
    }
    gpu_close_tracer(tracer);
}

/* Traces and expects STATUS_DEVICE with `text`. */
static void must_fail(struct tracer *tracer, const struct gpu_case *f, const struct job *job,
                      const char *text)
{
    struct reason reason = {""};
    struct trace_report report;
    gpu_must(tracer_prepare(tracer, job, &reason), &reason);
    assert_int_equal(tracer_trace(tracer, f->ray, f->ray_count, f->got, &report, &reason),
                     STATUS_DEVICE);
    if (!strstr(reason.text, text) || !strstr(reason.text, "ray "))
        fail_msg("'%s' does not name a ray and '%s'", reason.text, text);
}

static void trace_fails_when_the_stack_overruns(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = chain("f32", 17);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    f.packed.stack_need = 16; /* a lie */
    must_fail(tracer, &f, &job, "stack overran");
    release(&f);
    gpu_close_tracer(tracer);
}

/* Of all rays but one none meets a box: that one is named, with its own cause, which the report has
 * as well. */
static void trace_names_the_ray_that_did_not_end(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = chain("f32", 17);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    const size_t one[] = {0, 1, f.ray_count / 2, f.ray_count - 1};
    f.packed.stack_need = 16; /* a lie */
    for (size_t i = 0; i < f.ray_count; i++)
        f.ray[i].org[0] += 1000;
    for (size_t n = 0; n < ARRAY_COUNT(one); n++) {
        struct reason reason = {""};
        struct trace_report report = {0};
        char wanted[200];
        f.ray[one[n]].org[0] -= 1000;
        gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
        assert_int_equal(tracer_trace(tracer, f.ray, f.ray_count, f.got, &report, &reason),
                         STATUS_DEVICE);
        snprintf(wanted, sizeof wanted,
                 ": ray %zu was not finished: its traversal stack overran: the tree is deeper than "
                 "its stack_need says",
                 one[n]);
        if (!strstr(reason.text, wanted))
            fail_msg("'%s' is without '%s'", reason.text, wanted);
        assert_true((report.flags & ABI_FLAG_STACK) != 0);
        assert_int_equal(report.flags & ABI_FLAG_VISITS, 0);
        f.ray[one[n]].org[0] += 1000;
    }
    release(&f);
    gpu_close_tracer(tracer);
}

static void trace_fails_on_a_cycle(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = chain("rf16", 8);
    struct job job = job_of(&f, "rtrs", "mt", QUERY_CLOSEST); /* it prunes nothing */
    for (size_t i = 0; i < f.ray_count; i++)
        f.ray[i].dir[0] = 0.001f;
    f.packed.word[3] &= 0xFFFF0000u; /* the root's second child is the root */
    must_fail(tracer, &f, &job, "cycle");
    release(&f);
    gpu_close_tracer(tracer);
}

/* References out of range are dropped as in C, but only after their nodes were loaded: that is what
 * robust buffer access is for. Where accesses are watched, they are seen. */
static void trace_drops_references_out_of_range(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = fixture("f32", 4, RAYS);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    for (uint32_t i = 0; i < f.packed.node_count; i += 5)
        if (f.packed.word[8 * i + 7] == 0)
            f.packed.word[8 * i + 3] = i % 2 ? UINT32_MAX : f.packed.node_count;
    if (!options.watch) {
        (void)must_agree(tracer, &f, &job);
        gpu_close_tracer(tracer);
    } else {
        struct reason reason = {""};
        struct trace_report report;
        gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
        assert_int_equal(tracer_trace(tracer, f.ray, f.ray_count, f.got, &report, &reason),
                         STATUS_DEVICE);
        assert_non_null(strstr(reason.text, "out of bounds"));
        assert_true(tracer_close(tracer, &reason) > 0);
    }
    release(&f);
}

/* More than 65,535 visits, which lavapipe 22 cuts short. A driver that does not must be right. */
static void trace_notices_a_loop_cut_short(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct scene scene = trees_grid(40000);
    struct gpu_case f = pack(scene, trees_make(&scene, 1, TREES_BALANCED), "f32", 3);
    struct job job = job_of(&f, "rtrs", "mt", QUERY_CLOSEST);
    struct reason reason = {""};
    struct trace_report report;
    for (size_t i = 0; i < f.ray_count; i++) /* across the whole grid */
        f.ray[i] = (struct ray){{-1, 1, -1}, 0, {1, 0.001f, 0.015f}, 1e6f};
    gpu_must(tracer_prepare(tracer, &job, &reason), &reason);
    enum status status = tracer_trace(tracer, f.ray, f.ray_count, f.got, &report, &reason);
    if (status) {
        assert_int_equal(status, STATUS_DEVICE);
        assert_non_null(strstr(reason.text, "ray 0 "));
        assert_non_null(strstr(reason.text, "ended its loop early"));
    } else {
        (void)must_agree(tracer, &f, &job);
    }
    release(&f);
    gpu_close_tracer(tracer);
}

static void trace_refuses_what_is_too_deep(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct gpu_case f = chain("f32", 8);
    struct job job = job_of(&f, "robust", "mt", QUERY_CLOSEST);
    struct reason reason = {""};
    f.packed.stack_need = ABI_STACK_MAX + 1;
    assert_int_equal(tracer_prepare(tracer, &job, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "65"));
    f.packed.stack_need = UINT32_MAX;
    assert_int_equal(tracer_prepare(tracer, &job, &reason), STATUS_LIMIT);
    release(&f);
    gpu_close_tracer(tracer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trace_without_prepare_fails),
        cmocka_unit_test(trace_takes_the_smallest_stack_that_is_enough),
        cmocka_unit_test(trace_fails_when_the_stack_overruns),
        cmocka_unit_test(trace_names_the_ray_that_did_not_end),
        cmocka_unit_test(trace_fails_on_a_cycle),
        cmocka_unit_test(trace_drops_references_out_of_range),
        cmocka_unit_test(trace_notices_a_loop_cut_short),
        cmocka_unit_test(trace_refuses_what_is_too_deep),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
