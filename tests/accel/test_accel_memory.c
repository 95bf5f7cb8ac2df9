/* Memory that runs out while the triangles of a mesh are put into the form of a variant: each
 * allocation in turn fails, is told in one line, and leaves nothing behind. */
#include "tests/support/allocations.h"

#include "gpu/accel/accel_input.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"

struct accel_work {
    const struct scene *scene;
    struct accel_variant variant;
};

static enum status do_input(const void *of, struct reason *reason)
{
    const struct accel_work *work = of;
    struct accel_part *part;
    struct accel_input input = {.part_count = 0};
    uint32_t count;
    enum status status = accel_split(work->scene, &work->variant, &part, &count, reason);
    if (!status)
        status = accel_input_make(work->scene, NULL, part, count, &work->variant, &input, reason);
    accel_input_free(&input);
    free(part);
    return status;
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    static const char *const name[] = {"rayquery:u16", "rayquery:nan:degenerate:split3:offset",
                                       "rayquery:unindexed:turned:offset:split5",
                                       "rayquery:first_vertex:scaled:degenerate"};
    struct scene scene;
    assert_int_equal(scene_open("soup:n=90", 1, &scene, NULL), STATUS_OK);
    for (size_t i = 0; i < ARRAY_COUNT(name); i++) {
        struct accel_work work = {.scene = &scene};
        assert_int_equal(accel_parse(name[i], &work.variant, NULL), STATUS_OK);
        assert_true(each_fails(name[i], do_input, &work, 1) > 10);
    }
    scene_free(&scene);
}

/* What would be rounded is told with its number and its coordinates in order. */
static void the_first_vertex_that_would_be_rounded_is_told(void **state)
{
    (void)state;
    struct scene scene;
    struct accel_work work = {.scene = &scene};
    struct reason reason = {""};
    assert_int_equal(scene_open("tests/accel/cube.obj", 1, &scene, NULL), STATUS_OK);
    assert_int_equal(accel_parse("rayquery:f16x3", &work.variant, NULL), STATUS_OK);
    const uint32_t vertex = scene.index[3 * (size_t)scene.tri_count - 1];
    const float at[3] = {0.25f, 100001, -7};
    memcpy(scene.vertex + 3 * (size_t)vertex, at, sizeof at);
    assert_int_equal(do_input(&work, &reason), STATUS_LIMIT);
    char text[160];
    snprintf(text, sizeof text,
             "rayquery: vertex %u of the mesh, (0.25, 100001, -7), would be rounded: format f16x3",
             vertex);
    assert_string_equal(reason.text, text);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_allocation_may_fail),
        cmocka_unit_test(the_first_vertex_that_would_be_rounded_is_told),
    };
    return cmocka_run_group_tests_name("accel_memory", tests, NULL, NULL);
}
