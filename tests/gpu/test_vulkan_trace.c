/* Tracing on the running driver: its answers are C's, bit for bit, and what cannot be answered
 * fails loudly. */
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include "tests/support/gpu.h"
#include "tests/support/tree_fixture.h"

#include <math.h>

#define RAYS 3000

/* A scene, its tree in one layout, rays, and C's answers. */
struct gpu_case {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray *ray;
    struct hit *expected, *got;
    size_t ray_count;
};

static struct scene soup(double count)
{
    struct scene scene;
    struct reason reason = {""};
    const struct generator *generator = generator_find("soup");
    double value[GENERATOR_PARAMS] = {0};
    for (int k = 0; k < GENERATOR_PARAMS && generator->param[k].name; k++)
        value[k] = generator->param[k].value;
    value[0] = count;
    gpu_must(generator->make(value, 5, &scene, &reason), &reason);
    return scene;
}

static struct gpu_case pack(struct scene scene, struct bvh bvh, const char *layout, size_t rays)
{
    struct gpu_case f = {.scene = scene, .bvh = bvh, .ray_count = rays};
    struct reason reason = {""};
    gpu_must(packed_make(layout_find(layout), &f.bvh, &f.scene, &f.packed, &reason), &reason);
    f.ray = calloc(rays + 1, sizeof *f.ray);
    f.expected = calloc(rays + 1, sizeof *f.expected);
    f.got = calloc(rays + 1, sizeof *f.got);
    assert_true(f.ray && f.expected && f.got);
    if (f.scene.tri_count)
        gpu_must(ray_sets[0]->make(&f.scene, 3, rays, f.ray, &reason), &reason);
    return f;
}

static struct gpu_case fixture(const char *layout, uint32_t leaf, size_t rays)
{
    struct scene scene = soup(300);
    struct bvh bvh;
    struct reason reason = {""};
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    gpu_must(builder_find("median")->build(&scene, &options, &bvh, &reason), &reason);
    return pack(scene, bvh, layout, rays);
}

static void release(struct gpu_case *f)
{
    packed_free(&f->packed);
    bvh_free(&f->bvh);
    scene_free(&f->scene);
    free(f->ray);
    free(f->expected);
    free(f->got);
}

static struct job job_of(const struct gpu_case *f, const char *box, const char *tri,
                         enum query query)
{
    return (struct job){.scene = &f->scene,
                        .packed = &f->packed,
                        .box = box_test_find(box),
                        .tri = tri_test_find(tri),
                        .query = query};
}

static void expect(struct gpu_case *f, const struct job *job)
{
    for (size_t i = 0; i < f->ray_count; i++)
        assert_int_equal(trace_ray(&f->packed, &f->scene, job->box, job->tri, job->query,
                                   &f->ray[i], &f->expected[i], NULL),
                         STATUS_OK);
}

/* Traces all rays; the bits must be C's, and what lies behind the last hit untouched. */
static size_t must_agree(struct tracer *tracer, struct gpu_case *f, const struct job *job)
{
    struct reason reason = {""};
    struct trace_report report;
    memset(f->got, 0xA5, (f->ray_count + 1) * sizeof *f->got);
    struct hit canary = f->got[f->ray_count];
    expect(f, job);
    gpu_must(tracer_prepare(tracer, job, &reason), &reason);
    gpu_must(tracer_trace(tracer, f->ray, f->ray_count, f->got, &report, &reason), &reason);
    size_t hits = 0;
    for (size_t i = 0; i < f->ray_count; i++) {
        hits += f->expected[i].prim != ABI_NO_PRIM;
        if (memcmp(&f->expected[i], &f->got[i], sizeof f->got[i]) != 0)
            fail_msg("%s %s %s query %d, ray %zu: prim %u t %a, C has prim %u t %a",
                     job->packed->layout->name, job->box->name, job->tri->name, (int)job->query, i,
                     f->got[i].prim, (double)f->got[i].t, f->expected[i].prim,
                     (double)f->expected[i].t);
    }
    assert_memory_equal(&f->got[f->ray_count], &canary, sizeof canary);
    return hits;
}

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
        cmocka_unit_test(trace_agrees_with_c_in_every_layout),
        cmocka_unit_test(trace_agrees_with_c_on_full_leaves),
        cmocka_unit_test(trace_agrees_with_c_on_parallel_axes),
        cmocka_unit_test(trace_ends_on_random_bits),
        cmocka_unit_test(trace_answers_any_number_of_rays),
        cmocka_unit_test(trace_through_staging_agrees),
        cmocka_unit_test(trace_under_validation_says_nothing),
        cmocka_unit_test(trace_of_an_empty_scene_misses),
        cmocka_unit_test(trace_without_prepare_fails),
        cmocka_unit_test(trace_takes_the_smallest_stack_that_is_enough),
        cmocka_unit_test(trace_fails_when_the_stack_overruns),
        cmocka_unit_test(trace_fails_on_a_cycle),
        cmocka_unit_test(trace_drops_references_out_of_range),
        cmocka_unit_test(trace_notices_a_loop_cut_short),
        cmocka_unit_test(trace_refuses_what_is_too_deep),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
