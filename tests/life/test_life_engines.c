/* Engines after steps, beside the exact truth of the scene at that step. */
#include "ref/engines/embree_named.h"

#include "tests/life/lived_match.h"

static struct pool pool = {.options = {.device = -1, .threads = 1}};

/* Over the refitted tree and over the one that was built again, which both hold the last scene. */
static void cpu_is_right_over_any_layout_and_storage(void **state)
{
    (void)state;
    const struct engine *cpu = engine_find("cpu");
    for (size_t l = 0; layouts[l]; l++)
        if (!layouts[l]->faithful)
            assert_int_equal(lived_all(cpu, layouts[l], tri_stores[0], &pool), 0);
    for (size_t s = 0; tri_stores[s]; s++)
        if (!tri_stores[s]->head)
            assert_int_equal(lived_all(cpu, layout_find("f32"), tri_stores[s], &pool), 0);
}

static void fast_is_prepared_anew_and_right(void **state)
{
    (void)state;
    static const char *const of[] = {"f32", "cwbvh80"};
    for (size_t l = 0; l < ARRAY_COUNT(of); l++)
        assert_int_equal(lived_all(engine_find("fast"), layout_find(of[l]), tri_stores[0], &pool),
                         0);
}

static void refits_and_builds_leave_the_same_answers(void **state)
{
    (void)state;
    struct lived refit = lived_make("soup:n=60", "refit:jitter:3,refit:swap:2"),
                 build = lived_make("soup:n=60", "rebuild:jitter:3,rebuild:swap:2");
    const struct row a = lived_row(&refit, engine_find("cpu"), layout_find("f32"), NULL, &pool);
    const struct row b = lived_row(&build, engine_find("cpu"), layout_find("f32"), NULL, &pool);
    assert_int_equal(a.status, ROW_OK);
    assert_int_equal(a.life.fate, LIFE_REFITTED);
    assert_int_equal(b.life.fate, LIFE_REBUILT);
    assert_int_equal(a.count[VERDICT_WRONG] + b.count[VERDICT_WRONG], 0);
    assert_int_equal(a.hits, b.hits);
    assert_true(a.hits > 20);
    lived_free(&refit);
    lived_free(&build);
}

static void embree_updates_its_scene_in_every_mode(void **state)
{
    (void)state;
    static const char *const modes[] = {"embree",         "embree:robust",       "embree:dynamic",
                                        "embree:refit",   "embree:low:dynamic",  "embree:high",
                                        "embree:8:refit", "embree:robust:refit", "embree:compact"};
    enum status status = STATUS_OK;
    struct reason reason = {""};
    if (!pool_get(&pool, engine_find("embree"), &status, &reason)) {
        assert_int_equal(status, STATUS_UNSUPPORTED);
        skip();
    }
    for (size_t i = 0; i < ARRAY_COUNT(modes); i++) {
        const struct engine *engine = engine_find(modes[i]);
        if (!engine && embree_named(modes[i], &engine, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(lived_all(engine, NULL, NULL, &pool), ARRAY_COUNT(lived_steps));
    }
}

static int close_pool(void **state)
{
    (void)state;
    pool_free(&pool);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cpu_is_right_over_any_layout_and_storage),
        cmocka_unit_test(fast_is_prepared_anew_and_right),
        cmocka_unit_test(refits_and_builds_leave_the_same_answers),
        cmocka_unit_test(embree_updates_its_scene_in_every_mode),
    };
    return cmocka_run_group_tests(tests, NULL, close_pool);
}
