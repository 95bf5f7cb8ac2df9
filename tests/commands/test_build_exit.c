/* The exit code of raydiff build: one difference, in any tree, layout or refit, is a mismatch. */
#include "cmd/build/cmd_build.h"
#include "ref/base/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#define EACH 3u

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

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

/* Of what is measured in rounds each number is told by its median, and so is the ratio of the two
 * sides, which is made round by round; a round that took no time has none. */
static void a_part_is_told_by_the_medians_of_its_rounds(void **state)
{
    (void)state;
    for (uint32_t rounds = 1; rounds <= BUILD_ROUNDS_MOST && rounds < 10; rounds++) {
        double device[10], c[10], ratio[10];
        for (uint32_t r = 0; r < rounds; r++) { /* the ratios are in another order than the sides */
            device[r] = 1e6 * (3 + (r * 7 + 2) % 11);
            c[r] = r == 4 ? 0 : 1e6 * (1 + (r * 5 + 1) % 13);
            ratio[r] = r == 4 ? 0 : device[r] / c[r];
        }
        const struct build_part part = build_part_of(device, c, rounds);
        const double told[] = {part.device_ms, part.c_ms, part.ratio};
        double *const rows[] = {device, c, ratio};
        for (int k = 0; k < 3; k++) {
            qsort(rows[k], rounds, sizeof(double), by_size);
            double median = 0.5 * (rows[k][(rounds - 1) / 2] + rows[k][rounds / 2]);
            assert_true(fabs(told[k] - (k < 2 ? 1e-6 : 1) * median) < 1e-9 * median);
        }
        assert_true(part.ratio_least == ratio[0] && part.ratio_most == ratio[rounds - 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_difference_is_a_mismatch),
        cmocka_unit_test(a_part_is_told_by_the_medians_of_its_rounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
