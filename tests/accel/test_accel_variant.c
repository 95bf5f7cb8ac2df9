/* How variants of rayquery are called: what is written is read as the same, and what is none is
 * refused by one line. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu/accel/accel_format.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

static struct accel_variant parsed(const char *name)
{
    struct accel_variant variant;
    struct reason reason = {""};
    if (accel_parse(name, &variant, &reason))
        fail_msg("%s: %s", name, reason.text);
    return variant;
}

static void expect_name(const struct accel_variant *variant, const char *want)
{
    char name[ACCEL_NAME_MOST];
    accel_write(variant, name);
    assert_string_equal(name, want);
}

/* A variant of every choice of one axis with one of the next, and random ones. */
static struct accel_variant drawn(uint32_t *seed)
{
    struct accel_variant v = {.split = 0};
    uint32_t x = *seed = *seed * 1664525u + 1013904223u;
    x ^= x >> 15;
    v.how.fast_trace = x % 3 == 1;
    v.how.fast_build = x % 3 == 2;
    v.how.low_memory = x & 8;
    v.how.update = (enum vk_accel_update)(x / 16 % VK_ACCEL_UPDATES);
    v.how.copy = (enum vk_accel_copy)(x / 64 % VK_ACCEL_COPIES);
    v.how.where = (enum vk_accel_where)(x / 512 % VK_ACCEL_WHERES);
    v.how.allow_update = v.how.update == VK_ACCEL_UPDATE_NONE && (x & 2048);
    v.how.allow_compaction = v.how.copy != VK_ACCEL_COPY_COMPACT && (x & 4096);
    v.transform = (enum accel_transform)(x / 8192 % ACCEL_TRANSFORMS);
    v.index = (enum accel_index)(x / 32768 % ACCEL_INDICES);
    v.format = (enum accel_format)(x / 131072 % ACCEL_FORMATS);
    v.split = x & 1 ? 2 + x % 63 : 0;
    v.stride = x & 2 ? 48 + 24 * (x % 5) : 0;
    v.offset = x & 4;
    v.first_vertex = x & 16;
    v.degenerate = x & 32;
    v.nan = accel_format[v.format].nan && (x & 64);
    return v;
}

static void what_is_written_is_read_as_the_same(void **state)
{
    (void)state;
    uint32_t seed = 1;
    size_t copies = 0;
    for (int i = 0; i < 20000; i++) {
        const struct accel_variant variant = drawn(&seed);
        struct accel_variant original;
        char name[ACCEL_NAME_MOST];
        accel_write(&variant, name);
        assert_true(strlen(name) + 1 < ACCEL_NAME_MOST);
        if (!accel_is_named(name)) {
            assert_string_equal(name, "rayquery");
            continue;
        }
        const struct accel_variant again = parsed(name);
        expect_name(&again, name);
        assert_int_equal(again.how.copy, variant.how.copy);
        assert_int_equal(again.format, variant.format);
        assert_int_equal(again.stride, variant.stride);
        assert_int_equal(again.split, variant.split);
        const bool copy = accel_original(&variant, &original);
        assert_true(copy == (variant.how.copy != VK_ACCEL_COPY_NONE));
        assert_int_equal(original.how.copy, VK_ACCEL_COPY_NONE);
        assert_true(variant.how.copy != VK_ACCEL_COPY_COMPACT || original.how.allow_compaction);
        copies += copy;
    }
    assert_true(copies > 5000);
}

/* Words of the triangles make a form, words of how they are built make none. One word is enough,
 * whatever stands beside it. */
static void a_form_is_what_is_left_of_a_name_without_flags(void **state)
{
    (void)state;
    static const char *const alone[] = {"f16x4",  "u16",   "unindexed",    "stride20",   "split7",
                                        "offset", "moved", "first_vertex", "degenerate", "nan"};
    uint32_t seed = 7;
    for (int i = 0; i < 20000; i++) {
        const struct accel_variant variant = drawn(&seed);
        struct accel_variant bare = variant;
        char name[ACCEL_NAME_MOST];
        memset(&bare.how, 0, sizeof bare.how);
        accel_write(&bare, name);
        assert_int_equal(accel_has_form(&variant), strcmp(name, "rayquery") != 0);
    }
    for (size_t i = 0; i < ARRAY_COUNT(alone); i++) {
        char name[ACCEL_NAME_MOST];
        snprintf(name, sizeof name, "rayquery:fast_build:%s", alone[i]);
        const struct accel_variant variant = parsed(name);
        assert_true(accel_has_form(&variant));
    }
}

static void words_stand_in_any_order_and_lose_what_changes_nothing(void **state)
{
    (void)state;
    static const char *const same[][2] = {
        {"rayquery:u16:compact:stride20:update:fast_build",
         "rayquery:fast_build:update:compact:u16:stride20"},
        {"rayquery:stride12", "rayquery"},
        {"rayquery:stride4096", "rayquery:stride4096"},
        {"rayquery:f16x4:stride8", "rayquery:f16x4"},
        {"rayquery:allow_update:update_into", "rayquery:update_into"},
        {"rayquery:compact:allow_compaction", "rayquery:compact"},
        {"rayquery:nan:offset:split64", "rayquery:split64:offset:nan"},
        {"rayquery:serialise_new", "rayquery:serialise_new"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
        const struct accel_variant variant = parsed(same[i][0]);
        expect_name(&variant, same[i][1]);
    }
}

static void what_is_no_variant_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *why;
    } none[] = {
        {"rayquery:", "no word for a variant"},
        {"rayquery:u17", "'u17' is no word for a variant"},
        {"rayquery:u16:", "'' is no word"},
        {"rayquery:u16:u16", "second of its kind"},
        {"rayquery:u16:unindexed", "second of its kind"},
        {"rayquery:fast_trace:fast_build", "second of its kind"},
        {"rayquery:clone:compact", "second of its kind"},
        {"rayquery:update:update_into", "second of its kind"},
        {"rayquery:stride", "'stride' is no word"},
        {"rayquery:stride016", "no word"},
        {"rayquery:stride99999", "no word"},
        {"rayquery:stride4100", "from 12 to 4096"},
        {"rayquery:stride8", "multiple of 4 from 12"},
        {"rayquery:stride14", "multiple of 4"},
        {"rayquery:f64x3:stride28", "multiple of 8"},
        {"rayquery:split1", "split2 to split64"},
        {"rayquery:split65", "split2 to split64"},
        {"rayquery:s16x4:nan", "s16x4 has no NaN"},
        {"rayquery:UPDATE", "no word"},
        {"rayquery:all", "no word"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
        struct accel_variant variant;
        struct reason reason = {""};
        assert_true(accel_is_named(none[i].name));
        assert_int_equal(accel_parse(none[i].name, &variant, &reason), STATUS_INPUT);
        if (!strstr(reason.text, none[i].why))
            fail_msg("%s: %s", none[i].name, reason.text);
    }
}

/* Names of compilers stay what they were, also those with words of a variant behind them. */
static void compilers_are_no_variants(void **state)
{
    (void)state;
    static const char *const others[] = {"rayquery",           "rayquery:raw",
                                         "rayquery:opt:final", "rayquery:texel:cross",
                                         "rayquery:reference", "rayquery:passes:ccp+if-conversion",
                                         "rayquery2:u16",      "vulkan:u16"};
    for (size_t i = 0; i < ARRAY_COUNT(others); i++)
        assert_false(accel_is_named(others[i]));
}

/* Every word is in the list that "all" stands for, alone, and the list has no name twice. */
static void the_list_has_every_word(void **state)
{
    (void)state;
    static const char *const words[] = {
        "fast_trace",    "fast_build",   "low_memory", "allow_update", "allow_compaction",
        "update",        "update_into",  "compact",    "clone",        "serialise",
        "serialise_new", "indirect",     "host",       "scaled",       "turned",
        "moved",         "u16",          "u8",         "unindexed",    "offset",
        "nan",           "first_vertex", "degenerate"};
    size_t found = 0, count = 0, formats = 1;
    for (; accel_names[count]; count++) {
        const struct accel_variant variant = parsed(accel_names[count]);
        expect_name(&variant, accel_names[count]);
        for (size_t i = 0; i < count; i++)
            assert_string_not_equal(accel_names[i], accel_names[count]);
        for (size_t w = 0; w < ARRAY_COUNT(words); w++)
            found += strcmp(accel_names[count] + strlen(ACCEL_PREFIX), words[w]) == 0;
        for (size_t f = 1; f < ACCEL_FORMATS; f++)
            formats += strcmp(accel_names[count] + strlen(ACCEL_PREFIX), accel_format[f].name) == 0;
    }
    assert_int_equal(found, ARRAY_COUNT(words));
    assert_int_equal(formats, ACCEL_FORMATS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read_as_the_same),
        cmocka_unit_test(a_form_is_what_is_left_of_a_name_without_flags),
        cmocka_unit_test(words_stand_in_any_order_and_lose_what_changes_nothing),
        cmocka_unit_test(what_is_no_variant_is_refused),
        cmocka_unit_test(compilers_are_no_variants),
        cmocka_unit_test(the_list_has_every_word),
    };
    return cmocka_run_group_tests_name("accel_variant", tests, NULL, NULL);
}
