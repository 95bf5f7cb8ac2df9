/* The baseline: what is known, until when, and what of it is unused. */
#define _DEFAULT_SOURCE /* timegm */
#include "fuzz/findings/baseline.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

static struct reason reason;

#define LINK " https://a.b/c\n"
#define MESA "raydiff 0.1.0\nvulkan: llvmpipe (LLVM 15.0.6), Mesa 22.3.6"

static struct baseline listed(const char *text)
{
    struct baseline baseline = {0};
    if (baseline_add(&baseline, "list", text, strlen(text), &reason))
        fail_msg("%s", reason.text);
    return baseline;
}

static struct baseline_answer ask(struct baseline *baseline, const char *signature,
                                  const char *versions, const char *today)
{
    struct fuzz_signature parsed;
    struct baseline_answer answer;
    assert_int_equal(fuzz_signature_parse(signature, &parsed, &reason), STATUS_OK);
    baseline_ask(baseline, &parsed, versions, today, &answer);
    return answer;
}

/* Today is a day of UTC, the same in every time zone. */
static void today_is_the_same_everywhere(void **state)
{
    (void)state;
    static const char *const zones[] = {"UTC0", "AHEAD-14", "BEHIND12"};
    for (size_t i = 0; i < ARRAY_COUNT(zones); i++) {
        char day[3][BASELINE_DAY];
        assert_int_equal(setenv("TZ", zones[i], 1), 0);
        tzset();
        for (int k = 0; k < 3; k++) { /* midnight may lie between */
            time_t now = time(NULL);
            struct tm utc;
            assert_non_null(gmtime_r(&now, &utc));
            assert_true(strftime(day[k], sizeof day[k], "%Y-%m-%d", &utc) > 0);
            if (k == 1)
                baseline_today(day[k]);
        }
        assert_true(strcmp(day[1], day[0]) == 0 || strcmp(day[1], day[2]) == 0);
    }
    assert_int_equal(unsetenv("TZ"), 0);
}

static void entries_excuse_until_their_day(void **state)
{
    (void)state;
    struct baseline b =
        listed("# comment\n"
               "embree*.-.not_finite.* until 2026-03-01 divides by zero" LINK
               "vulkan.*.missed.* @Mesa_22.3 until - an old driver" LINK
               "*.*.bits.* until 2020-02-29 first" LINK "*.*.bits.* until 2020-03-01 second" LINK);
    struct baseline_answer a = ask(&b, "embree_robust.-.not_finite.outside", "", "2026-03-01");
    assert_int_equal(a.state, BASELINE_KNOWN);
    assert_string_equal(a.text, "divides by zero https://a.b/c (list:2)");
    a = ask(&b, "embree_robust.-.not_finite.outside", "", "2026-03-02");
    assert_int_equal(a.state, BASELINE_EXPIRED);
    assert_string_equal(a.text, "known until 2026-03-01: divides by zero https://a.b/c (list:2)");
    assert_int_equal(ask(&b, "embree.-.missed.outside", "", "2026-03-01").state, BASELINE_NEW);
    assert_int_equal(ask(&b, "cpu.f32.not_finite.outside", "", "2026-03-01").state, BASELINE_NEW);
    a = ask(&b, "vulkan.rf16.missed.shader", MESA, "9999-12-31");
    assert_int_equal(a.state, BASELINE_KNOWN);
    assert_int_equal(ask(&b, "vulkan.rf16.missed.shader", "vulkan: Mesa 25.0", "2026-01-01").state,
                     BASELINE_NEW);
    /* Of several the one that has not expired, else the first. */
    assert_non_null(strstr(ask(&b, "cpu.f32.bits.none", "", "2020-02-29").text, "first"));
    a = ask(&b, "cpu.f32.bits.none", "", "2020-03-01");
    assert_int_equal(a.state, BASELINE_KNOWN);
    assert_non_null(strstr(a.text, "second"));
    a = ask(&b, "cpu.f32.bits.none", "", "2020-03-02");
    assert_int_equal(a.state, BASELINE_EXPIRED);
    assert_non_null(strstr(a.text, "first"));
    baseline_close(&b);
    /* A file that is added may say that it is known what the shipped list no longer excuses. */
    b = listed("*.*.crash.* until 2020-01-01 old" LINK);
    const char *more = "cpu.f32.crash.* until - newer" LINK;
    assert_int_equal(baseline_add(&b, "more", more, strlen(more), &reason), STATUS_OK);
    a = ask(&b, "cpu.f32.crash.none", "", "2026-01-01");
    assert_int_equal(a.state, BASELINE_KNOWN);
    assert_string_equal(a.text, "newer https://a.b/c (more:1)");
    baseline_close(&b);
}

static void bad_lines_are_refused(void **state)
{
    static const struct {
        const char *text, *why;
    } bad[] = {
        {"*.*.bits.* why" LINK, "list:1: after the pattern comes 'until"},
        {"*.*.bits.* @V why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until soon why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 2026-13-01 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 2026-02-29 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 2026-04-31 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 2026-4-30 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 2026-04-301 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until 1900-02-29 why" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until" LINK, "list:1: after the pattern"},
        {"*.*.bits.* until -" LINK, "list:1: a waiver needs a reason"},
        {"\n*.*.bits.* until - why\n", "list:2: a waiver must end in a link"},
        {"*.bits.* until - why" LINK, "list:1: '*.bits.*' is no pattern of engine.layout.kind"},
        {"* until - everything" LINK, "list:1: '*' is no pattern of"},
        {"*.*.bitz.* until - why" LINK, "list:1: no kind is called 'bitz'"},
        {"*.*.*.nothing until - why" LINK, "list:1: no cause is called 'nothing'"},
        {"cpu.f33.*.* until - why" LINK, "list:1: no layout is called 'f33'"},
        {"gpu.*.*.* until - why" LINK, "list:1: no engine is called 'gpu'"},
        {"rayquery:u17.-.*.* until - why" LINK, "list:1: no engine is called 'rayquery:u17'"},
        {"cpu:*.*.*.* until - why" LINK, "list:1: no engine is called 'cpu:*'"},
        {"*.*.bits.* until - why" LINK "*.*.bits.* until - how" LINK, "list:2: line 1 has"},
        {"*.*.bits.* until - wh\x01y" LINK, "list:1: a control character"},
    };
    (void)state;
    struct baseline b = listed("pipe:a.b.-.crash.* until - a peer's" LINK);
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        assert_int_equal(baseline_add(&b, "list", bad[i].text, strlen(bad[i].text), &reason),
                         STATUS_INPUT);
        assert_memory_equal(reason.text, bad[i].why, strlen(bad[i].why));
        assert_int_equal(b.count, 1);
    }
    /* A zero byte ends no list. */
    assert_int_equal(baseline_add(&b, "list", "#\0\nx", 4, &reason), STATUS_INPUT);
    assert_int_equal(baseline_add(&b, "list", "*.*.bits.* until 2024-02-29 leap" LINK, 47, &reason),
                     STATUS_OK);
    baseline_close(&b);
}

/* Every day of the calendar, and no other. */
/* A pattern may be as long as the longest signature, and no longer. */
static void patterns_are_as_long_as_signatures(void **state)
{
    (void)state;
    for (int length = FUZZ_SIGNATURE_MOST - 3; length < FUZZ_SIGNATURE_MOST + 3; length++) {
        char text[2 * FUZZ_SIGNATURE_MOST], why[80];
        struct baseline b = {0};
        memset(text, '*', (size_t)length - 9);
        strcpy(text + length - 9, ".*.bits.* until - why" LINK);
        snprintf(why, sizeof why, "list:1: a pattern has at most %d characters",
                 FUZZ_SIGNATURE_MOST - 1);
        reason.text[0] = '\0';
        enum status status = baseline_add(&b, "list", text, strlen(text), &reason);
        assert_int_equal(status, length < FUZZ_SIGNATURE_MOST ? STATUS_OK : STATUS_INPUT);
        assert_string_equal(reason.text, status ? why : "");
        if (!status)
            assert_int_equal(ask(&b, "cpu.rf16.bits.stack", "", "2026-01-01").state,
                             BASELINE_KNOWN);
        baseline_close(&b);
    }
}

static void days_are_those_of_the_calendar(void **state)
{
    (void)state;
    static const int years[] = {2024, 2027, 2100, 2000};
    size_t taken = 0;
    for (size_t y = 0; y < ARRAY_COUNT(years); y++)
        for (int month = 0; month <= 13; month++)
            for (int day = 0; day <= 32; day++) {
                char text[80];
                struct tm time = {.tm_year = years[y] - 1900, .tm_mon = month - 1, .tm_mday = day};
                const time_t at = timegm(&time);
                const struct tm *there = gmtime(&at);
                const bool is_day = there->tm_mday == day && there->tm_mon == month - 1 &&
                                    there->tm_year == years[y] - 1900;
                struct baseline b = {0};
                snprintf(text, sizeof text, "*.*.bits.* until %04d-%02d-%02d why%s", years[y],
                         month, day, LINK);
                assert_int_equal(baseline_add(&b, "list", text, strlen(text), &reason),
                                 is_day ? STATUS_OK : STATUS_INPUT);
                taken += is_day;
                baseline_close(&b);
            }
    assert_int_equal(taken, 366 + 365 + 365 + 366);
}

static void files_are_added(void **state)
{
    (void)state;
    char path[] = "/tmp/raydiff-baseline-XXXXXX";
    int fd = mkstemp(path);
    FILE *file = fd < 0 ? NULL : fdopen(fd, "w");
    assert_non_null(file);
    fputs("cpu.*.stack.* until - no such kind" LINK, file);
    assert_int_equal(fclose(file), 0);
    struct baseline b;
    assert_int_equal(baseline_open(&b, &reason), STATUS_OK);
    assert_int_equal(baseline_add_file(&b, path, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, ":1: no kind is called 'stack'"));
    file = fopen(path, "w");
    assert_non_null(file);
    fputs("cpu.*.*.stack until - by design" LINK, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(baseline_add_file(&b, path, &reason), STATUS_OK);
    assert_int_equal(ask(&b, "cpu.rf16.missed.stack", "", "2026-01-01").state, BASELINE_KNOWN);
    unlink(path);
    assert_int_equal(baseline_add_file(&b, path, &reason), STATUS_INPUT);
    baseline_close(&b);
}

/* What the program ships excuses nothing of its own code. */
static void the_shipped_list_is_of_others(void **state)
{
    static const char *const own[] = {"cpu", "brute"};
    (void)state;
    struct baseline b;
    if (baseline_open(&b, &reason))
        fail_msg("%s", reason.text);
    for (size_t l = 0; layouts[l]; l++)
        for (enum fuzz_kind kind = FUZZ_KIND_WRONG + 1; kind < FUZZ_KIND_COUNT; kind++)
            for (size_t e = 0; e < ARRAY_COUNT(own); e++) {
                struct fuzz_signature signature = {.layout = layouts[l], .kind = kind};
                struct baseline_answer answer;
                fuzz_signature_set_engine(&signature, own[e]);
                for (signature.cause = 0; signature.cause < CAUSE_COUNT; signature.cause++) {
                    baseline_ask(&b, &signature, MESA, "2000-01-01", &answer);
                    assert_int_equal(answer.state, BASELINE_NEW);
                }
            }
    baseline_close(&b);
}

static void unused_entries_are_told(void **state)
{
    (void)state;
    const struct engine *const engine[] = {engine_find("cpu"), engine_find("embree_robust")};
    const struct layout *const layout[] = {layout_find("f32"), layout_find("rf16")};
    const struct engine_options options = {0};
    struct fuzz_field field;
    const char *path;
    size_t at = 0;
    assert_int_equal(fuzz_field_make(engine, 2, layout, 2, &options, &field, &reason), STATUS_OK);
    struct baseline b = listed("embree*.-.missed.* until - used" LINK
                               "embree*.-.phantom.* until 2020-01-01 not used" LINK
                               "embree_robust.-.distance.* until - not used, too" LINK
                               "embree.-.phantom.* until - another engine" LINK
                               "*.rtrs_rf.missed.* until - another layout" LINK
                               "*.rf16.missed.* @Mesa_25 until - another version" LINK
                               "*.rf16.missed.* until - used though it expired" LINK);
    const char *more = "cpu.*.bits.* @Mesa until - not used" LINK;
    assert_int_equal(baseline_add(&b, "more", more, strlen(more), &reason), STATUS_OK);
    (void)ask(&b, "embree_robust.-.missed.outside", MESA, "2026-01-01");
    (void)ask(&b, "cpu.rf16.missed.stack", MESA, "2026-01-01");
    const struct waiver *first = baseline_unused(&b, &field, MESA, &at, &path);
    assert_non_null(first);
    assert_string_equal(first->pattern, "embree*.-.phantom.*");
    assert_string_equal(path, "list");
    const struct waiver *beside = baseline_unused(&b, &field, MESA, &at, &path);
    assert_non_null(beside);
    assert_string_equal(beside->pattern, "embree_robust.-.distance.*");
    const struct waiver *second = baseline_unused(&b, &field, MESA, &at, &path);
    assert_non_null(second);
    assert_string_equal(second->pattern, "cpu.*.bits.*");
    assert_string_equal(path, "more");
    assert_null(baseline_unused(&b, &field, MESA, &at, &path));
    baseline_close(&b);
}

static void today_is_a_day(void **state)
{
    (void)state;
    char day[BASELINE_DAY], line[100];
    baseline_today(day);
    assert_true(strcmp(day, "2024-01-01") > 0 && strcmp(day, "9999-12-31") < 0);
    snprintf(line, sizeof line, "*.*.bits.* until %s why" LINK, day);
    struct baseline b = listed(line); /* the reader takes it for one */
    assert_int_equal(ask(&b, "cpu.f32.bits.none", "", day).state, BASELINE_KNOWN);
    baseline_close(&b);
}

/* What is known of an engine is known of its variants, by their formula, and of no other. */
static void variants_have_the_faults_of_their_formula(void **state)
{
    (void)state;
    static const struct {
        const char *waiver, *signature;
        enum baseline_state state;
    } cases[] = {
        {"embree", "embree", BASELINE_KNOWN},
        {"embree", "embree:avx2:8", BASELINE_KNOWN},
        {"embree", "embree:sse2:high:compact", BASELINE_KNOWN},
        {"embree", "embree:sse2:high:robust", BASELINE_NEW},
        {"embree", "embree_robust", BASELINE_NEW},
        {"embree_robust", "embree:sse2:high:robust", BASELINE_KNOWN},
        {"embree_robust", "embree:sse2:high", BASELINE_NEW},
        {"embree:sse2", "embree:sse2", BASELINE_KNOWN},
        {"embree:sse2", "embree:avx", BASELINE_NEW},
        {"embree:sse2", "embree", BASELINE_NEW},
        {"embree", "vulkan:opt", BASELINE_NEW},
        {"rayquery", "rayquery:u16", BASELINE_KNOWN},
        {"rayquery", "rayquery:update:clone", BASELINE_KNOWN},
        {"rayquery", "rayquery:opt", BASELINE_NEW},
        {"rayquery:*nan*", "rayquery:split2:nan", BASELINE_KNOWN},
        {"rayquery:*nan*", "rayquery:split2", BASELINE_NEW},
        {"rayquery:u16", "rayquery", BASELINE_NEW},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char line[200], signature[100];
        snprintf(line, sizeof line, "%s.-.missed.scale until 2027-12-31 because" LINK,
                 cases[i].waiver);
        snprintf(signature, sizeof signature, "%s.-.missed.scale", cases[i].signature);
        struct baseline baseline = listed(line);
        assert_int_equal(ask(&baseline, signature, "raydiff 0.1.0", "2027-01-01").state,
                         cases[i].state);
        baseline_close(&baseline);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(today_is_the_same_everywhere),
        cmocka_unit_test(variants_have_the_faults_of_their_formula),
        cmocka_unit_test(entries_excuse_until_their_day),
        cmocka_unit_test(bad_lines_are_refused),
        cmocka_unit_test(patterns_are_as_long_as_signatures),
        cmocka_unit_test(days_are_those_of_the_calendar),
        cmocka_unit_test(files_are_added),
        cmocka_unit_test(the_shipped_list_is_of_others),
        cmocka_unit_test(unused_entries_are_told),
        cmocka_unit_test(today_is_a_day),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
