/* The all-hits query of every engine: vulkan against cpu in every bit and in order, brute and both
 * Embrees against exact crossings. */
#include "tests/support/all_hits_fixture.h"

#include "gpu/trace/tracer.h"
#include "ref/oracle/oracle.h"

#include <math.h>

#define RAYS 3000

static void same_lists(const struct lists *a, const struct lists *b, const struct fixture_stand *s,
                       const char *what)
{
    for (size_t i = 0; i < s->ray_count; i++) {
        size_t count = a->first[i + 1] - a->first[i];
        if (count != b->first[i + 1] - b->first[i])
            fail_msg("%s: ray %zu has %zu hits, and %zu", what, i, count,
                     b->first[i + 1] - b->first[i]);
        if (memcmp(a->hit + a->first[i], b->hit + b->first[i], count * sizeof *a->hit) != 0)
            fail_msg("%s: the hits of ray %zu differ", what, i);
    }
}

/* Every layout, as found: the order of traversal is the same. */
static void vulkan_lists_what_cpu_lists_in_order(void **state)
{
    (void)state;
    const struct engine *cpu = engine_find("cpu"), *vulkan = engine_find("vulkan");
    void *on_gpu = stand_open(vulkan), *on_cpu = stand_open(cpu);
    static const char *const mix[][2] = {{"robust", "mt"}, {"robust", "woop"}, {"rtrs", "mt_rtrs"}};
    size_t again = 0;
    for (size_t l = 0; layouts[l]; l++)
        for (size_t m = 0; m < ARRAY_COUNT(mix); m++) {
            const char *spec = m == 1 ? "stack:n=30" : "soup:n=400,size=0.5";
            struct fixture_stand s = stand_make(spec, m == 1 ? "primary" : "mixed", RAYS,
                                                layouts[l]->name, layouts[l]->faithful ? 4 : 8);
            struct job job = stand_job(&s, mix[m][0], mix[m][1], QUERY_ALL);
            struct lists a = stand_lists(cpu, on_cpu, &s, &job);
            struct lists b = stand_lists(vulkan, on_gpu, &s, &job);
            same_lists(&a, &b, &s, layouts[l]->name);
            if (!layouts[l]->faithful)
                assert_true(a.first[RAYS] > RAYS);
            assert_int_equal(a.again, b.again);
            again += a.again;
            lists_free(&a);
            lists_free(&b);
            stand_free(&s);
        }
    assert_true(again > 100); /* some had more hits than room */
    vulkan->close(on_gpu);
    cpu->close(on_cpu);
}

/* Little room: counts stay whole, what lies behind each ray's room and the last ray is untouched.
 */
static void vulkan_cuts_the_list_not_the_count(void **state)
{
    (void)state;
    const struct engine *vulkan = engine_find("vulkan"), *cpu = engine_find("cpu");
    void *on_gpu = stand_open(vulkan), *on_cpu = stand_open(cpu);
    struct fixture_stand s = stand_make("stack:n=30", "primary", 500, "rf16", 8);
    struct job job = stand_job(&s, "robust", "mt", QUERY_ALL);
    struct reason reason = {""};
    stand_must(vulkan->prepare(on_gpu, &job, &reason), &reason);
    stand_must(cpu->prepare(on_cpu, &job, &reason), &reason);
    for (uint32_t room = 0; room < 20; room += room ? 6 : 1) {
        size_t hits = s.ray_count * room;
        struct hit *a = malloc((hits + 1) * sizeof *a), *b = malloc((hits + 1) * sizeof *b);
        uint32_t *count[2] = {calloc(s.ray_count + 1, 4), calloc(s.ray_count + 1, 4)};
        assert_true(a && b && count[0] && count[1]);
        memset(a, 0xA5, (hits + 1) * sizeof *a);
        memset(b, 0xA5, (hits + 1) * sizeof *b);
        struct hit canary = a[hits];
        count[0][s.ray_count] = count[1][s.ray_count] = 0xA5A5A5A5u;
        stand_must(cpu->trace_all(on_cpu, s.ray, s.ray_count, room, a, count[0], &reason), &reason);
        stand_must(vulkan->trace_all(on_gpu, s.ray, s.ray_count, room, b, count[1], &reason),
                   &reason);
        assert_memory_equal(count[0], count[1], (s.ray_count + 1) * 4);
        size_t most = 0;
        for (size_t i = 0; i < s.ray_count; i++) {
            size_t kept = count[0][i] < room ? count[0][i] : room;
            most = count[0][i] > most ? count[0][i] : most;
            assert_memory_equal(a + i * room, b + i * room, kept * sizeof *a);
        }
        assert_true(most > room);
        assert_memory_equal(&a[hits], &canary, sizeof canary);
        assert_memory_equal(&b[hits], &canary, sizeof canary);
        free(a);
        free(b);
        free(count[0]);
        free(count[1]);
    }
    vulkan->close(on_gpu);
    cpu->close(on_cpu);
    stand_free(&s);
}

/* A job is prepared for one query; the other call says so and writes nothing. */
static void vulkan_keeps_the_queries_apart(void **state)
{
    (void)state;
    const struct engine *vulkan = engine_find("vulkan");
    void *self = stand_open(vulkan);
    struct fixture_stand s = stand_make("soup:n=10", "primary", 2, "f32", 4);
    struct reason reason = {""};
    struct trace_report report;
    struct hit hit[2];
    uint32_t count[2];
    for (enum query query = QUERY_CLOSEST; query < QUERY_COUNT; query++) {
        struct job job = stand_job(&s, "robust", "mt", query);
        stand_must(vulkan->prepare(self, &job, &reason), &reason);
        enum status one = vulkan->trace(self, s.ray, 2, hit, &report, &reason);
        enum status all = vulkan->trace_all(self, s.ray, 2, 1, hit, count, &reason);
        assert_int_equal(one, query == QUERY_ALL ? STATUS_DEVICE : STATUS_OK);
        assert_int_equal(all, query == QUERY_ALL ? STATUS_OK : STATUS_DEVICE);
        assert_non_null(strstr(reason.text, "prepared for another query"));
        reason.text[0] = '\0';
    }
    vulkan->close(self);
    stand_free(&s);
}

/* Room for one ray's hits beyond any buffer is refused, not wrapped. */
static void vulkan_refuses_room_beyond_its_buffers(void **state)
{
    (void)state;
    struct vk_options options = {.device = -1};
    struct tracer *tracer;
    struct reason reason = {""};
    enum status status = tracer_open(&options, 0, &tracer, &reason);
    if (status == STATUS_UNSUPPORTED)
        skip();
    stand_must(status, &reason);
    struct fixture_stand s = stand_make("soup:n=10", "primary", 2, "f32", 4);
    struct job job = stand_job(&s, "robust", "mt", QUERY_ALL);
    uint32_t count[2];
    stand_must(tracer_prepare(tracer, &job, &reason), &reason);
    assert_int_equal(tracer_trace_all(tracer, s.ray, 2, UINT32_MAX, NULL, count, &reason),
                     STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "hits of a ray"));
    (void)tracer_close(tracer, NULL);
    stand_free(&s);
}

/* Every crossing well inside a triangle is listed, once, by every engine; nothing is listed that
 * the exact ray passes at a distance. */
static void must_list_crossings(const char *name, const char *spec, const char *rays)
{
    const struct engine *engine = engine_find(name);
    void *self = stand_open(engine);
    struct fixture_stand s = stand_make(spec, rays, RAYS, "f32", 4);
    struct job job = stand_job(&s, "robust", "mt", QUERY_ALL);
    struct lists lists = stand_lists(engine, self, &s, &job);
    struct oracle *oracle;
    struct oracle_crossing *crossing = NULL;
    struct reason reason = {""};
    size_t capacity = 0, count, clear = 0;
    stand_must(oracle_make(&s.scene, &oracle, &reason), &reason);
    for (size_t i = 0; i < s.ray_count; i++) {
        const struct hit *hit = lists.hit + lists.first[i];
        size_t hits = lists.first[i + 1] - lists.first[i];
        stand_must(
            oracle_crossings(oracle, &s.ray[i], INFINITY, &crossing, &capacity, &count, &reason),
            &reason);
        for (size_t k = 0; k < count; k++) {
            const struct oracle_pair *pair = &crossing[k].pair;
            size_t times = 0;
            for (size_t j = 0; j < hits; j++)
                times += hit[j].prim == crossing[k].prim;
            bool inside = pair->class == ORACLE_INSIDE && pair->margin > 1e-3 &&
                          pair->t_lo > 1e-3 && pair->t_hi < 0.999 * (double)s.ray[i].tmax;
            if (inside && times != 1)
                fail_msg("%s ray %zu: triangle %u is listed %zu times", name, i, crossing[k].prim,
                         times);
            clear += inside;
        }
        for (size_t j = 0; j < hits; j++) {
            struct oracle_pair pair;
            oracle_pair(oracle, &s.ray[i], hit[j].prim, &pair);
            if (pair.class == ORACLE_MISS && pair.margin < -1e-3)
                fail_msg("%s ray %zu: triangle %u is a phantom", name, i, hit[j].prim);
        }
    }
    assert_true(clear > RAYS);
    free(crossing);
    oracle_free(oracle);
    lists_free(&lists);
    stand_free(&s);
    engine->close(self);
}

static void brute_lists_exact_crossings(void **state)
{
    (void)state;
    must_list_crossings("brute", "soup:n=200,size=0.5", "random");
}

static void cpu_lists_exact_crossings(void **state)
{
    (void)state;
    must_list_crossings("cpu", "flake", "vertices");
}

static void embree_lists_exact_crossings(void **state)
{
    (void)state;
    must_list_crossings("embree", "soup:n=200,size=0.5", "random");
    must_list_crossings("embree", "flake", "vertices");
}

static void embree_robust_lists_exact_crossings(void **state)
{
    (void)state;
    must_list_crossings("embree_robust", "soup:n=200,size=0.5", "random");
    must_list_crossings("embree_robust", "flake", "vertices");
}

/* Embree goes back to closest hits afterwards, and keeps rays it asserts on out. */
static void embree_forgets_the_filter(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("embree");
    void *self = stand_open(engine);
    struct fixture_stand s = stand_make("soup:n=200,size=0.5", "random", RAYS, "f32", 4);
    struct trace_report report;
    struct reason reason = {""};
    struct hit *before = calloc(RAYS, sizeof *before), *after = calloc(RAYS, sizeof *after);
    struct job job = stand_job(&s, "robust", "mt", QUERY_CLOSEST);
    struct job all = stand_job(&s, "robust", "mt", QUERY_ALL);
    assert_true(before && after);
    stand_must(engine->prepare(self, &job, &reason), &reason);
    stand_must(engine->trace(self, s.ray, RAYS, before, &report, &reason), &reason);
    s.ray[0].org[1] = 2e18f;
    s.ray[1].tmin = 5;
    s.ray[1].tmax = 4;
    struct lists lists = stand_lists(engine, self, &s, &all);
    assert_int_equal(lists.first[2], 0);
    lists_free(&lists);
    stand_must(engine->prepare(self, &job, &reason), &reason);
    stand_must(engine->trace(self, s.ray + 2, RAYS - 2, after, &report, &reason), &reason);
    assert_memory_equal(before + 2, after, (RAYS - 2) * sizeof *after);
    free(before);
    free(after);
    stand_free(&s);
    engine->close(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vulkan_lists_what_cpu_lists_in_order),
        cmocka_unit_test(vulkan_cuts_the_list_not_the_count),
        cmocka_unit_test(vulkan_keeps_the_queries_apart),
        cmocka_unit_test(vulkan_refuses_room_beyond_its_buffers),
        cmocka_unit_test(brute_lists_exact_crossings),
        cmocka_unit_test(cpu_lists_exact_crossings),
        cmocka_unit_test(embree_lists_exact_crossings),
        cmocka_unit_test(embree_robust_lists_exact_crossings),
        cmocka_unit_test(embree_forgets_the_filter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
