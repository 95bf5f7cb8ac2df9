/* A known defect of a hard case is known by its cause, too: where explain finds another, the trial
 * fails, whichever the other is. The table's causes are changed for it. */
#include "cmd/conform/cmd_conform_hard.h"
#include "ref/base/command.h"
#include "tests/hard/hard.h"
#include "tests/hard/members.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>

static enum cause said; /* in place of what the table says; CAUSE_NONE: as it says */

const struct hard_defect *__real_hard_defect_of(const struct hard_case *one,
                                                const struct hard_member *member);
const struct hard_defect *__wrap_hard_defect_of(const struct hard_case *one,
                                                const struct hard_member *member);

const struct hard_defect *__wrap_hard_defect_of(const struct hard_case *one,
                                                const struct hard_member *member)
{
    static struct hard_defect other;
    const struct hard_defect *is = __real_hard_defect_of(one, member);
    if (!is || is->cause == CAUSE_NONE || said == CAUSE_NONE)
        return is;
    other = *is;
    other.cause = said;
    return &other;
}

static int played(const char *pattern)
{
    const struct list named[TABLE_COUNT] = {{.count = 0}};
    const struct conform_options options = {
        .pattern = pattern, .hard = true, .engines = engine_options_default()};
    return conform_hard(&options, named);
}

static void another_cause_is_a_failure(void **state)
{
    (void)state;
    static const char pattern[] = "hard.35-flat-far.closest.cpu.f32.median.rtrs.mt";
    static const struct {
        enum cause cause;
        int code;
    } cases[] = {{CAUSE_NONE, EXIT_AGREE},
                 {CAUSE_STRICT_COMPARISON, EXIT_AGREE},
                 {CAUSE_PARALLEL_AXIS, EXIT_MISMATCH},
                 {(enum cause)(CAUSE_COUNT - 1), EXIT_MISMATCH}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        said = cases[i].cause;
        assert_int_equal(played(pattern), cases[i].code);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(another_cause_is_a_failure)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
