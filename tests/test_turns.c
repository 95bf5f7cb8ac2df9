/* Orders of play: everybody once a round, nobody twice in a row, everybody after everybody. */
#include "bench/turns.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define MOST   7
#define ROUNDS 2000

static void rounds_are_fair(void **state)
{
    (void)state;
    for (size_t count = 1; count <= MOST; count++) {
        struct rng rng = rng_make(1, count);
        size_t order[MOST], follows[MOST][MOST] = {{0}}, last = MOST;
        turns_start(order, count);
        for (size_t round = 0; round < ROUNDS; round++) {
            unsigned seen = 0;
            turns_next(&rng, order, count);
            for (size_t i = 0; i < count; i++) {
                seen |= 1u << order[i];
                if (last < MOST)
                    follows[order[i]][last]++;
                last = order[i];
            }
            assert_int_equal(seen, (1u << count) - 1);
        }
        for (size_t a = 0; a < count && count > 1; a++)
            for (size_t b = 0; b < count; b++)
                if (a == b)
                    assert_int_equal(follows[a][b], 0);
                else
                    assert_true(follows[a][b] > ROUNDS / count / 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounds_are_fair),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
