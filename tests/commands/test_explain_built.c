/* What explain makes of a builder on a device: a difference from C is told, what cannot run is an
 * error, and builders of C are not asked. */
#include "cmd/explain/cmd_explain_inner.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

static enum status answer;

static enum status compare(const struct scene *scene, struct reason *reason)
{
    assert_int_equal(scene->tri_count, 7);
    strcpy(reason->text, answer ? "links 3: node 7, not leaf 2 (5 differ)" : "left by a stage");
    return answer;
}

static void differences_are_told(void **state)
{
    (void)state;
    const struct builder device = {.name = "device", .compare = compare, .twin = "median"};
    const struct scene scene = {.tri_count = 7};
    struct reason built = {"of before"}, reason = {""};
    answer = STATUS_OK;
    assert_int_equal(explain_compare_built(&device, &scene, &built, &reason), STATUS_OK);
    assert_string_equal(built.text, "");
    answer = STATUS_DEVICE;
    assert_int_equal(explain_compare_built(&device, &scene, &built, &reason), STATUS_OK);
    assert_string_equal(built.text, "links 3: node 7, not leaf 2 (5 differ)");
    assert_int_equal(explain_compare_built(builder_find("median"), &scene, &built, &reason),
                     STATUS_OK);
    assert_string_equal(built.text, "");
    strcpy(built.text, "of before");
    assert_int_equal(explain_compare_built(NULL, &scene, &built, &reason), STATUS_OK);
    assert_string_equal(built.text, "");
    assert_string_equal(reason.text, "");
    answer = STATUS_UNSUPPORTED;
    assert_int_equal(explain_compare_built(&device, &scene, &built, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "links 3: node 7, not leaf 2 (5 differ)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(differences_are_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
