/* Laws of raydiff_shrink: what is left fails, is small, and is the caller's. */
#include "ref/base/float_mode.h"
#include "ref/library/raydiff.h"
#include "scenes/rays/rays.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/library/library_fixture.h"

/* A tracer with a bug: it never finds triangles whose first vertex has a negative x. */
struct buggy {
    uint64_t calls;
    uint64_t stop_after; /* 0: never */
};

static int misses(void *user, const struct raydiff_case *what)
{
    struct buggy *buggy = user;
    struct raydiff_oracle *oracle;
    struct raydiff_nearest exact;
    if (buggy->stop_after && buggy->calls == buggy->stop_after)
        return -1;
    buggy->calls++;
    if (raydiff_oracle_make(what->vertex, what->vertex_count, what->index, what->triangle_count,
                            &oracle, NULL))
        return 0;
    assert_int_equal(raydiff_exact(oracle, what->ray, NULL, 1, 1, &exact, NULL),
                     RAYDIFF_ERROR_NONE);
    raydiff_oracle_free(oracle);
    return exact.kind == RAYDIFF_CLASS_INSIDE &&
           what->vertex[3 * what->index[3 * exact.triangle]] < 0;
}

static int never(void *user, const struct raydiff_case *what)
{
    (void)what;
    ++*(int *)user;
    return 0;
}

/* A case that `misses` fails on. */
static struct raydiff_case failing(const struct library_stand *stand, float ray[8])
{
    struct raydiff_case what = {stand->scene.vertex, stand->scene.index, stand->scene.vertex_count,
                                stand->scene.tri_count, ray};
    struct buggy buggy = {0};
    float many[8 * 200];
    assert_int_equal(raydiff_hard_rays(stand->oracle, "random", 1, 200, many, NULL), 0);
    for (size_t i = 0; i < 200; i++) {
        memcpy(ray, many + 8 * i, 32);
        if (misses(&buggy, &what))
            return what;
    }
    fail_msg("no ray shows the bug");
    return what;
}

static void one_triangle_is_left(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=200");
    float ray[8], before[8];
    const struct raydiff_case what = failing(&stand, ray);
    struct raydiff_small *small, *again;
    struct buggy buggy = {0};
    struct raydiff_why why;
    memcpy(before, ray, sizeof ray);
    if (raydiff_shrink(&what, misses, &buggy, 0, &small, &why))
        fail_msg("%s", why.line);
    assert_string_equal(why.line, "");
    const struct raydiff_case left = raydiff_small_case(small);
    assert_int_equal(left.triangle_count, 1);
    assert_int_equal(left.vertex_count, 3);
    assert_true(misses(&buggy, &left));
    assert_memory_equal(before, ray, sizeof ray); /* what was given is as it was */
    uint32_t plain = 0;
    for (int i = 0; i < 9; i++)
        plain += left.vertex[i] == 0 || left.vertex[i] == 1 || left.vertex[i] == -1;
    assert_true(plain >= 5);
    /* What is small stays so. */
    assert_int_equal(raydiff_shrink(&left, misses, &buggy, 0, &again, NULL), RAYDIFF_ERROR_NONE);
    const struct raydiff_case same = raydiff_small_case(again);
    assert_memory_equal(left.vertex, same.vertex, 9 * sizeof *left.vertex);
    assert_memory_equal(left.ray, same.ray, 8 * sizeof *left.ray);
    raydiff_small_free(again);
    raydiff_small_free(small);
    library_stand_free(&stand);
}

static void calls_are_as_many_as_allowed(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=40");
    float ray[8];
    const struct raydiff_case what = failing(&stand, ray);
    struct raydiff_small *small;
    struct buggy buggy = {0};
    assert_int_equal(raydiff_shrink(&what, misses, &buggy, 10, &small, NULL), RAYDIFF_ERROR_NONE);
    assert_in_range(buggy.calls, 2, 11);
    const struct raydiff_case left = raydiff_small_case(small);
    assert_true(left.triangle_count <= 40);
    assert_true(misses(&buggy, &left));
    raydiff_small_free(small);
    library_stand_free(&stand);
}

static void what_does_not_fail_is_copied(void **state)
{
    (void)state;
    float ray[] = {1, 1, 1, 0, 0, 0, -1, 2};
    const struct raydiff_case what = {library_vertex, library_index, 3, 1, ray};
    struct raydiff_small *small;
    int calls = 0;
    assert_int_equal(raydiff_shrink(&what, never, &calls, 0, &small, NULL), RAYDIFF_ERROR_NONE);
    assert_int_equal(calls, 1);
    const struct raydiff_case left = raydiff_small_case(small);
    assert_int_equal(left.vertex_count, 3);
    assert_int_equal(left.triangle_count, 1);
    assert_memory_equal(left.vertex, library_vertex, sizeof library_vertex);
    assert_memory_equal(left.index, library_index, sizeof library_index);
    assert_memory_equal(left.ray, ray, sizeof ray);
    assert_ptr_not_equal(left.vertex, library_vertex);
    raydiff_small_free(small);
    raydiff_small_free(NULL);
}

static void a_callback_can_end_it(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=40");
    float ray[8];
    const struct raydiff_case what = failing(&stand, ray);
    struct raydiff_small *small = (struct raydiff_small *)(uintptr_t)1;
    struct raydiff_why why;
    struct buggy buggy = {.stop_after = 5};
    assert_int_equal(raydiff_shrink(&what, misses, &buggy, 0, &small, &why), RAYDIFF_ERROR_STOPPED);
    assert_null(small);
    assert_string_equal(why.line, "the callback ended the shrinking");
    assert_int_equal(buggy.calls, 5);
    library_stand_free(&stand);
}

static int notes_modes(void *user, const struct raydiff_case *what)
{
    (void)what;
    *(unsigned long *)user = float_mode() & FLOAT_MODES;
    return 0;
}

static void the_callback_has_its_own_modes(void **state)
{
    (void)state;
    float ray[] = {1, 1, 1, 0, 0, 0, -1, 2};
    const struct raydiff_case what = {library_vertex, library_index, 3, 1, ray};
    struct raydiff_small *small;
    const unsigned long saved = float_mode(), set = FLOAT_FLUSH | FLOAT_UP;
    unsigned long seen = 0;
    float_mode_set(saved | set);
    enum raydiff_error error = raydiff_shrink(&what, notes_modes, &seen, 0, &small, NULL);
    const unsigned long after = float_mode();
    float_mode_set(saved);
    assert_int_equal(error, RAYDIFF_ERROR_NONE);
    assert_int_equal(seen, set);
    assert_int_equal(after & FLOAT_MODES, set);
    raydiff_small_free(small);
}

static void what_is_no_case_is_refused(void **state)
{
    (void)state;
    float ray[] = {1, 1, 1, 0, 0, 0, -1, 2};
    const uint32_t beyond[] = {0, 1, 3};
    struct raydiff_case what = {library_vertex, beyond, 3, 1, ray};
    struct raydiff_small *small;
    struct raydiff_why why;
    int calls = 0;
    assert_int_equal(raydiff_shrink(&what, never, &calls, 0, &small, &why), RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "triangle 0: vertex index 3, but the scene has 3 vertices");
    assert_null(small);
    what.index = library_index;
    what.ray = NULL;
    assert_int_equal(raydiff_shrink(&what, never, &calls, 0, &small, &why), RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "ray: is NULL");
    assert_int_equal(raydiff_shrink(&what, NULL, &calls, 0, &small, &why), RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "fails: is NULL");
    assert_int_equal(raydiff_shrink(NULL, never, &calls, 0, &small, &why), RAYDIFF_ERROR_INPUT);
    assert_int_equal(raydiff_shrink(&what, never, &calls, 0, NULL, &why), RAYDIFF_ERROR_INPUT);
    uint32_t *many = calloc(3 * 131073u, sizeof *many);
    what = (struct raydiff_case){library_vertex, many, 3, 131073, ray};
    assert_int_equal(raydiff_shrink(&what, never, &calls, 0, &small, &why), RAYDIFF_ERROR_LIMIT);
    assert_int_equal(calls, 0);
    free(many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_triangle_is_left),
        cmocka_unit_test(calls_are_as_many_as_allowed),
        cmocka_unit_test(what_does_not_fail_is_copied),
        cmocka_unit_test(a_callback_can_end_it),
        cmocka_unit_test(the_callback_has_its_own_modes),
        cmocka_unit_test(what_is_no_case_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
