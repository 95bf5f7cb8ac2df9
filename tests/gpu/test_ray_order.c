/* Laws of gpu/trace/ray_order.h. */
#include "gpu/trace/ray_order.h"
#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define MOST 700u

static void order_is_by_work_and_keeps_equal_ones(void **state)
{
    (void)state;
    static const uint32_t range[] = {1, 3, 256, 70000, UINT32_MAX};
    struct rng rng = rng_make(3, 0);
    for (uint32_t n = 0; n < 400; n++) {
        uint32_t work[MOST], order[MOST + 1], spare[MOST],
            count = n < 4 ? n : rng_below(&rng, MOST);
        bool seen[MOST] = {false};
        for (uint32_t i = 0; i < count; i++)
            work[i] = rng_below(&rng, range[n % 5]) << (n % 7 == 0 ? 16 : 0);
        order[count] = 12345;
        ray_order_by_work(work, count, order, spare);
        assert_int_equal(order[count], 12345);
        for (uint32_t i = 0; i < count; i++) {
            assert_true(order[i] < count && !seen[order[i]]);
            seen[order[i]] = true;
            if (i > 0)
                assert_true(work[order[i - 1]] < work[order[i]] ||
                            (work[order[i - 1]] == work[order[i]] && order[i - 1] < order[i]));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(order_is_by_work_and_keeps_equal_ones)};
    return cmocka_run_group_tests_name("ray_order", tests, NULL, NULL) ? 1 : 0;
}
