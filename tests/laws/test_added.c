/* Laws of the tables that a program may add to, layouts and engines: what is added stands at the
 * end and is found, a layout's name is in use once, and what there is no room for is refused with a
 * reason that names it and leaves the table as it was. */
#include "ref/engine.h"
#include "ref/layout.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static size_t layouts_now(void)
{
    size_t count = 0;
    while (layouts_all[count])
        count++;
    return count;
}

static size_t engines_now(void)
{
    size_t count = 0;
    while (engines[count])
        count++;
    return count;
}

static void a_layout_is_added_once(void **state)
{
    (void)state;
    static struct layout more[LAYOUTS_ADDED_MOST + 1];
    static char name[LAYOUTS_ADDED_MOST + 1][16];
    struct reason reason = {""};
    const size_t before = layouts_now();
    for (size_t i = 0; i < before; i++) {
        more[0] = *layouts_all[i];
        assert_int_equal(layout_add(&more[0], &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, more[0].name));
        assert_int_equal(layouts_now(), before);
    }
    for (size_t i = 0; i <= LAYOUTS_ADDED_MOST; i++) {
        more[i] = *layouts[i % 2];
        snprintf(name[i], sizeof name[i], "added%zu", i);
        more[i].name = name[i];
    }
    for (size_t i = 0; i < LAYOUTS_ADDED_MOST; i++) {
        assert_int_equal(layout_add(&more[i], &reason), STATUS_OK);
        assert_ptr_equal(layouts_all[before + i], &more[i]);
        assert_ptr_equal(layout_find(name[i]), &more[i]);
        assert_int_equal(layout_add(&more[i], &reason), STATUS_INPUT);
        assert_int_equal(layouts_now(), before + i + 1);
    }
    assert_int_equal(layout_add(&more[LAYOUTS_ADDED_MOST], &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, name[LAYOUTS_ADDED_MOST]));
    assert_null(layout_find(name[LAYOUTS_ADDED_MOST]));
    assert_int_equal(layouts_now(), before + LAYOUTS_ADDED_MOST);
}

static void engines_are_copied_while_there_is_room(void **state)
{
    (void)state;
    struct reason reason = {""};
    const struct engine *out = NULL, *last;
    const size_t before = engines_now();
    struct engine one = *engines[0];
    one.name = "one_more";
    for (size_t i = 0; i < ENGINES_ADDED_MOST; i++) {
        one.summary = i % 2 ? "odd" : "even";
        assert_int_equal(engine_add(&one, &out, &reason), STATUS_OK);
        assert_ptr_equal(out, engines[before + i]);
        assert_ptr_not_equal(out, &one);
        assert_memory_equal(out, &one, sizeof one);
        assert_int_equal(engines_now(), before + i + 1);
    }
    one.name = "too_many";
    last = out;
    assert_int_equal(engine_add(&one, &out, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "too_many"));
    assert_ptr_equal(out, last);
    assert_int_equal(engines_now(), before + ENGINES_ADDED_MOST);
    assert_string_equal(engines[before]->summary, "even");
    assert_string_equal(last->name, "one_more");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_layout_is_added_once),
        cmocka_unit_test(engines_are_copied_while_there_is_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
