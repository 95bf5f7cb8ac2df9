/* Engine vulkan writes moved vertices and refitted trees into the buffers that it has. */
#include "tests/life/lived_match.h"

static struct pool pool = {.options = {.device = -1}};

static void open_or_skip(void)
{
    enum status status = STATUS_OK;
    struct reason reason = {""};
    if (pool_get(&pool, engine_find("vulkan"), &status, &reason))
        return;
    if (status != STATUS_UNSUPPORTED)
        fail_msg("%s", reason.text);
    print_message("SKIP %s\n", reason.text);
    skip();
}

static void updated_buffers_answer_as_c_does(void **state)
{
    (void)state;
    static const char *const of[] = {"f32", "rf16", "cwbvh80"};
    const struct engine *engine = engine_find("vulkan");
    open_or_skip();
    for (size_t l = 0; l < ARRAY_COUNT(of); l++)
        for (size_t s = 0; tri_stores[s] && (s == 0 || l == 0); s++) {
            if (tri_stores[s]->head)
                continue;
            uint32_t updated = lived_all(engine, layout_find(of[l]), tri_stores[s], &pool);
            assert_true(updated > 2 || s > 0);
        }
}

/* Nothing is left of the scene before: a triangle that moved away is no longer hit where it was. */
static void what_moved_away_is_gone(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("vulkan");
    struct lived lived = lived_make("soup:n=60", "refit:far:3");
    open_or_skip();
    const struct row row = lived_row(&lived, engine, layout_find("f32"), tri_stores[0], &pool);
    assert_int_equal(row.status, ROW_OK);
    assert_true(row.life.updated && row.hits > 20);
    assert_int_equal(row.differences, 0);
    lived_free(&lived);
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
        cmocka_unit_test(updated_buffers_answer_as_c_does),
        cmocka_unit_test(what_moved_away_is_gone),
    };
    return cmocka_run_group_tests(tests, NULL, close_pool);
}
