/* Scatters as sets: what is in them, and what is asked about them. */
#include "tests/trace/scatter_cases.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Numbers, those of one list or of another, and what is asked about them. */
static void lists_are_sets_of_numbers(void **state)
{
    (void)state;
    struct rng rng = rng_make(17, 0);
    for (int i = 0; i < 5000; i++) {
        struct scatter a = drawn_list(&rng), b = drawn_list(&rng), both = scatter_either(&a, &b);
        struct scatter minus = scatter_negate(&both), range = range_of(&b), open;
        double least = INFINITY;
        for (int n = 0; n < a.count + b.count; n++) {
            double x = n < a.count ? a.value[n] : b.value[n - a.count];
            int at = 0;
            while (at < both.count && both.value[at] != x)
                at++;
            assert_true(at < both.count);
            assert_true(minus.value[both.count - 1 - at] == -x);
            least = fmin(least, fabs(x));
        }
        assert_true(both.count <= a.count + b.count && minus.count == both.count);
        for (int n = 1; n < both.count; n++)
            assert_true(both.value[n - 1] < both.value[n]);
        assert_true(both.lo == both.value[0] && both.hi == both.value[both.count - 1]);
        assert_true(minus.lo == -both.hi && minus.hi == -both.lo && minus.grid == both.grid);
        assert_int_equal(both.grid, a.grid < b.grid ? a.grid : b.grid);
        assert_true(scatter_least(&both) == least && !scatter_has_zero(&both));
        open = scatter_either(&a, &range);
        assert_true(open.count == 0 && open.lo == both.lo && open.hi == both.hi);
        open = scatter_either(&range, &a);
        assert_true(open.count == 0 && open.lo == both.lo && open.hi == both.hi);
        assert_true(scatter_has_zero(&open) == (open.lo <= 0.0 && open.hi >= 0.0));
        double nearest = open.lo > 0.0 ? open.lo : open.hi < 0.0 ? -open.hi : ldexp(1.0, open.grid);
        assert_true(scatter_least(&open) == nearest);
    }
    const struct scatter ends[] = {{.lo = 0, .hi = 1, .grid = -3}, {.lo = -1, .hi = 0, .grid = -3}};
    for (int i = 0; i < 2; i++)
        assert_true(scatter_has_zero(&ends[i]) && scatter_least(&ends[i]) == 0.125 &&
                    !scatter_is_zero(&ends[i]));
    const struct scatter zero = scatter_of(-0.0f), one = scatter_of(1.0f);
    const struct scatter both = scatter_either(&one, &zero);
    assert_true(scatter_least(&zero) == INFINITY && scatter_least(&both) == 1.0);
    assert_true(scatter_has_zero(&both) && !signbit(both.value[0]));
}

/* As many as fit, and one more. */
static void a_list_that_is_full_is_a_range(void **state)
{
    (void)state;
    struct scatter s = scatter_of(1.0f);
    for (int i = 2; i <= SCATTER_MOST + 1; i++) {
        struct scatter next = scatter_of((float)i);
        s = scatter_either(&s, &next);
        assert_int_equal(s.count, i <= SCATTER_MOST ? i : 0);
        assert_true(s.lo == 1.0 && s.hi == (double)i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_sets_of_numbers),
        cmocka_unit_test(a_list_that_is_full_is_a_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
