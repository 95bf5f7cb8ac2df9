/* Modes of Embree that are named: ISAs, what Embree is called with, packets, lists. */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/world_laws.h"

#include "ref/engines/embree_isa.h"
#include "ref/engines/embree_named.h"
#include "ref/twin/model.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#if HAVE_EMBREE

#include "tests/support/embree_mode_names.h"
#include "tests/support/embree_calls.h"

/* --- ISAs ------------------------------------------------------------------------------------- */

/* A device of another ISA than the one asked for has no engine under that name. The answer is kept,
 * so this is the first test that asks for AVX. */
static void an_isa_that_is_replaced_is_refused(void **state)
{
    (void)state;
    struct reason reason = {""};
    const struct engine *engine = (const struct engine *)state;
    void *self = &reason;
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct embree_mode mode = {.isa = EMBREE_ISA_AVX};
    calls_forget();
    calls.other = "threads=1,verbose=1,isa=sse2";
    assert_int_equal(embree_named("embree:avx:8", &engine, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "Embree: asked for ISA avx, it runs sse2");
    assert_int_equal(embree_open_mode(&options, &mode, &self, &reason), STATUS_UNSUPPORTED);
    assert_null(self);
    assert_int_equal(calls.devices, 0);
    calls.other = NULL;
    calls.no_device = true;
    assert_int_equal(embree_named("embree:avx2", &engine, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "Embree: no device of ISA avx2 for this processor");
    calls_forget();
}

/* --- every mode ------------------------------------------------------------------------------- */

/* Rays of a soup, some of which Embree is not given. */
#define COUNT 1003 /* a multiple of no width */
static struct ray ray[COUNT];
static struct scene soup;

static struct job job_of(enum query query)
{
    return (struct job){.scene = &soup, .box = box_tests[0], .tri = tri_tests[0], .query = query};
}

static int stage(void **state)
{
    (void)state;
    struct reason reason = {""};
    if (scene_open("soup:n=300", 1, &soup, &reason) ||
        ray_set_make(ray_sets[0], &soup, 5, COUNT, ray, NULL))
        return -1;
    for (size_t i = 0; i < COUNT; i += 7)
        ray[i].tmin = -1;
    return 0;
}

static int unstage(void **state)
{
    (void)state;
    scene_free(&soup);
    return 0;
}

/* An engine of that name, opened; NULL where its ISA cannot run here. */
static const struct engine *opened(const char *name, void **self)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    const struct engine *engine = NULL;
    enum status status = embree_named(name, &engine, &reason);
    if (status == STATUS_UNSUPPORTED)
        return NULL;
    if (status || engine_open(engine, &options, self, &reason))
        fail_msg("%s: %s", name, reason.text);
    return engine;
}

static unsigned packets_of(unsigned wide, int any)
{
    const unsigned packets = wide == 4   ? calls.of4[any]
                             : wide == 8 ? calls.of8[any]
                                         : calls.packets[any];
    return wide ? packets : any ? calls.any : calls.closest;
}

/* What the mode says is what Embree is called with, and nothing else. */
static void expect_calls(const struct engine *engine, void *self, const struct embree_mode *mode)
{
    const unsigned taken = COUNT - (COUNT + 6) / 7;
    static struct hit hit[COUNT];
    char isa[64];
    snprintf(isa, sizeof isa, "threads=1%s", embree_isa_configs[mode->isa]);
    assert_string_equal(calls.config, isa);
    for (int any = 0; any < 2; any++) {
        const struct job job = job_of(any ? QUERY_ANY : QUERY_CLOSEST);
        struct trace_report report;
        struct reason reason = {""};
        calls_forget();
        assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
        assert_int_equal(calls.flags[(mode->robust ? 1 : 0) | (mode->compact ? 2 : 0)], 1);
        assert_int_equal(calls.qualities[RTC_BUILD_QUALITY_LOW], mode->quality == EMBREE_LOW);
        assert_int_equal(calls.qualities[RTC_BUILD_QUALITY_HIGH], mode->quality == EMBREE_HIGH);
        assert_int_equal(engine->trace(self, ray, COUNT, hit, &report, &reason), STATUS_OK);
        for (size_t w = 0; w < 4; w++) {
            const unsigned one = widths[w] ? (COUNT + widths[w] - 1) / widths[w] : taken;
            assert_int_equal(packets_of(widths[w], any), widths[w] == mode->packet ? one : 0);
            assert_int_equal(packets_of(widths[w], !any), 0);
        }
    }
}

static void every_mode_is_what_it_is_called(void **state)
{
    (void)state;
    static const char *const isas[] = {"sse2", "sse42", "avx512"};
    static const char *const qualities[] = {"medium", "low", "high"};
    static const char *const flags[] = {"", ":robust", ":compact", ":robust:compact"};
    for (size_t i = 0; i < ARRAY_COUNT(isas); i++)
        for (size_t w = 0; w < 4; w++)
            for (size_t q = 0; q < 3; q++)
                for (size_t f = 0; f < 4; f++) {
                    char name[80], called[60];
                    void *self;
                    const unsigned wide = widths[w] ? widths[w] : 1;
                    snprintf(name, sizeof name, "embree:%s:%u:%s%s", isas[i], wide, qualities[q],
                             flags[f]);
                    const struct embree_mode mode = parsed(name);
                    calls_forget();
                    const struct engine *engine = opened(name, &self);
                    if (!engine)
                        continue;
                    snprintf(called, sizeof called, "rtcIntersect%u or rtcOccluded%u", wide, wide);
                    assert_string_equal(engine->called(self), called);
                    const struct model model = engine_model(engine, self, tri_tests[0]);
                    assert_int_equal(model.formula, mode.robust ? TWIN_EMBREE_ROBUST : TWIN_EMBREE);
                    assert_ptr_equal(engine->plain,
                                     engine_find(mode.robust ? "embree_robust" : "embree"));
                    assert_true((engine->worlds != NULL) == (mode.packet == 0));
                    expect_equal(embree_mode_of(engine), &mode);
                    expect_calls(engine, self, &mode);
                    engine->close(self);
                }
}

/* --- packets and lists ------------------------------------------------------------------------ */

/* How far a ray is from the border of what hits a triangle: above 0 it hits, below 0 it does not.
 * In barycentric coordinates, and to both ends of the ray in parts of t or 1. */
static double margin(const struct ray *r, uint32_t prim)
{
    float corner[3][3];
    double e[2][3], o[3], p[3], q[3], det = 0, u = 0, v = 0, t = 0;
    scene_tri(&soup, prim, corner);
    for (int k = 0; k < 3; k++) {
        o[k] = (double)r->org[k] - corner[0][k];
        for (int j = 0; j < 2; j++)
            e[j][k] = (double)corner[1 + j][k] - corner[0][k];
    }
    for (int k = 0, l = 1, m = 2; k < 3; l = m, m = k++) {
        p[k] = (double)r->dir[l] * e[1][m] - (double)r->dir[m] * e[1][l];
        q[k] = o[l] * e[0][m] - o[m] * e[0][l];
    }
    for (int k = 0; k < 3; k++) {
        det += e[0][k] * p[k];
        u += o[k] * p[k];
        v += r->dir[k] * q[k];
        t += e[1][k] * q[k];
    }
    u /= det, v /= det, t /= det;
    const double part = fmax(1, fabs(t));
    return fmin(fmin(fmin(u, v), 1 - u - v), fmin((t - r->tmin) / part, (r->tmax - t) / part));
}

#define BORDER 1e-4 /* so near to a border roundings decide */

/* A nearest hit that only one of two answers has is at a border; a ray that only one of them blocks
 * hits no triangle but at borders, and one at least there. */
static void expect_border(const struct ray *r, const struct hit *a, const struct hit *b,
                          enum query query)
{
    double most = -1;
    if (query == QUERY_ANY)
        for (uint32_t prim = 0; prim < soup.tri_count; prim++)
            most = fmax(most, margin(r, prim));
    else
        most = fmin(a->prim == ABI_NO_PRIM ? 1 : margin(r, a->prim),
                    b->prim == ABI_NO_PRIM ? 1 : margin(r, b->prim));
    assert_true(fabs(most) < BORDER);
}

/* Answers of a packet are those of single rays, but at borders, through which many rays go: another
 * order of work, or on some processors another instruction, decides these otherwise. Any hit may be
 * another one. Lanes behind the last ray are off, and rays that are not given to Embree miss. */
static void packets_answer_as_single_rays(void **state)
{
    (void)state;
    static const char *const names[][2] = {
        {"embree:sse2:4", "embree:sse2"},         {"embree:sse2:8", "embree:sse2"},
        {"embree:sse2:16", "embree:sse2"},        {"embree:4:robust", "embree:1:robust"},
        {"embree:8:high", "embree:high"},         {"embree:16:compact", "embree:compact"},
        {"embree:16:low:robust", "embree:robust"}};
    static struct hit single[COUNT], hit[COUNT + 1];
    for (size_t n = 0; n < ARRAY_COUNT(names); n++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            const struct job job = job_of((enum query)query);
            struct trace_report report;
            void *plain, *self;
            const struct engine *engine = opened(names[n][0], &self);
            const struct engine *base = opened(names[n][1], &plain);
            if (!engine || !base)
                skip();
            const size_t wide = embree_mode_of(engine)->packet;
            size_t same = 0;
            assert_int_equal(base->prepare(plain, &job, NULL), STATUS_OK);
            assert_int_equal(engine->prepare(self, &job, NULL), STATUS_OK);
            assert_int_equal(base->trace(plain, ray, COUNT, single, &report, NULL), STATUS_OK);
            hit[COUNT].prim = 12345;
            assert_int_equal(engine->trace(self, ray, COUNT, hit, &report, NULL), STATUS_OK);
            for (size_t lane = 0; lane < wide; lane++)
                assert_int_equal(calls.valid[lane],
                                 lane < COUNT % wide && (COUNT / wide * wide + lane) % 7 ? -1 : 0);
            for (size_t i = 0; i < COUNT; i++) {
                const bool other = query == QUERY_ANY ? (single[i].prim == ABI_NO_PRIM) !=
                                                            (hit[i].prim == ABI_NO_PRIM)
                                                      : single[i].prim != hit[i].prim;
                same += !other;
                if (other)
                    expect_border(&ray[i], &single[i], &hit[i], (enum query)query);
                assert_true(i % 7 != 0 || hit[i].prim == ABI_NO_PRIM);
            }
            assert_int_equal(hit[COUNT].prim, 12345);
            assert_in_range(same, COUNT - COUNT / 12, COUNT);
            engine->close(self);
            base->close(plain);
        }
}

static int by_prim(const void *a, const void *b)
{
    const struct hit *x = a, *y = b;
    return (x->prim > y->prim) - (x->prim < y->prim);
}

#define MOST 64

static void list_all(const char *name, const struct job *job, struct hit *hit, uint32_t *count)
{
    void *self;
    const struct engine *engine = opened(name, &self);
    if (!engine)
        skip();
    assert_int_equal(engine->prepare(self, job, NULL), STATUS_OK);
    assert_int_equal(engine->trace_all(self, ray, COUNT, MOST, hit, count, NULL), STATUS_OK);
    engine->close(self);
}

/* Every mode lists what single rays do, each triangle once, but for few lists. */
static void lists_are_those_of_single_rays(void **state)
{
    (void)state;
    static const char *const names[][2] = {
        {"embree:sse2:4", "embree:sse2"},    {"embree:sse2:8", "embree:sse2"},
        {"embree:sse2:16", "embree:sse2"},   {"embree:4:robust", "embree:1:robust"},
        {"embree:sse2:high", "embree:sse2"}, {"embree:high", "embree:medium"},
        {"embree:8:high", "embree:medium"}};
    static struct hit want[COUNT][MOST], got[COUNT][MOST];
    static uint32_t want_count[COUNT], count[COUNT];
    const struct job job = job_of(QUERY_ALL);
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        size_t same = 0, hits = 0;
        list_all(names[n][0], &job, got[0], count);
        list_all(names[n][1], &job, want[0], want_count);
        for (size_t i = 0; i < COUNT; i++) {
            bool equal = count[i] == want_count[i];
            assert_true(count[i] <= MOST && (i % 7 != 0 || count[i] == 0));
            qsort(got[i], count[i], sizeof got[i][0], by_prim);
            qsort(want[i], want_count[i], sizeof want[i][0], by_prim);
            for (uint32_t k = 0; k < count[i]; k++) {
                assert_true(k == 0 || got[i][k].prim != got[i][k - 1].prim);
                equal = equal && got[i][k].prim == want[i][k].prim;
            }
            same += equal;
            hits += count[i];
        }
        assert_true(hits > COUNT / 8);
        assert_in_range(same, COUNT - 8, COUNT);
    }
}

/* --- worlds ----------------------------------------------------------------------------------- */

static void worlds_of_low_quality_are_not_built(void **state)
{
    (void)state;
    static const char *const names[] = {"embree:low", "embree:low:robust", "embree:high",
                                        "embree:compact"};
    struct world world = laws_room(1, 1);
    laws_mesh(&world.mesh[0], (const uint32_t[]){2}, 1);
    laws_finish(&world);
    const struct world_job job = {
        .world = &world, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_CLOSEST};
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        void *self;
        struct reason reason = {""};
        const struct engine *engine = opened(names[n], &self);
        assert_int_equal(engine->worlds->prepare_world(self, &job, &reason),
                         n < 2 ? STATUS_UNSUPPORTED : STATUS_OK);
        assert_true((strstr(reason.text, "quality low") != NULL) == (n < 2));
        engine->close(self);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_isa_that_is_replaced_is_refused),
        cmocka_unit_test(every_mode_is_what_it_is_called),
        cmocka_unit_test(packets_answer_as_single_rays),
        cmocka_unit_test(lists_are_those_of_single_rays),
        cmocka_unit_test(worlds_of_low_quality_are_not_built),
    };
    return calls_can_run() ? cmocka_run_group_tests_name("embree_modes", tests, stage, unstage) : 0;
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
