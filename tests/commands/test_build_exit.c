/* The exit code of raydiff build: one difference, in any tree, layout or refit, is a mismatch. */
#include "cmd/build/cmd_build.h"
#include "ref/base/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define EACH 3u

static void any_difference_is_a_mismatch(void **state)
{
    (void)state;
    static const int codes[] = {EXIT_AGREE, EXIT_SKIPPED, EXIT_MISMATCH, EXIT_ENGINE};
    for (size_t c = 0; c < sizeof codes / sizeof codes[0]; c++)
        for (size_t at = 0; at <= 3 * EACH; at++) {
            static struct build_wide wide[EACH];
            struct build_row row[EACH] = {{.triangles = 1}};
            struct build_refit refit[EACH] = {{.triangles = 1}};
            const struct build_results results = {.row = row,
                                                  .row_count = EACH,
                                                  .wide = wide,
                                                  .wide_count = EACH,
                                                  .refit = refit,
                                                  .refit_count = EACH,
                                                  .code = codes[c]};
            for (size_t i = 0; i < EACH; i++) {
                row[i].differs.stage = at == i ? "order" : NULL;
                wide[i].differs.stage = at == EACH + i ? "words" : NULL;
                refit[i].differing = at == 2 * EACH + i;
            }
            const int want = at == 3 * EACH ? codes[c] : exit_worse(codes[c], EXIT_MISMATCH);
            assert_int_equal(build_exit(&results), want);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_difference_is_a_mismatch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
