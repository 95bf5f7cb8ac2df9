/* Embree on worlds of every generator, against the exact truth. What it reads and how it answers is
 * for test_embree_world.c. Skipped with the reason where Embree cannot run. */
#include "tests/support/world_judged.h"

#include <stdio.h>

#define RAYS 400

/* Embree's default test compares the range before it divides, so that t may be just beyond tmax;
 * its default box test loses what lies on the side of a box. */
static void no_generator_has_what_rounding_does_not_explain(void **state)
{
    (void)state;
    static const char *const names[] = {"embree", "embree_robust"};
    static const struct engine_options options = {.threads = 2, .device = -1};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        const struct engine *engine = engine_find(names[which]);
        struct reason reason = {""};
        void *self;
        assert_non_null(engine);
        enum status status = engine_open(engine, &options, &self, &reason);
        if (status == STATUS_UNSUPPORTED) {
            printf("SKIP %s\n", reason.text);
            skip();
        }
        assert_int_equal(status, STATUS_OK);
        engine->close(self);
        struct judged_sum sum = judged_everywhere(engine, &options, RAYS);
        assert_true(sum.compared == sum.rows * RAYS && sum.refused <= 9); /* placed-thin */
        assert_true(sum.hits > sum.compared / 8);
        assert_int_equal(sum.wrong, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_generator_has_what_rounding_does_not_explain),
    };
    return cmocka_run_group_tests_name("embree_world_truth", tests, NULL, NULL);
}
