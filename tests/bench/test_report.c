/* A report says what its parts say, and nothing else: whatever they hold the page is well-formed
 * and asks for nothing, what is wrong stands out, what failed is in it and in the exit code. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
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

/* --- making ------------------------------------------------------------------------------- */

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

static json_t *check_of(const char *wrong, const char *bits, const char *judged,
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

static void has(const char *page, const char *what)
{
    if (!strstr(page, what))
        fail_msg("no %s", what);
}

/* --- tests -------------------------------------------------------------------------------- */

static void every_section_is_there(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
    add(&report, REPORT_BENCH, json_of(error_text, NULL, 0), 0);
    add(&report, REPORT_BENCH, json_of(frames_text, NULL, 0), 0);
    add(&report, REPORT_PICTURES, json_of(diff_text, NULL, 0), 0);
    add(&report, REPORT_MACHINE, json_of(doctor_text, NULL, 0), EXIT_SKIPPED);
    add(&report, REPORT_FINDING, json_of(replay_text, NULL, 0), 0);
    char *page = page_of(&report);
    static const char *const wanted[] = {"id=\"summary\"",
                                         "id=\"agreement\"",
                                         "id=\"speed\"",
                                         "id=\"pictures\"",
                                         "id=\"findings\"",
                                         "id=\"machine\"",
                                         "id=\"commands\"",
                                         "<h3>S&lt;1&gt;</h3>",
                                         "agrees",
                                         "7 allowed",
                                         "Speed against error",
                                         "Size against speed",
                                         "Memory against speed",
                                         "other&lt;",
                                         "Frames: S&lt;1&gt;",
                                         "cpu&lt;f32&gt;",
                                         "2 of 9 differ, by at most 1 ulp",
                                         "e&lt;1&gt; against cpu",
                                         "<td class=\"n bad\">2</td>",
                                         "<td class=\"bad\">NOT so",
                                         "Driver hardware does not run: none &lt;here&gt;",
                                         "still fails",
                                         "why &lt;b&gt;",
                                         "raydiff command 'a&lt;b'",
                                         "raydiff explain &lt;x&gt;",
                                         "title &lt;&amp;&gt;"};
    for (size_t i = 0; i < ARRAY_COUNT(wanted); i++)
        has(page, wanted[i]);
    assert_int_equal(report_sum(&report).figures, 4); /* error, size, memory, frames */
    assert_int_equal(report_code(&report), EXIT_AGREE);
    free(page);
    report_free(&report);
}

static void what_is_missing_is_said(void **state)
{
    (void)state;
    struct report report = empty();
    char *page = page_of(&report);
    assert_int_equal(occurrences(page, "Not part of this report."), 5);
    has(page, "Nothing was asked for");
    free(page);
    report_free(&report);
}

/* Only what is judged wrong is red; as published is marked another way. */
static void what_is_wrong_stands_out(void **state)
{
    (void)state;
    static const struct {
        const char *wrong, *bits, *judged, *differences, *status, *cell, *word;
    } rows[] = {{"0", "0", "true", "0", "ok", "<td class=\"good\"", "agrees"},
                {"3", "0", "true", "3", "ok", "<td class=\"bad\"", "3 WRONG"},
                {"0", "4", "true", "4", "ok", "<td class=\"bad\"", "4 other bits"},
                {"0", "0", "true", "0", "vacuous", "<td class=\"bad\"", "proves nothing"},
                {"3", "0", "false", "0", "ok", "<td class=\"pub\"", "3 wrong"},
                {"0", "0", "true", "0", "failed", "<td class=\"bad\"", "failed"},
                {"0", "0", "true", "0", "skipped", "<td class=\"none\"", "skipped"}};
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++) {
        struct report report = empty();
        add(&report, REPORT_CHECK,
            check_of(rows[i].wrong, rows[i].bits, rows[i].judged, rows[i].differences,
                     rows[i].status),
            0);
        char *page = page_of(&report), cell[80];
        const char *matrix = strstr(page, "class=\"matrix\"");
        assert_non_null(matrix);
        snprintf(cell, sizeof cell, "%s title=\"why &amp; how\">%s", rows[i].cell, rows[i].word);
        has(matrix, cell);
        free(page);
        report_free(&report);
    }
}

static void what_is_wrong_is_counted(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_CHECK, check_of("3", "2", "true", "3", "ok"), EXIT_MISMATCH);
    add(&report, REPORT_CHECK, check_of("5", "0", "false", "0", "ok"), 0);
    const struct report_sum sum = report_sum(&report);
    assert_int_equal(sum.rows, 2);
    assert_int_equal(sum.wrong, 3);
    assert_int_equal(sum.published, 5);
    assert_int_equal(sum.bits, 2);
    report_free(&report);
}

static void a_finding_can_be_played_again(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_FINDING, json_of(replay_text, NULL, 0), EXIT_MISMATCH);
    char *page = page_of(&report);
    const char *section = strstr(page, "id=\"findings\"");
    assert_non_null(section);
    assert_in_range(strstr(section, "raydiff command 'a&lt;b'") - section, 0,
                    strstr(section, "id=\"machine\"") - section);
    has(page, ">1 finding is still there (exit code 1)<");
    assert_int_equal(report_code(&report), EXIT_MISMATCH);
    free(page);
    report_free(&report);
}

static void the_exit_code_is_of_all_parts(void **state)
{
    (void)state;
    static const struct {
        struct report_part part;
        int code;
    } cases[] = {
        {{.kind = REPORT_CHECK, .state = REPORT_RAN, .code = EXIT_MISMATCH}, EXIT_MISMATCH},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_AGREE}, EXIT_INTERNAL},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_MISMATCH}, EXIT_INTERNAL},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_USAGE}, EXIT_USAGE},
        {{.kind = REPORT_BENCH, .state = REPORT_SKIPPED, .code = EXIT_AGREE}, EXIT_SKIPPED},
        {{.kind = REPORT_BENCH, .state = REPORT_GIVEN, .code = EXIT_ENGINE}, EXIT_ENGINE},
        {{.kind = REPORT_MACHINE, .state = REPORT_FAILED, .code = EXIT_SKIPPED}, EXIT_SKIPPED}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct report report = empty();
        struct reason reason;
        add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
        assert_int_equal(report_add(&report, &cases[i].part, &reason), STATUS_OK);
        assert_int_equal(report_code(&report), cases[i].code);
        free(page_of(&report));
        /* Nor does a part behind it that is well excuse anything. */
        add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
        assert_int_equal(report_code(&report), cases[i].code);
        report_free(&report);
    }
}

/* Where a file's members are of another type, the page is still one. */
static void put_everywhere(json_t *json, const json_t *value, struct report *report, size_t *tried)
{
    const char *name;
    void *next;
    json_t *member;
    for (size_t i = 0; i < json_array_size(json); i++) {
        json_t *was = json_incref(json_array_get(json, i));
        put_everywhere(was, value, report, tried);
        json_array_set_new(json, i, json_deep_copy(value));
        free(page_of(report));
        json_array_set_new(json, i, was);
        ++*tried;
    }
    json_object_foreach_safe(json, next, name, member)
    {
        json_t *was = json_incref(member);
        put_everywhere(was, value, report, tried);
        json_object_set_new(json, name, json_deep_copy(value));
        free(page_of(report));
        json_object_set_new(json, name, was);
        ++*tried;
    }
}

static void any_json_gives_a_page(void **state)
{
    (void)state;
    static const char *const values[] = {"null", "-1", "1e300", "'<&\\u0001'",
                                         "[]",   "{}", "true",  "[[1],{'a':[{}]}]"};
    static const struct {
        enum report_kind kind;
        const char *text;
    } files[] = {{REPORT_CHECK, check_text},    {REPORT_BENCH, error_text},
                 {REPORT_BENCH, frames_text},   {REPORT_MACHINE, doctor_text},
                 {REPORT_FINDING, replay_text}, {REPORT_PICTURES, diff_text}};
    for (size_t f = 0; f < ARRAY_COUNT(files); f++)
        for (size_t v = 0; v < ARRAY_COUNT(values); v++) {
            struct report report = empty();
            json_t *json = files[f].text == check_text ? check_of("1", "2", "true", "3", "ok")
                                                       : json_of(files[f].text, NULL, 0);
            char text[64];
            snprintf(text, sizeof text, "[%s]", values[v]);
            json_t *value = json_of(text, NULL, 0);
            size_t tried = 0;
            add(&report, files[f].kind, json, 0);
            put_everywhere(json, json_array_get(value, 0), &report, &tried);
            assert_true(tried > 3);
            json_decref(value);
            report_free(&report);
        }
}

static void pictures_are_whole_or_refused(void **state)
{
    (void)state;
    char path[300], *bytes;
    struct image image;
    struct reason reason;
    struct report report = empty();
    snprintf(path, sizeof path, "%s/a.png", root);
    assert_int_equal(image_make(5, 3, &image, &reason), STATUS_OK);
    image.pixel[7] = image_rgb(255, 0, 9);
    assert_int_equal(image_write(path, &image, &reason), STATUS_OK);
    image_free(&image);
    assert_int_equal(report_add_picture(&report, "g", "a <b>", "c \"d\"", path, &reason),
                     STATUS_OK);
    assert_int_equal(report.picture[0].width, 5);
    assert_int_equal(report.picture[0].height, 3);

    size_t size = report.picture[0].size;
    bytes = malloc(size);
    assert_non_null(bytes);
    memcpy(bytes, report.picture[0].png, size);
    bytes[size / 2] = (char)~bytes[size / 2];
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    free(bytes);
    assert_int_equal(report_add_picture(&report, "g", "t", "", path, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "a.png"));
    snprintf(path, sizeof path, "%s/none.png", root);
    assert_int_equal(report_add_picture(&report, "g", "t", "", path, &reason), STATUS_INPUT);
    assert_int_equal(report.picture_count, 1);

    char *page = page_of(&report);
    has(page, "<h3>g</h3>");
    has(page, "alt=\"a &lt;b&gt;\" src=\"data:image/png;base64,iVBORw0KGgo");
    free(page);
    report_free(&report);
}

/* Together they stay below what the file may have. */
static void too_large_pictures_are_refused(void **state)
{
    (void)state;
    char path[300];
    struct image image;
    struct reason reason;
    struct report report = empty();
    uint32_t bits = 1;
    snprintf(path, sizeof path, "%s/noise.png", root);
    assert_int_equal(image_make(600, 600, &image, &reason), STATUS_OK);
    for (size_t i = 0; i < (size_t)600 * 600; i++) {
        bits = bits * 1664525u + 1013904223u;
        image.pixel[i] = bits >> 8 | 0xFF000000u;
    }
    assert_int_equal(image_write(path, &image, &reason), STATUS_OK);
    image_free(&image);
    assert_int_equal(report_add_picture(&report, "", "t", "", path, &reason), STATUS_OK);
    assert_int_equal(report_add_picture(&report, "", "t", "", path, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "larger than"));
    char *page = page_of(&report);
    assert_true(strlen(page) < REPORT_BYTES_MOST);
    free(page);
    report_free(&report);
}

static void files_of_others_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"{}", "[]", "{\"rows\": 3}", "{\"rows\": [}", "\"x\""};
    char path[300];
    struct reason reason;
    json_t *json;
    snprintf(path, sizeof path, "%s/x.json", root);
    for (size_t i = 0; i < ARRAY_COUNT(texts); i++)
        for (enum report_kind kind = 0; kind < REPORT_KINDS; kind++) {
            FILE *file = fopen(path, "w");
            assert_non_null(file);
            fputs(texts[i], file);
            assert_int_equal(fclose(file), 0);
            assert_int_equal(report_read(path, kind, &json, &reason), STATUS_INPUT);
            assert_null(json);
            assert_non_null(strstr(reason.text, "x.json"));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_section_is_there),
        cmocka_unit_test(what_is_missing_is_said),
        cmocka_unit_test(what_is_wrong_stands_out),
        cmocka_unit_test(what_is_wrong_is_counted),
        cmocka_unit_test(a_finding_can_be_played_again),
        cmocka_unit_test(the_exit_code_is_of_all_parts),
        cmocka_unit_test(any_json_gives_a_page),
        cmocka_unit_test(pictures_are_whole_or_refused),
        cmocka_unit_test(too_large_pictures_are_refused),
        cmocka_unit_test(files_of_others_are_refused),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
