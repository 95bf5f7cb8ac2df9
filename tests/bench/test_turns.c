/* Orders of play: each contestant once a round, none twice in a row, each after each other, and
 * from every place to every other as often as chance has it. */
#include "bench/frames/turns.h"

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

/* Who was last begins no round and has every other place alike; the others share what is left. */
static void places_change_as_chance_has_it(void **state)
{
    (void)state;
    for (size_t count = 2; count <= MOST; count++) {
        struct rng rng = rng_make(2, count);
        size_t order[MOST], place[MOST], moves[MOST][MOST] = {{0}};
        double others = (double)count - 1;
        turns_start(order, count);
        for (size_t round = 0; round < ROUNDS; round++) {
            for (size_t i = 0; i < count; i++)
                place[order[i]] = i;
            turns_next(&rng, order, count);
            for (size_t i = 0; i < count; i++)
                moves[place[order[i]]][i]++;
        }
        for (size_t from = 0; from < count; from++)
            for (size_t to = 0; to < count; to++) {
                double share = from == count - 1 ? (to > 0 ? 1 / others : 0)
                               : to == 0         ? 1 / others
                                                 : (others - 1) / (others * others);
                double off = (double)moves[from][to] - share * ROUNDS;
                assert_true(off * off <= 25 * share * ROUNDS); /* 5 deviations */
            }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounds_are_fair),
        cmocka_unit_test(places_change_as_chance_has_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
