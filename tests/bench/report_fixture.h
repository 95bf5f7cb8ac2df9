/* What test_report.c and test_report_files.c share; includes cmocka.h. */
#ifndef REPORT_FIXTURE_H
#define REPORT_FIXTURE_H

#include "bench/report/report.h"
#include "ref/base/command.h"
#include "scenes/picture/image.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include "tests/support/root.h"
#include "tests/readers/well_formed.h"

static const char check_text[] =
    "{'raydiff': '0.1.0', 'exit': 1, 'scenes': [{'scene': 'S<1>', 'triangles': 12, 'vertices': 8,"
    "'rays': 'mixed', 'count': 100, 'refused': ''}], 'rows': [{'scene': 'S<1>', 'layout': 'f32',"
    "'builder': 'median', 'engine': 'cpu', 'box': 'robust', 'tri': 'mt', 'query': 'closest',"
    "'node_bytes': 64, 'item_bytes': 48, 'rays': 100, 'hits': 60, 'tree': {'nodes': 3,"
    "'leaves': 2, 'depth': 1}, 'counts': {'right': 90, 'tie': 7, 'wrong': WRONG},"
    "'wrong': {'missed': WRONG}, 'err_over_bound': 0.5, 'bit_differences': BITS, 'judged': JUDGED,"
    "'differences': DIFFERENCES, 'mrays_per_s': {'median': 2.5, 'min': 2.0, 'max': 3.0},"
    "'status': 'STATUS', 'reason': 'why & how', 'findings': [{'ray': 5, 'against': 'truth',"
    "'got': null, 'judgement': {'wrong': 'missed', 'expected': 4, 't_lo': 1.5, 't_hi': 1.75},"
    "'explain': 'raydiff explain <x>'}]}]}";

static const char error_text[] =
    "{'raydiff': '0.1.0', 'exit': 0, 'rows': [{'scene': 'S<1>', 'triangles': 12, 'rays': 'random',"
    "'engine': 'cpu', 'layout': 'f32', 'box': 'robust', 'tri': 'mt', 'count': 100,"
    "'mrays_median': 2.5, 'mrays_min': 2.0, 'mrays_max': 3.0, 'compared': 100, 'lost': 1,"
    "'phantom': 0, 'wrong_id': 2, 'edge_rays': 10, 'edge_leaks': 1, 'vertex_rays': 10,"
    "'vertex_leaks': 0, 'forward_p50': 0.5, 'forward_p99': 2.0, 'forward_max': 9.0,"
    "'node_bytes': 64, 'item_bytes': 48, 'memory_bytes': 900, 'benchmark': 'error'},"
    "{'benchmark': 'other<', 'number': 3, 'real': 0.5, 'text': '<b>', 'none': null, 'yes': true}]}";

static const char frames_text[] =
    "{'title': 'S<1>', 'frames': 3, 'warm_up_dropped': 1, 'handlers': [{'handler': 'cpu<f32>',"
    "'bytes': 112, 'clock': 'host', 'average_ms': 2.0, 'min_ms': 1.0, 'max_ms': 3.0,"
    "'median_ms': 2.0, 'samples_ms': [1.0, 2.0, 3.0], 'ratio': {'to': 'cpu', 'median': 1.0,"
    "'min': 1.0, 'max': 1.0}}]}";

static const char doctor_text[] =
    "{'engines': [{'name': 'cpu', 'runs': true, 'why': null, 'text': 'two\\nlines <'}],"
    "'drivers': [{'name': 'd<1>', 'runs': true, 'why': null, 'packages': 'p', 'card': {'device':"
    "'x', 'ops': [{'op': 'a<b', 'ordinary': 9, 'ordinary_differs': 2, 'worst_ulp': 1,"
    "'special': 4, 'special_differs': 0, 'flushed': 0}], 'half': {'pack': {'wrong': 3}},"
    "'loops': {'ran': [1, 2]}}}, {'name': 'hardware', 'runs': false, 'why': 'none <here>'}]}";

static const char replay_text[] =
    "{'exit': 1, 'files': [{'file': 'f', 'fails': true, 'triangles': 2, 'rays': 1}]}";

static const char diff_text[] =
    "{'scene': 'S<1>', 'pairs': [{'engine': 'e<1>', 'reference': 'cpu', 'agrees': false,"
    "'same_bits_demanded': true, 'paths': 9, 'paths_different': 4, 'values_different': 3,"
    "'largest': 200, 'beyond_the_bound': 0, 'why': {'rounding': 1, 'allowed': 0, 'drift': 1,"
    "'published': 0, 'wrong': 2}}]}";

/* JSON with ' for " and each word of `from` replaced by that of `to`. */
static json_t *json_of(const char *text, const char *const (*words)[2], size_t count)
{
    char *copy = alloc_zeroed(strlen(text) + 400, 1);
    size_t used = 0;
    assert_non_null(copy);
    for (const char *at = text; *at;) {
        size_t w = 0;
        while (w < count && strncmp(at, words[w][0], strlen(words[w][0])) != 0)
            w++;
        if (w < count) {
            used += (size_t)sprintf(copy + used, "%s", words[w][1]);
            at += strlen(words[w][0]);
        } else {
            copy[used++] = *at == '\'' ? '"' : *at;
            at++;
        }
    }
    json_error_t why;
    json_t *json = json_loads(copy, 0, &why);
    if (!json)
        fail_msg("%s in %s", why.text, copy);
    free(copy);
    return json;
}

static inline json_t *check_of(const char *wrong, const char *bits, const char *judged,
                               const char *differences, const char *status)
{
    const char *const words[][2] = {{"WRONG", wrong},
                                    {"BITS", bits},
                                    {"JUDGED", judged},
                                    {"DIFFERENCES", differences},
                                    {"STATUS", status}};
    return json_of(check_text, words, ARRAY_COUNT(words));
}

static void add(struct report *report, enum report_kind kind, json_t *json, int code)
{
    struct reason reason;
    const struct report_part part = {.kind = kind,
                                     .name = "part <&>",
                                     .command = "raydiff command 'a<b'",
                                     .why = "said <i>",
                                     .text =
                                         kind == REPORT_FINDING ? "x <\ncause     why <b>\n" : NULL,
                                     .json = json,
                                     .code = code};
    assert_int_equal(report_add(report, &part, &reason), STATUS_OK);
}

static struct report empty(void)
{
    return (struct report){.title = "title <&>", .command = "raydiff report", .when = "now"};
}

/* The page; well-formed and alone, or the test fails. The caller frees it. */
static char *page_of(const struct report *report)
{
    static const char *const outside[] = {"<script", "<link",   "<iframe", "<object", "@import",
                                          "url(",    "src=\"h", "src=\"/", "src=\"f"};
    struct reason reason;
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    assert_int_equal(report_write(report, out, &reason), STATUS_OK);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(strncmp(text, "<!DOCTYPE html>\n<html", 21), 0);
    if (!well_formed(text + 16))
        fail_msg("not well-formed: %.2000s", text);
    for (size_t i = 0; i < ARRAY_COUNT(outside); i++)
        assert_null(strstr(text, outside[i]));
    assert_int_equal(occurrences(text, "://"),
                     occurrences(text, "xmlns=\"http://www.w3.org/2000/svg\""));
    assert_int_equal(occurrences(text, "<figure>"), report_sum(report).figures);
    return text;
}

static inline void has(const char *page, const char *what)
{
    if (!strstr(page, what))
        fail_msg("no %s", what);
}

#endif
