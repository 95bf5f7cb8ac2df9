/* Contestants that take turns: whatever the field, each block of trials is played by one of those
 * that share their turns and by all that do not; and which engines are alike. */
#include "fuzz/play/fuzz_turns.h"
#include "gpu/engines/compiled.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

/* Engines of made up fields: alike if their names begin with the same letter. */
static const struct engine made[] = {{.name = "a1"}, {.name = "a2"}, {.name = "b1"},
                                     {.name = "a3"}, {.name = "c1"}, {.name = "b2"},
                                     {.name = "d1"}, {.name = "a4"}};

static bool same_letter(const struct engine *a, const struct engine *b)
{
    return a->name[0] == b->name[0];
}

static bool share(const struct fuzz_field *field, size_t i, size_t k)
{
    return field->who[i].layout == field->who[k].layout &&
           same_letter(field->who[i].engine, field->who[k].engine);
}

static void one_of_those_that_share_plays(void **state)
{
    struct rng rng = rng_make(41, 0);
    (void)state;
    for (int round = 0; round < 300; round++) {
        struct fuzz_field field = {.count = 1 + rng_below(&rng, FUZZ_TURNS)};
        size_t sharing = 0;
        for (size_t i = 0; i < field.count; i++)
            field.who[i] = (struct fuzz_contestant){&made[rng_below(&rng, ARRAY_COUNT(made))],
                                                    layouts_all[rng_below(&rng, 2)]};
        const size_t said = fuzz_turns_share(&field, same_letter);
        for (size_t i = 0; i < field.count; i++) {
            size_t peers = 0, before = 0, turns[FUZZ_CONTESTANTS_MOST] = {0};
            for (size_t k = 0; k < field.count; k++) {
                peers += share(&field, i, k);
                before += k < i && share(&field, i, k);
            }
            sharing += peers > 1;
            assert_true(peers <= FUZZ_TURNS);
            for (uint64_t block = 0; block < 3 * FUZZ_TURNS; block++) {
                const uint32_t waiting = fuzz_turns_waiting(&field, block);
                size_t play = 0;
                for (size_t k = 0; k < field.count; k++)
                    if (share(&field, i, k) && !(waiting >> k & 1u)) {
                        play++;
                        turns[k]++;
                    }
                assert_int_equal(play, 1);
                assert_int_equal(waiting >> field.count, 0);
                assert_int_equal(waiting, fuzz_turns_waiting(&field, block + 5 * FUZZ_TURNS));
            }
            assert_int_equal(turns[i], 3 * (before > 0 ? 1 : FUZZ_TURNS + 1 - peers));
        }
        assert_int_equal(said, sharing);
    }
}

static void more_than_there_are_turns_share_theirs(void **state)
{
    struct fuzz_field field = {.count = FUZZ_TURNS + 3};
    (void)state;
    for (size_t i = 0; i < field.count; i++)
        field.who[i].engine = &made[0];
    assert_int_equal(fuzz_turns_share(&field, same_letter), FUZZ_TURNS + 3);
    for (uint64_t block = 0; block < FUZZ_TURNS; block++) {
        const uint32_t last = FUZZ_TURNS + (block < 6 ? 0 : (uint32_t)block - 5u);
        assert_int_equal(fuzz_turns_waiting(&field, block),
                         ((1u << field.count) - 1u) & ~(1u << block) & ~(1u << last));
    }
}

static void a_field_where_none_do_plays_all(void **state)
{
    struct fuzz_field field = {.count = 9};
    (void)state;
    for (size_t i = 0; i < field.count; i++)
        field.who[i].engine = &made[i % ARRAY_COUNT(made)];
    for (uint64_t block = 0; block < 99; block++)
        assert_int_equal(fuzz_turns_waiting(&field, block), 0);
}

static const struct engine *named(const char *name)
{
    const struct engine *engine = engine_find(name);
    struct reason reason;
    if (!engine)
        assert_int_equal(compiled_engine(name, &engine, &reason), STATUS_OK);
    return engine;
}

static void engines_of_other_memory_alone_are_alike(void **state)
{
    static const char *const name[] = {"vulkan",
                                       "vulkan:texel",
                                       "vulkan:reference",
                                       "vulkan_stackless",
                                       "vulkan:raw:none",
                                       "vulkan:texel:raw:none",
                                       "vulkan_brute",
                                       "vulkan_brute:texel",
                                       "rayquery",
                                       "rayquery:reference",
                                       "cpu"};
    /* The pairs that are, by their numbers above. */
    static const size_t alike[][2] = {{0, 1}, {0, 2}, {1, 2}, {4, 5}, {6, 7}, {8, 9}};
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(name); i++)
        for (size_t k = 0; k < ARRAY_COUNT(name); k++) {
            bool expected = false;
            for (size_t p = 0; p < ARRAY_COUNT(alike); p++)
                expected = expected || (alike[p][0] == i && alike[p][1] == k) ||
                           (alike[p][0] == k && alike[p][1] == i);
            if (compiled_other_memory(named(name[i]), named(name[k])) != expected)
                fail_msg("%s and %s: %s", name[i], name[k], expected ? "not alike" : "alike");
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_of_those_that_share_plays),
        cmocka_unit_test(more_than_there_are_turns_share_theirs),
        cmocka_unit_test(a_field_where_none_do_plays_all),
        cmocka_unit_test(engines_of_other_memory_alone_are_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
