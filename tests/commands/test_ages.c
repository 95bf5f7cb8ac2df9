/* How old a finding is on the screen of a campaign: the number is whole units that have passed, the
 * unit the largest of which there are two, and it fits whatever the age. */
#include "cmd/fuzz/cmd_fuzz_screen.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static const struct {
    const char *name;
    uint64_t seconds;
} units[] = {{"s", 1}, {"min", 60}, {"h", 3600}, {"d", 86400}};

#define UNITS (sizeof units / sizeof units[0])

static void check(uint64_t seconds, uint64_t beyond_ns)
{
    char text[16], told[40];
    size_t unit = UNITS - 1;
    while (unit > 0 && seconds < 2 * units[unit].seconds)
        unit--;
    uint64_t number = seconds / units[unit].seconds;
    snprintf(told, sizeof told, "%llu %s", (unsigned long long)(number > 99999 ? 99999 : number),
             units[unit].name);
    fuzz_screen_age(seconds * 1000000000u + beyond_ns, text);
    assert_string_equal(text, told);
}

static void an_age_is_in_the_largest_unit_of_two(void **state)
{
    (void)state;
    for (size_t u = 0; u < UNITS; u++)
        for (uint64_t times = 1; times < 130; times++) {
            check(times * units[u].seconds - 1, 999999999);
            check(times * units[u].seconds, 0);
        }
    check(99999ull * 86400, 0);
    check(100000ull * 86400, 0);
    check(UINT64_MAX / 1000000000u, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(an_age_is_in_the_largest_unit_of_two)};
    return cmocka_run_group_tests_name("ages", tests, NULL, NULL);
}
