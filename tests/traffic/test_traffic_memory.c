/* The modelled memory: against a second one, access by access; and laws. */
#include "ref/base/rng.h"
#include "tests/traffic/plain_memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static struct traffic_memory make(const struct traffic_memory_size *size)
{
    struct traffic_memory memory;
    struct reason reason = {""};
    if (traffic_memory_make(size, &memory, &reason))
        fail_msg("%s", reason.text);
    return memory;
}

static uint64_t cause_sum(const uint64_t *array, enum traffic_cause cause)
{
    uint64_t sum = 0;
    for (int a = 0; a < TRAFFIC_ARRAYS; a++)
        sum += traffic_cause_of((enum traffic_array)a) == cause ? array[a] : 0;
    return sum;
}

static void assert_same(const struct traffic_memory *a, const struct plain_memory *b)
{
    for (int level = 0; level < TRAFFIC_LEVELS; level++)
        for (int cause = 0; cause < TRAFFIC_CAUSES; cause++) {
            enum traffic_cause c = (enum traffic_cause)cause;
            assert_int_equal(a->count[level].in[cause], cause_sum(b->in[level], c));
            assert_int_equal(a->count[level].out[cause], cause_sum(b->out[level], c));
        }
    assert_int_equal(a->count[0].misses, b->missed[0]);
    assert_int_equal(a->count[1].misses, b->missed[1]);
    assert_int_equal(a->row_hits, b->row_hits);
    assert_int_equal(a->row_misses, b->row_misses);
}

/* A random size: 1 to 8 sets and ways, lines of 16 to 256 bytes. */
static struct traffic_memory_size draw_size(struct rng *rng)
{
    struct traffic_memory_size size = {.units = 1 + rng_below(rng, 3)};
    size.row_bytes = 64u << rng_below(rng, 4);
    for (int i = 0; i < TRAFFIC_CACHES; i++) {
        uint32_t sets = 1u << rng_below(rng, 4);
        size.cache[i].ways = 1u << rng_below(rng, 4);
        size.cache[i].line = 16u << rng_below(rng, 5);
        size.cache[i].bytes = (uint64_t)sets * size.cache[i].ways * size.cache[i].line;
    }
    return size;
}

static void it_counts_as_a_second_model_does(void **state)
{
    (void)state;
    for (uint64_t trial = 0; trial < 200; trial++) {
        struct rng rng = rng_make(trial, 7);
        struct traffic_memory_size size = draw_size(&rng);
        struct traffic_memory a = make(&size);
        struct plain_memory b = plain_make(&size);
        uint32_t span = 64u << rng_below(&rng, 7);
        for (int i = 0; i < 400; i++) {
            uint32_t unit = rng_below(&rng, size.units), offset = rng_below(&rng, span);
            enum traffic_array array = (enum traffic_array)rng_below(&rng, TRAFFIC_ARRAYS);
            uint32_t bytes = rng_below(&rng, 100);
            bool write = rng_below(&rng, 3) == 0;
            traffic_access(&a, unit, TRAFFIC_L1, array, offset, bytes, write);
            plain_access(&b, unit, array, offset, bytes, write);
            assert_same(&a, &b);
        }
        assert_true(traffic_conserved(&a, true));
        traffic_flush(&a);
        plain_flush(&b);
        /* Which lines of level 2 make room for those of level 1 depends on their order. */
        for (int c = 0; c < TRAFFIC_CAUSES; c++)
            assert_int_equal(a.count[TRAFFIC_L2].out[c],
                             cause_sum(b.out[TRAFFIC_L2], (enum traffic_cause)c));
        traffic_memory_free(&a);
        plain_free(&b);
    }
}

/* Whichever number is other than the rest has it, that is seen. */
static void what_is_not_conserved_is_seen(void **state)
{
    (void)state;
    const struct traffic_memory_size size = {
        .cache = {{256, 2, 64}, {1024, 2, 64}}, .units = 1, .row_bytes = 256};
    struct traffic_memory m = make(&size);
    struct rng rng = rng_make(3, 7);
    for (int i = 0; i < 400; i++) {
        enum traffic_array array = (enum traffic_array)rng_below(&rng, TRAFFIC_ARRAYS);
        uint32_t offset = rng_below(&rng, 4096);
        traffic_access(&m, 0, TRAFFIC_L1, array, offset, 1 + (uint32_t)i % 99, i % 3 == 0);
    }
    uint64_t *number[3 * (2 * TRAFFIC_CAUSES + 2) + 2] = {&m.row_hits, &m.row_misses};
    size_t count = 2;
    for (int level = 0; level < TRAFFIC_LEVELS; level++) {
        struct traffic_count *one = &m.count[level];
        assert_true(one->read > 0 && one->written > 0);
        number[count++] = &one->read;
        number[count++] = &one->written;
        for (int cause = 0; cause < TRAFFIC_CAUSES; cause++) {
            number[count++] = &one->in[cause];
            number[count++] = &one->out[cause];
        }
    }
    assert_int_equal(count, ARRAY_COUNT(number));
    for (int cached = 0; cached < 2; cached++)
        for (size_t i = 0; i < count; i++) {
            assert_true(traffic_conserved(&m, cached));
            *number[i] += 64;
            assert_false(traffic_conserved(&m, cached));
            *number[i] -= 64;
        }
    /* Sums that hold, of what no line of level 1 brought: only caches tell. */
    struct traffic_count *second = &m.count[TRAFFIC_L2];
    uint64_t *const sums[2][2] = {{&second->read, &second->in[TRAFFIC_RAYS]},
                                  {&second->written, &second->out[TRAFFIC_HITS]}};
    const uint64_t more[] = {4, 64 * (m.count[TRAFFIC_L1].misses + 1)};
    for (int way = 0; way < 2; way++)
        for (size_t i = 0; i < ARRAY_COUNT(more); i++) {
            *sums[way][0] += more[i], *sums[way][1] += more[i];
            assert_false(traffic_conserved(&m, true));
            assert_true(traffic_conserved(&m, false));
            *sums[way][0] -= more[i], *sums[way][1] -= more[i];
        }
    traffic_memory_free(&m);
}

/* Of an infinite cache DRAM gives each burst once; of smaller ones no fewer. */
static void larger_caches_read_no_more_and_the_largest_the_working_set(void **state)
{
    (void)state;
    for (uint64_t trial = 0; trial < 20; trial++) {
        uint64_t before = UINT64_MAX, set = 0;
        /* One set, so that a larger one holds what a smaller one does. */
        for (uint32_t ways = 1; ways <= 1024; ways *= 4) {
            struct traffic_memory_size size = {
                .cache = {{64, 1, 64}, {64 * ways, ways, 64}}, .units = 1, .row_bytes = 256};
            struct traffic_memory m = make(&size);
            struct rng rng = rng_make(trial, 9);
            for (int i = 0; i < 3000; i++) {
                enum traffic_array array = (enum traffic_array)rng_below(&rng, 4);
                uint32_t offset = rng_below(&rng, 8000);
                traffic_access(&m, 0, TRAFFIC_L1, array, offset, 1 + rng_below(&rng, 60), false);
            }
            uint64_t read = m.count[TRAFFIC_DRAM].read;
            assert_true(read <= before);
            assert_true(read >= traffic_working_set(&m));
            assert_true(set == 0 || set == traffic_working_set(&m));
            before = read;
            set = traffic_working_set(&m);
            if (ways == 1024)
                assert_int_equal(read, set);
            traffic_memory_free(&m);
        }
    }
}

/* Lines longer than a burst are several, shorter ones take a whole one. */
static void dram_moves_bursts(void **state)
{
    (void)state;
    static const struct {
        uint32_t line, bursts;
    } of[] = {{16, 1}, {64, 1}, {128, 2}, {512, 8}};
    for (size_t i = 0; i < ARRAY_COUNT(of); i++) {
        struct traffic_memory_size size = {
            .cache = {{of[i].line, 1, of[i].line}, {of[i].line, 1, of[i].line}},
            .units = 1,
            .row_bytes = 4096};
        struct traffic_memory m = make(&size);
        traffic_access(&m, 0, TRAFFIC_L1, TRAFFIC_AT_NODES, 4, 4, false);
        assert_int_equal(m.count[TRAFFIC_L1].read, 4);
        assert_int_equal(m.count[TRAFFIC_L2].read, of[i].line);
        assert_int_equal(m.count[TRAFFIC_DRAM].read, 64 * of[i].bursts);
        assert_int_equal(m.row_misses, 1);
        assert_int_equal(m.row_hits, of[i].bursts - 1);
        traffic_memory_free(&m);
    }
}

/* A stream past the caches opens each row once; arrays far apart take turns in a bank. */
static void a_stream_finds_its_rows_open(void **state)
{
    (void)state;
    struct traffic_memory_size size = {
        .cache = {{64, 1, 64}, {64, 1, 64}}, .units = 1, .row_bytes = 1024};
    struct traffic_memory m = make(&size);
    traffic_access(&m, 0, TRAFFIC_DRAM, TRAFFIC_AT_RAYS, 0, 64 * 1024, true);
    assert_int_equal(m.row_misses, 64);
    assert_int_equal(m.row_hits, 1024 - 64);
    assert_int_equal(m.count[TRAFFIC_DRAM].out[TRAFFIC_RAYS], 64 * 1024);
    assert_int_equal(m.count[TRAFFIC_L1].lookups + m.count[TRAFFIC_L2].lookups, 0);
    for (int i = 0; i < 10; i++) {
        traffic_access(&m, 0, TRAFFIC_DRAM, TRAFFIC_AT_NODES, 0, 64, false);
        traffic_access(&m, 0, TRAFFIC_DRAM, TRAFFIC_AT_HITS, 0, 64, false);
    }
    assert_int_equal(m.row_misses, 64 + 20);
    assert_int_equal(traffic_working_set(&m), 64);
    traffic_memory_free(&m);
}

/* What one unit read misses for another in level 1, not in level 2. */
static void level_1_is_private_and_level_2_is_shared(void **state)
{
    (void)state;
    struct traffic_memory_size size = {
        .cache = {{1024, 2, 64}, {4096, 4, 64}}, .units = 3, .row_bytes = 1024};
    struct traffic_memory m = make(&size);
    for (int round = 0; round < 2; round++)
        for (uint32_t unit = 0; unit < 3; unit++)
            traffic_access(&m, unit, TRAFFIC_L1, TRAFFIC_AT_ITEMS, 640, 64, false);
    assert_int_equal(m.count[TRAFFIC_L1].misses, 3);
    assert_int_equal(m.count[TRAFFIC_L2].misses, 1);
    assert_int_equal(m.count[TRAFFIC_DRAM].in[TRAFFIC_TRIANGLES], 64);
    traffic_memory_free(&m);
}

/* Of arrays of any size: bursts that are far apart, in any order and read again, are each one. */
static void the_working_set_has_every_burst_once(void **state)
{
    (void)state;
    enum { BURSTS = 500 };
    static const struct traffic_memory_size tiny = {
        .cache = {{64, 1, 64}, {64, 1, 64}}, .units = 1, .row_bytes = 256};
    for (uint64_t apart = 64; apart <= 64u << 16; apart *= 4) {
        struct traffic_memory m = make(&tiny);
        struct rng rng = rng_make(apart, 2);
        bool read[4][BURSTS] = {{false}};
        uint64_t bursts = 0;
        for (int i = 0; i < 3000; i++) {
            uint32_t array = rng_below(&rng, 4), number = rng_below(&rng, BURSTS);
            traffic_access(&m, 0, TRAFFIC_L1, (enum traffic_array)array, number * apart, 4, false);
            bursts += !read[array][number];
            read[array][number] = true;
            assert_int_equal(traffic_working_set(&m), bursts * TRAFFIC_BURST);
        }
        traffic_memory_free(&m);
    }
}

static void wrong_sizes_are_named(void **state)
{
    (void)state;
    static const struct {
        struct traffic_memory_size size;
        const char *rule;
    } wrong[] = {
        {{{{96, 1, 32}, {64, 1, 64}}, 1, 64}, "level 1 of 96 bytes"},
        {{{{64, 1, 64}, {64, 3, 64}}, 1, 64}, "level 2 of 64 bytes, 3 ways"},
        {{{{64, 1, 48}, {64, 1, 64}}, 1, 64}, "a line is a power of two"},
        {{{{64, 1, 2}, {64, 1, 64}}, 1, 64}, "4 bytes or more"},
        {{{{64, 1, 128}, {64, 1, 64}}, 1, 64}, "not smaller than a line"},
        {{{{64, 4, 32}, {64, 1, 64}}, 1, 64}, "its ways of lines"},
        {{{{0, 1, 64}, {64, 1, 64}}, 1, 64}, "a size is a power of two"},
        {{{{64, 1, 64}, {64, 1, 64}}, 0, 64}, "at least one unit"},
        {{{{64, 1, 64}, {64, 1, 64}}, 1, 32}, "rows of 32 bytes"},
        {{{{64, 1, 64}, {64, 1, 64}}, 1, 96}, "rows of 96 bytes"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        struct traffic_memory memory;
        struct reason reason = {""};
        assert_int_equal(traffic_memory_make(&wrong[i].size, &memory, &reason), STATUS_INPUT);
        if (!strstr(reason.text, wrong[i].rule))
            fail_msg("%s: not %s", reason.text, wrong[i].rule);
        assert_null(memory.cache);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_counts_as_a_second_model_does),
        cmocka_unit_test(what_is_not_conserved_is_seen),
        cmocka_unit_test(larger_caches_read_no_more_and_the_largest_the_working_set),
        cmocka_unit_test(dram_moves_bursts),
        cmocka_unit_test(a_stream_finds_its_rows_open),
        cmocka_unit_test(level_1_is_private_and_level_2_is_shared),
        cmocka_unit_test(the_working_set_has_every_burst_once),
        cmocka_unit_test(wrong_sizes_are_named),
    };
    return cmocka_run_group_tests_name("traffic_memory", tests, NULL, NULL) ? 1 : 0;
}
