/* Engines on a device after the steps of worlds: `vulkan` writes into the buffers that it has, and
 * the driver updates its structures. */
#include "gpu/engines/rayquery_named.h"

#include "tests/world_life/world_lived_match.h"

static struct pool pool = {.options = {.device = -1}};
static struct pool queries = {.options = {.device = -1, .driver = "mesa25"}};

static void open_or_skip(struct pool *in, const struct engine *engine)
{
    enum status status = STATUS_OK;
    struct reason reason = {""};
    if (pool_get(in, engine, &status, &reason))
        return;
    if (status != STATUS_UNSUPPORTED)
        fail_msg("%s", reason.text);
    print_message("SKIP %s\n", reason.text);
    skip();
}

static void updated_buffers_of_worlds_answer_as_c_does(void **state)
{
    (void)state;
    static const char *const of[] = {"f32", "cwbvh80"};
    const struct engine *engine = engine_find("vulkan");
    open_or_skip(&pool, engine);
    for (size_t l = 0; l < ARRAY_COUNT(of); l++) {
        const uint32_t updated = world_lived_all(engine, layout_find(of[l]), QUERY_CLOSEST, &pool);
        assert_true(updated > 4);
    }
    assert_true(world_lived_all(engine, layout_find("f32"), QUERY_ALL, &pool) > 4);
}

static void the_driver_updates_its_structures(void **state)
{
    (void)state;
    static const char *const names[] = {"rayquery:update", "rayquery:update_into"};
    struct reason reason = {""};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        const struct engine *engine;
        if (rayquery_named(names[i], &engine, &reason))
            fail_msg("%s", reason.text);
        open_or_skip(&queries, engine);
        assert_true(world_lived_all(engine, NULL, QUERY_CLOSEST, &queries) > 6);
    }
}

static int close_pool(void **state)
{
    (void)state;
    pool_free(&pool);
    pool_free(&queries);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(updated_buffers_of_worlds_answer_as_c_does),
        cmocka_unit_test(the_driver_updates_its_structures),
    };
    return cmocka_run_group_tests(tests, NULL, close_pool);
}
