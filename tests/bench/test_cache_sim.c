/* The simulated cache: what patterns whose misses are known by hand read from beyond each level. */
#include "tests/support/allocations.h"

#include "bench/measure/cache_sim.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#define LINE CACHE_SIM_LINE

static struct cache_sim made(uint32_t sets1, uint32_t ways1, uint32_t sets2, uint32_t ways2)
{
    const struct cache_size size[CACHE_SIM_LEVELS] = {{sets1, ways1}, {sets2, ways2}};
    struct cache_sim cache;
    struct reason reason;
    assert_int_equal(cache_sim_make(size, &cache, &reason), STATUS_OK);
    return cache;
}

static void expect(const struct cache_sim *cache, uint64_t lines, uint64_t first, uint64_t second)
{
    assert_int_equal(cache->counts.lines, lines);
    assert_int_equal(cache->counts.beyond[0], first);
    assert_int_equal(cache->counts.beyond[1], second);
}

static void a_read_touches_each_line_that_it_has_bytes_in(void **state)
{
    (void)state;
    struct cache_sim cache = made(64, 12, 1024, 16);
    cache_sim_read(&cache, 0, 0);
    expect(&cache, 0, 0, 0);
    cache_sim_read(&cache, 63, 1);
    expect(&cache, 1, 1, 1);
    cache_sim_read(&cache, 63, 2); /* the first again, and the second */
    expect(&cache, 3, 2, 2);
    cache_sim_read(&cache, 10 * LINE, 4 * LINE);
    expect(&cache, 7, 6, 6);
    cache_sim_read(&cache, 20 * LINE + 1, 4 * LINE); /* one more at the end */
    expect(&cache, 12, 11, 11);
    cache_sim_free(&cache);
}

/* n lines around and around: all are found from the second time on if they fit, none if there is
 * one more than a set holds. */
static void a_loop_fits_or_misses_always(void **state)
{
    (void)state;
    for (int more = 0; more < 2; more++) {
        struct cache_sim cache = made(4, 3, 16, 16);
        uint64_t lines = 12 + (more ? 4 : 0); /* a fourth in each set */
        for (int turn = 0; turn < 5; turn++)
            for (uint64_t i = 0; i < lines; i++)
                cache_sim_read(&cache, i * LINE, LINE);
        expect(&cache, 5 * lines, more ? 5 * lines : lines, lines);
        cache_sim_free(&cache);
    }
}

static void lines_of_other_sets_drop_nothing(void **state)
{
    (void)state;
    struct cache_sim cache = made(4, 1, 8, 1);
    cache_sim_read(&cache, 0, 1);
    for (uint64_t i = 1; i < 4; i++)
        cache_sim_read(&cache, i * LINE, 1);
    cache_sim_restart(&cache);
    cache_sim_read(&cache, 0, 1);
    expect(&cache, 1, 0, 0);
    cache_sim_read(&cache, 4 * LINE, 1); /* the same set of level 1, another of level 2 */
    cache_sim_read(&cache, 0, 1);
    expect(&cache, 3, 2, 1);
    cache_sim_free(&cache);
}

/* Two ways: a, b, a, c drops b, since a was used since; by age it would drop a. */
static void the_least_recently_used_goes(void **state)
{
    (void)state;
    struct cache_sim cache = made(1, 2, 1, 1);
    const uint64_t order[] = {0, 1, 0, 2};
    for (size_t i = 0; i < ARRAY_COUNT(order); i++)
        cache_sim_read(&cache, order[i] * LINE, 1);
    cache_sim_restart(&cache);
    cache_sim_read(&cache, 0, 1);
    expect(&cache, 1, 0, 0);
    cache_sim_read(&cache, LINE, 1);
    expect(&cache, 2, 1, 1);
    cache_sim_free(&cache);
}

/* Against the definition: a line is found if fewer than `ways` others of its set were read since.
 */
static void random_reads_are_as_defined(void **state)
{
    (void)state;
    enum { READS = 4000, SETS = 8, WAYS = 3 };
    static uint64_t line[READS];
    struct cache_sim cache = made(SETS, WAYS, 1, 1);
    uint64_t seed = 1, missed = 0;
    for (size_t i = 0; i < READS; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        line[i] = seed >> 33 & 63;
        uint64_t others = 0, seen = 0;
        bool found = false;
        for (size_t k = i; k-- > 0 && !found;) {
            found = line[k] == line[i];
            if (line[k] % SETS == line[i] % SETS && !found && !(seen >> line[k] & 1)) {
                seen |= (uint64_t)1 << line[k];
                others++;
            }
        }
        missed += !(found && others < WAYS);
        cache_sim_read(&cache, line[i] * LINE, LINE);
        assert_int_equal(cache.counts.beyond[0], missed);
    }
    assert_in_range(missed, READS / 4, READS);
    cache_sim_free(&cache);
}

static void sizes_that_are_none_are_refused(void **state)
{
    (void)state;
    static const struct cache_size bad[][CACHE_SIM_LEVELS] = {
        {{3, 1}, {8, 1}}, {{0, 1}, {8, 1}}, {{4, 1}, {8, 0}}};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct cache_sim cache;
        struct reason reason;
        assert_int_equal(cache_sim_make(bad[i], &cache, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "power of 2"));
        assert_null(cache.tag[0]);
    }
}

static void what_was_made_is_given_back(void **state)
{
    (void)state;
    long before = atomic_load(&held);
    struct cache_sim cache = made(8, 3, 16, 2);
    assert_true(atomic_load(&held) > before);
    cache_sim_free(&cache);
    assert_int_equal(atomic_load(&held), before);
    for (long n = 0; n < CACHE_SIM_LEVELS; n++) {
        const struct cache_size size[CACHE_SIM_LEVELS] = {{8, 3}, {16, 2}};
        struct reason reason;
        fail_after(n);
        assert_int_equal(cache_sim_make(size, &cache, &reason), STATUS_MEMORY);
        fail_after(-1);
        assert_int_equal(atomic_load(&held), before);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_read_touches_each_line_that_it_has_bytes_in),
        cmocka_unit_test(a_loop_fits_or_misses_always),
        cmocka_unit_test(lines_of_other_sets_drop_nothing),
        cmocka_unit_test(the_least_recently_used_goes),
        cmocka_unit_test(random_reads_are_as_defined),
        cmocka_unit_test(sizes_that_are_none_are_refused),
        cmocka_unit_test(what_was_made_is_given_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
