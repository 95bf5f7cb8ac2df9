/* Worlds in engine rayquery, on the drivers that have ray queries: instances, masks, flags and
 * filters arrive, and answers are read rightly. Facing is that of the Vulkan specification ("Ray
 * Face Culling"): with a = -1/2 sum of x_i y_(i+1) - x_(i+1) y_i in ray space, whose axis z is
 * against the ray, a negative a is the front: d . ((v1 - v0) x (v2 - v0)) < 0, as ref/world/world.h
 * has it. */
#include "tests/support/gpu.h"
#include "tests/support/world_judged.h"
#include "tests/support/world_more_laws.h"

#define RAYS 300

/* Mesa 25, else any device that can; the test is skipped, with the reason printed, if none can. */
static struct laws open_any(void)
{
    struct laws laws = {.engine = engine_find("rayquery"),
                        .self = driver_open("rayquery", "mesa25")};
    if (!laws.self)
        laws.self = driver_open("rayquery", NULL);
    if (!laws.self)
        skip();
    assert_non_null(laws.engine->worlds);
    return laws;
}

static void one(void (*law)(const struct laws *laws))
{
    const struct laws laws = open_any();
    law(&laws);
    laws.engine->close(laws.self);
}

static void every_placed_triangle_has_its_number_and_tag(void **state)
{
    (void)state;
    one(laws_of_names);
}

static void masks_are_those_of_the_instances(void **state)
{
    (void)state;
    one(laws_of_masks);
}

static void flags_cull_and_decide_opacity(void **state)
{
    (void)state;
    one(laws_of_flags);
}

static void filters_decide_every_query(void **state)
{
    (void)state;
    one(laws_of_filters);
}

static void what_is_passed_over_ends_nothing(void **state)
{
    (void)state;
    one(laws_of_piles);
}

static void lists_have_every_hit_that_counts(void **state)
{
    (void)state;
    one(laws_of_lists);
}

static void worlds_and_scenes_follow_each_other(void **state)
{
    (void)state;
    one(laws_of_nothing);
}

static void bad_rays_are_misses(void **state)
{
    (void)state;
    one(laws_of_bad_rays);
}

static void a_world_needs_to_be_prepared_for_its_query(void **state)
{
    (void)state;
    const struct laws laws = open_any();
    const struct world_tracer *worlds = laws.engine->worlds;
    struct world pile = laws_pile();
    const struct ray ray = laws_down();
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit;
    uint32_t tag, found;
    assert_int_equal(worlds->trace_world(laws.self, &ray, NULL, 1, &hit, &tag, &report, &reason),
                     STATUS_DEVICE);
    laws_prepare(&laws, &pile, QUERY_ANY);
    assert_int_equal(
        worlds->trace_world_all(laws.self, &ray, NULL, 1, 1, &hit, &tag, &found, &reason),
        STATUS_DEVICE);
    assert_int_equal(worlds->trace_world(laws.self, &ray, NULL, 1, &hit, &tag, &report, &reason),
                     STATUS_OK);
    assert_true(report.ns > 0 && report.memory_bytes > PILE * 64);
    laws.engine->close(laws.self);
    world_free(&pile);
}

static void no_generator_has_what_rounding_does_not_explain(void **state)
{
    (void)state;
    const struct laws laws = open_any();
    struct engine_options options = {.driver = "mesa25", .device = -1};
    void *mesa25 = driver_open("rayquery", "mesa25");
    if (!mesa25)
        options.driver = NULL;
    laws.engine->close(mesa25);
    laws.engine->close(laws.self);
    struct judged_sum sum = judged_everywhere(laws.engine, &options, RAYS);
    assert_true(sum.compared == sum.rows * RAYS && sum.refused == 0);
    assert_true(sum.hits > sum.compared / 8);
    assert_int_equal(sum.wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_placed_triangle_has_its_number_and_tag),
        cmocka_unit_test(masks_are_those_of_the_instances),
        cmocka_unit_test(flags_cull_and_decide_opacity),
        cmocka_unit_test(filters_decide_every_query),
        cmocka_unit_test(what_is_passed_over_ends_nothing),
        cmocka_unit_test(lists_have_every_hit_that_counts),
        cmocka_unit_test(worlds_and_scenes_follow_each_other),
        cmocka_unit_test(bad_rays_are_misses),
        cmocka_unit_test(a_world_needs_to_be_prepared_for_its_query),
        cmocka_unit_test(no_generator_has_what_rounding_does_not_explain),
    };
    return cmocka_run_group_tests_name("rayquery_world", tests, NULL, NULL);
}
