/* Covering arrays: every pair meets, with few rows. */
#include "fuzz/gen/covering.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Pairs of members of different tables that are in no row, counted without the maker's books. */
static uint64_t pairs_missing(const struct covering *c, const uint32_t *members)
{
    uint64_t missing = 0;
    for (uint32_t a = 0; a < c->tables; a++)
        for (uint32_t b = a + 1; b < c->tables; b++) {
            uint8_t *met = calloc((size_t)members[a] * members[b], 1);
            assert_non_null(met);
            for (uint32_t r = 0; r < c->rows; r++) {
                uint32_t i = c->member[r * c->tables + a], j = c->member[r * c->tables + b];
                assert_true(i < members[a] && j < members[b]);
                met[i * members[b] + j] = 1;
            }
            for (size_t k = 0; k < (size_t)members[a] * members[b]; k++)
                missing += !met[k];
            free(met);
        }
    return missing;
}

static void every_pair_meets(void **state)
{
    static const struct {
        uint32_t tables, members[8], most; /* rows: at most so many */
    } cases[] = {
        {2, {1, 1}, 1},
        {2, {7, 5}, 35},
        {3, {2, 2, 2}, 6},
        {4, {3, 3, 3, 3}, 15},
        {3, {1, 9, 1}, 9},
        {8, {2, 2, 2, 2, 2, 2, 2, 2}, 10},
        {5, {9, 70, 3, 5, 5}, 680},
        {8, {5, 70, 9, 3, 5, 2, 10, 9}, 800},
    };
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct covering c, again;
        assert_int_equal(covering_make(cases[i].members, cases[i].tables, &c, NULL), STATUS_OK);
        assert_int_equal(pairs_missing(&c, cases[i].members), 0);
        if (c.rows > cases[i].most)
            fail_msg("case %zu: %u rows, not at most %u", i, c.rows, cases[i].most);
        assert_int_equal(covering_make(cases[i].members, cases[i].tables, &again, NULL), STATUS_OK);
        assert_int_equal(c.rows, again.rows);
        assert_memory_equal(c.member, again.member, (size_t)c.rows * c.tables * sizeof *c.member);
        covering_free(&c);
        covering_free(&again);
    }
}

static void bad_tables_are_refused(void **state)
{
    static const uint32_t empty[] = {3, 0, 2}, large[] = {2, 65536};
    uint32_t many[COVERING_TABLES_MOST + 1];
    struct covering c = {.rows = 7};
    struct reason reason;
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(many); i++)
        many[i] = 2;
    assert_int_equal(covering_make(empty, 3, &c, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "table 1 has 0 members"));
    assert_int_equal(c.rows, 0);
    assert_int_equal(covering_make(large, 2, &c, &reason), STATUS_INPUT);
    assert_int_equal(covering_make(large, 1, &c, &reason), STATUS_INPUT);
    assert_int_equal(covering_make(many, ARRAY_COUNT(many), &c, &reason), STATUS_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pair_meets),
        cmocka_unit_test(bad_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
