/* Numbers of a trial's file at their limits: the largest is read, the next is refused and told. */
#include "fuzz/findings/finding_file.h"
#include "fuzz/play/trial_world.h"
#include "ref/base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PADDING (8u << 20) /* blanks, so that what is counted might follow */

static const char text[] = "raydiff trial 2\n"
                           "expect clean\n"
                           "builder median leaf 4 eps 0.02\n"
                           "box robust\n"
                           "tri mt\n"
                           "query closest\n"
                           "filter all seed 0 share 128\n"
                           "vertices 3\n"
                           "0 0 0\n"
                           "0 1 0\n"
                           "1 0 0\n"
                           "triangles 1\n"
                           "0 1 2\n"
                           "geometries 1\n"
                           "mesh 0 triangles 1 opaque\n"
                           "instances 1\n"
                           "0 0 255 0 1 0 0 0 0 1 0 0 0 0 1 0\n"
                           "rays 1\n"
                           "0 0 0 0 0 1 0 inf 255 0\n"
                           "end\n";

/* The text with another number behind `before`, read: its error, "" if there is none. */
static const char *read_with(const char *before, uint64_t number)
{
    static struct reason reason;
    const char *at = strstr(text, before);
    assert_non_null(at);
    at += strlen(before);
    char *bytes = malloc(sizeof text + 32 + PADDING);
    assert_non_null(bytes);
    int head = sprintf(bytes, "%.*s%llu", (int)(at - text), text, (unsigned long long)number);
    size_t size = (size_t)head + (size_t)sprintf(bytes + head, "%s", at + strspn(at, "0123456789"));
    memset(bytes + size, ' ', PADDING);
    bytes[size + PADDING] = '\0';
    struct finding_file file;
    const enum status status = finding_file_parse("f", bytes, size + PADDING, &file, &reason);
    if (!status)
        finding_file_free(&file);
    free(bytes);
    return status ? reason.text : "";
}

static void a_number_is_read_to_its_limit(void **state)
{
    (void)state;
    static const struct {
        const char *before;
        uint64_t most;
    } numbers[] = {
        {"filter all seed ", UINT32_MAX},
        {"share ", 256},
        {"mesh ", FUZZ_GEOMETRIES_MOST - 1},
        {"mesh 0 triangles ", FUZZ_TRIANGLES_MOST},
        {"instances 1\n", FUZZ_GEOMETRIES_MOST - 1},
        {"instances 1\n0 ", ABI_CUSTOM_MOST},
        {"instances 1\n0 0 ", 0xFF},
        {"instances 1\n0 0 255 ", ABI_INSTANCE_FLAGS},
        {"inf ", 0xFF},
        {"inf 255 ", ABI_RAY_FLAGS},
        {"triangles 1\n", UINT32_MAX},
    };
    for (size_t i = 0; i < ARRAY_COUNT(numbers); i++) {
        char rule[60];
        snprintf(rule, sizeof rule, "is not a whole number from 0 to %llu",
                 (unsigned long long)numbers[i].most);
        const char *why = read_with(numbers[i].before, numbers[i].most);
        if (strstr(why, "is not a whole number"))
            fail_msg("%s%llu: %s", numbers[i].before, (unsigned long long)numbers[i].most, why);
        why = read_with(numbers[i].before, numbers[i].most + 1);
        if (!strstr(why, rule))
            fail_msg("%s: one more than %s: %s", numbers[i].before, rule, why);
    }
}

static void as_many_are_read_as_there_may_be(void **state)
{
    (void)state;
    static const struct {
        const char *before;
        uint32_t most;
    } counts[] = {
        {"vertices ", 3 * FUZZ_TRIANGLES_MOST},
        {"\ntriangles ", FUZZ_TRIANGLES_MOST},
        {"geometries ", FUZZ_GEOMETRIES_MOST},
        {"instances ", FUZZ_INSTANCES_MOST},
        {"rays ", FUZZ_RAYS_MOST},
    };
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
        char rule[60];
        snprintf(rule, sizeof rule, "a trial has at most %u ", counts[i].most);
        const char *why = read_with(counts[i].before, counts[i].most);
        if (!why[0] || strstr(why, "at most") || strstr(why, "do not fit"))
            fail_msg("%s%u: %s", counts[i].before, counts[i].most, why);
        why = read_with(counts[i].before, counts[i].most + 1u);
        if (!strstr(why, rule))
            fail_msg("%s: one more than %u: %s", counts[i].before, counts[i].most, why);
    }
}

static void the_text_is_read(void **state)
{
    (void)state;
    assert_string_equal(read_with("share ", 128), "");
}

/* A world whose file says nothing of a filter has the one that is told here. */
static void no_filter_is_the_first_one(void **state)
{
    (void)state;
    static struct reason reason;
    const char *line = strstr(text, "filter "), *next = strstr(text, "vertices ");
    struct finding_file said, unsaid;
    char bytes[sizeof text];
    snprintf(bytes, sizeof bytes, "%.*s%s", (int)(line - text), text, next);
    if (finding_file_parse("f", text, strlen(text), &said, &reason) ||
        finding_file_parse("f", bytes, strlen(bytes), &unsaid, &reason))
        fail_msg("%s", reason.text);
    const struct filter_rule *a = &said.trial.world.filter, *b = &unsaid.trial.world.filter;
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->seed, b->seed);
    assert_int_equal(a->share, b->share);
    finding_file_free(&said);
    finding_file_free(&unsaid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_filter_is_the_first_one),
        cmocka_unit_test(the_text_is_read),
        cmocka_unit_test(a_number_is_read_to_its_limit),
        cmocka_unit_test(as_many_are_read_as_there_may_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
