/* Engine rayquery, on the drivers that have ray queries: what it is given arrives, and what it
 * answers is read rightly. How good its answers are is the judge's business. */
#include "tests/support/drivers.h"

static const struct engine *rayquery(void)
{
    const struct engine *engine = engine_find("rayquery");
    assert_non_null(engine);
    return engine;
}

/* Opens it on Mesa 25, else on any device that can; NULL, with the reason printed, if none can. */
static void *open_any(void)
{
    void *self = driver_open("rayquery", "mesa25");
    return self ? self : driver_open("rayquery", NULL);
}

static void trace_job(void *self, const struct scene *scene, enum query query,
                      const struct ray *ray, size_t ray_count, struct hit *hit)
{
    const struct job job = {
        .scene = scene, .packed = NULL, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    struct trace_report report;
    struct reason reason = {""};
    gpu_must(rayquery()->prepare(self, &job, &reason), &reason);
    gpu_must(rayquery()->trace(self, ray, ray_count, hit, &report, &reason), &reason);
}

static void rayquery_says_who_has_none(void **state)
{
    (void)state;
    const struct engine_options options = {.driver = "swiftshader", .device = -1};
    struct reason reason = {""};
    char text[1024] = "";
    void *self = text;
    enum status status = engine_open(rayquery(), &options, &self, &reason);
    if (status == STATUS_OK) /* a later SwiftShader may have them */
        rayquery()->close(self);
    else
        assert_int_equal(status, STATUS_UNSUPPORTED);
    if (status && !strstr(reason.text, "make drivers") && !strstr(reason.text, "no loader"))
        assert_non_null(strstr(reason.text, "VK_KHR_ray_query"));
    engine_describe(rayquery(), &options, text, sizeof text);
    assert_true(strlen(text) > 10);
    rayquery()->close(NULL);
}

/* From above onto the middle of each triangle of a flat grid: nothing is near an edge. */
static void rayquery_names_every_triangle(void **state)
{
    (void)state;
    void *self = open_any();
    if (!self)
        skip();
    struct drivers_view view = view_make("grid:height=0", "random", 1);
    const uint32_t count = view.scene.tri_count;
    struct ray *ray = calloc(count, sizeof *ray);
    struct hit *hit = calloc(count, sizeof *hit);
    assert_true(ray && hit);
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(&view.scene, i, v);
        ray[i] = (struct ray){.dir = {0, 0, -2}, .tmax = 100};
        for (int k = 0; k < 3; k++)
            ray[i].org[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 + (k == 2 ? 8 : 0);
    }
    for (int q = 0; q < 2; q++) {
        trace_job(self, &view.scene, q ? QUERY_ANY : QUERY_CLOSEST, ray, count, hit);
        for (uint32_t i = 0; i < count; i++) {
            assert_int_equal(hit[i].prim, i);
            assert_true(fabsf(hit[i].t - 4) < 1e-5f);
            assert_true(fabsf(hit[i].u - 1 / 3.0f) < 1e-5f && fabsf(hit[i].v - 1 / 3.0f) < 1e-5f);
        }
    }
    rayquery()->close(self);
    view_free(&view);
    free(ray);
    free(hit);
}

static const float one_triangle[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

static struct scene parallel(uint32_t count)
{
    struct scene scene;
    assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * count; i++) {
        for (int k = 0; k < 3; k++)
            scene.vertex[3 * i + (uint32_t)k] =
                one_triangle[i % 3][k] + (k == 2 ? (float)(i / 3) : 0);
        scene.index[i] = i;
    }
    return scene;
}

/* u weighs vertex 1 and v vertex 2; both sides are seen; the range is open. */
static void rayquery_reports_barycentrics_and_range(void **state)
{
    (void)state;
    void *self = open_any();
    if (!self)
        skip();
    struct scene scene = parallel(1);
    const struct ray ray[] = {
        {{1, 0.5f, 8}, 0, {0, 0, -1}, 100},  {{1, 0.5f, -8}, 0, {0, 0, 1}, 100},
        {{1, 0.5f, 8}, 0, {0, 0, -1}, 7.5f}, {{1, 0.5f, 8}, 8.5f, {0, 0, -1}, 100},
        {{1, 0.5f, 8}, 0, {0, 0, -1}, 8},    {{1, 0.5f, 8}, 8, {0, 0, -1}, 100},
    };
    struct hit hit[ARRAY_COUNT(ray)];
    trace_job(self, &scene, QUERY_CLOSEST, ray, ARRAY_COUNT(ray), hit);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(hit[i].prim, 0);
        assert_true(hit[i].t == 8 && hit[i].u == 0.25f && hit[i].v == 0.125f);
    }
    const struct hit miss = {0, 0, 0, ABI_NO_PRIM};
    for (size_t i = 2; i < ARRAY_COUNT(ray); i++)
        assert_memory_equal(&hit[i], &miss, sizeof miss);
    rayquery()->close(self);
    scene_free(&scene);
}

static void rayquery_lists_every_triangle(void **state)
{
    (void)state;
    enum { COUNT = 20, CAPACITY = 8, RAYS = 70 };
    void *self = open_any();
    if (!self)
        skip();
    struct scene scene = parallel(COUNT);
    const struct job job = {.scene = &scene,
                            .packed = NULL,
                            .box = box_tests[0],
                            .tri = tri_tests[0],
                            .query = QUERY_ALL};
    static struct ray ray[RAYS];
    static struct hit hit[RAYS * CAPACITY];
    uint32_t found[RAYS];
    struct reason reason = {""};
    for (int i = 0; i < RAYS; i++) /* ray i meets COUNT - i % 30 of them */
        ray[i] = (struct ray){{1, 1, (float)(i % 30) - 0.5f}, 0, {0, 0, 1}, 1000};
    gpu_must(rayquery()->prepare(self, &job, &reason), &reason);
    gpu_must(rayquery()->trace_all(self, ray, RAYS, CAPACITY, hit, found, &reason), &reason);
    for (int i = 0; i < RAYS; i++) {
        uint32_t expected = i % 30 < COUNT ? (uint32_t)(COUNT - i % 30) : 0;
        uint32_t seen = 0;
        assert_int_equal(found[i], expected);
        for (uint32_t k = 0; k < CAPACITY && k < found[i]; k++) {
            const struct hit *h = &hit[i * CAPACITY + (int)k];
            assert_true(h->prim < COUNT && !(seen >> h->prim & 1));
            seen |= 1u << h->prim;
            assert_true(h->t == (float)h->prim - ray[i].org[2]);
        }
    }
    rayquery()->close(self);
    scene_free(&scene);
}

/* What the specification leaves undefined is not asked. */
static void rayquery_survives_bad_rays_and_no_triangles(void **state)
{
    (void)state;
    void *self = open_any();
    if (!self)
        skip();
    struct scene scene = parallel(1), empty;
    const struct ray ray[] = {
        {{NAN, 1, 8}, 0, {0, 0, -1}, 100},    {{1, 1, 8}, 0, {0, INFINITY, -1}, 100},
        {{1, 1, 8}, NAN, {0, 0, -1}, 100},    {{1, 1, 8}, 0, {0, 0, -1}, NAN},
        {{1, 1, 8}, -1, {0, 0, -1}, 100},     {{1, 1, 8}, 9, {0, 0, -1}, 2},
        {{1, 1, 8}, 0, {0, 0, 0}, 100},       {{1, 1, 8}, 0, {0, 0, -1e-40f}, INFINITY},
        {{1, 1, 8}, 0, {0, 0, -1}, INFINITY},
    };
    const size_t count = ARRAY_COUNT(ray);
    struct hit hit[ARRAY_COUNT(ray)];
    trace_job(self, &scene, QUERY_CLOSEST, ray, count, hit);
    for (size_t i = 0; i < 7; i++)
        assert_int_equal(hit[i].prim, ABI_NO_PRIM);
    assert_int_equal(hit[count - 1].prim, 0);
    assert_int_equal(scene_make(0, 0, &empty), STATUS_OK);
    trace_job(self, &empty, QUERY_CLOSEST, ray, count, hit);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(hit[i].prim, ABI_NO_PRIM);
    rayquery()->close(self);
    scene_free(&scene);
    scene_free(&empty);
}

static void rayquery_needs_to_be_prepared(void **state)
{
    (void)state;
    void *self = open_any();
    if (!self)
        skip();
    const struct ray ray = {{1, 1, 8}, 0, {0, 0, -1}, 100};
    struct hit hit;
    struct trace_report report;
    struct reason reason = {""};
    uint32_t found;
    assert_int_equal(rayquery()->trace(self, &ray, 1, &hit, &report, &reason), STATUS_DEVICE);
    struct scene scene = parallel(1);
    trace_job(self, &scene, QUERY_CLOSEST, &ray, 1, &hit);
    assert_int_equal(rayquery()->trace_all(self, &ray, 1, 1, &hit, &found, &reason), STATUS_DEVICE);
    struct model model = engine_model(rayquery(), self, tri_tests[0]);
    assert_true(model.formula == TWIN_UNKNOWN && model.open && !model.bits && !model.watertight);
    rayquery()->close(self);
    scene_free(&scene);
}

/* The same rays through a structure of many triangles, in several batches' worth of jobs. */
static void rayquery_agrees_with_c_away_from_edges(void **state)
{
    (void)state;
    void *self = open_any();
    if (!self)
        skip();
    struct drivers_view view = view_make("terrain:k=7", "primary", 4000);
    const struct job job = {.scene = &view.scene,
                            .packed = NULL,
                            .box = box_tests[0],
                            .tri = tri_test_find("woop"),
                            .query = QUERY_CLOSEST};
    size_t hits = 0, other = 0;
    for (size_t i = 0; i < view.ray_count; i++)
        trace_brute(&view.scene, job.tri, job.query, &view.ray[i], &view.expected[i]);
    (void)driver_trace("rayquery", self, &view, &job, view.got);
    for (size_t i = 0; i < view.ray_count; i++) {
        const struct hit *a = &view.expected[i], *b = &view.got[i];
        hits += a->prim != ABI_NO_PRIM;
        other += a->prim != b->prim || !(fabsf(a->t - b->t) <= 1e-4f * fabsf(a->t));
    }
    assert_true(hits > view.ray_count / 4);
    if (other > view.ray_count / 1000)
        fail_msg("%zu of %zu answers are another triangle or far away", other, view.ray_count);
    rayquery()->close(self);
    view_free(&view);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rayquery_says_who_has_none),
        cmocka_unit_test(rayquery_names_every_triangle),
        cmocka_unit_test(rayquery_reports_barycentrics_and_range),
        cmocka_unit_test(rayquery_lists_every_triangle),
        cmocka_unit_test(rayquery_survives_bad_rays_and_no_triangles),
        cmocka_unit_test(rayquery_needs_to_be_prepared),
        cmocka_unit_test(rayquery_agrees_with_c_away_from_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
