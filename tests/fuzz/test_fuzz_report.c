/* What a campaign came to as JUnit, TAP and JSON lines: read back by readers of our own, and by
 * xmllint and prove where these are. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/findings/ci.h"
#include "fuzz/findings/findings_report.h"
#include "ref/files/file.h"

#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "tests/support/root.h"

static struct reason reason;
static char path[100];

#define NASTY "a<b> & \"c\" 'd' # e \\ f ]]> {\xC3\xA9} \xE2\x82\xAC"
/* No characters, too long ones, surrogates, and what is past the last of them. */
#define BYTES                                                                                      \
    "\x01\x7F\x80\xC0\xAF\xED\xA0\x80\xF5\xFF-\xE0\x80\xAF\xF0\x8F\xBF\xBF-"                       \
    "\xF4\x90\x80\x80\xE2\x82"
#define MENDED                                                                                     \
    "??????????"                                                                                   \
    "-"                                                                                            \
    "???????"                                                                                      \
    "-"                                                                                            \
    "??????"

static const struct report_contestant who[] = {
    {.name = "cpu.rf16", .played = 90, .declined = 7, .refused = 10, .seconds = 1.25},
    {.name = "vulkan.f32", .why = "no Vulkan device here"},
    {.name = "pipe:a.out", .declined = 100},
};

static const struct report_finding found[] = {
    {.signature = "cpu.rf16.missed.stack",
     .count = 1,
     .state = REPORT_NEW,
     .cause = NASTY,
     .opinion = "line 1\nline 2\ttab",
     .triangles = 1,
     .rays = 1,
     .vertices = 3,
     .first = "f/cpu.rf16.missed.stack/first.trial",
     .smallest = "f/" BYTES,
     .replay = "raydiff replay 'f/smallest.trial'"},
    {.signature = "embree.-.not_finite.outside",
     .count = 7,
     .state = REPORT_KNOWN,
     .reason = "why # not",
     .cause = NASTY,
     .opinion = "  blanks first\n\n\n...\n---\n- x: y"},
    {.signature = "vulkan.f32.bits.shader", .count = 2, .state = REPORT_EXPIRED, .reason = "old"},
    {.signature = "vulkan.f32.missed.shader", .count = 2, .state = REPORT_FLAKY, .reason = "once"},
};

static const char *const note[] = {"list:3: excused nothing"};

static struct findings_report made_up(void)
{
    return (struct findings_report){.seed = UINT64_MAX,
                                    .trials = 100,
                                    .before = 60,
                                    .judged = 50000,
                                    .seconds = 2.5,
                                    .harness_share = 0.125,
                                    .contestant = who,
                                    .contestants = ARRAY_COUNT(who),
                                    .finding = found,
                                    .findings = ARRAY_COUNT(found),
                                    .note = note,
                                    .notes = ARRAY_COUNT(note)};
}

typedef enum status writer(const struct findings_report *report, const char *to,
                           struct reason *why);

static char *written(writer *write, const struct findings_report *report, const char *name)
{
    char *text = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", root, name);
    if (write(report, path, &reason) || file_read(path, &text, &size, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(strlen(text), size);
    return text;
}

/* Runs a reader that may not be here: 127 is the shell's word for that. */
static void accepted_by(const char *format)
{
    char command[300];
    snprintf(command, sizeof command, format, path);
    int code = system(command);
    if (WEXITSTATUS(code) == 127)
        print_message("not here: %s\n", command);
    else
        assert_int_equal(code, 0);
}

/* --- a small reader of XML -------------------------------------------------------------------- */

struct xml {
    const char *at;
    char open[8][20]; /* names of the elements that are open */
    size_t depth, elements;
};

/* Takes text up to `end` off, entities resolved. */
static void xml_text(struct xml *xml, char end, char *out, size_t size)
{
    static const struct {
        const char *name;
        char is;
    } entity[] = {{"&lt;", '<'},   {"&gt;", '>'},   {"&amp;", '&'},
                  {"&quot;", '"'}, {"&#10;", '\n'}, {"&#9;", '\t'}};
    size_t used = 0;
    while (*xml->at != end) {
        char c = *xml->at++;
        assert_true(c && c != '<' && (unsigned char)c != 0x7F);
        assert_true((unsigned char)c >= ' ' || c == '\n');
        if (c == '&') {
            size_t e = 0;
            xml->at--;
            while (e < ARRAY_COUNT(entity) &&
                   strncmp(xml->at, entity[e].name, strlen(entity[e].name)) != 0)
                e++;
            assert_true(e < ARRAY_COUNT(entity));
            xml->at += strlen(entity[e].name);
            c = entity[e].is;
        }
        assert_true(used + 1 < size);
        out[used++] = c;
    }
    out[used] = '\0';
}

static void xml_name(struct xml *xml, char out[20])
{
    size_t length = strspn(xml->at, "abcdefghijklmnopqrstuvwxyz-");
    assert_in_range(length, 1, 19);
    memcpy(out, xml->at, length);
    out[length] = '\0';
    xml->at += length;
}

/* The next element's start or, with '/' before its name, its end; false at the end of the file. Of
 * attributes `wanted` is returned in value ("" if it has none); of text, what stands before it. */
static bool xml_next(struct xml *xml, char name[24], const char *wanted, char *value, char *text)
{
    char attribute[20], other[4096];
    value[0] = '\0';
    if (!strchr(xml->at, '<')) {
        assert_int_equal(xml->depth, 0);
        assert_string_equal(xml->at, "\n");
        return false;
    }
    xml_text(xml, '<', text, 4096);
    xml->at++;
    bool end = *xml->at == '/';
    xml->at += end;
    xml_name(xml, name);
    while (*xml->at == ' ') {
        xml->at++;
        xml_name(xml, attribute);
        assert_int_equal(strncmp(xml->at, "=\"", 2), 0);
        xml->at += 2;
        xml_text(xml, '"', strcmp(attribute, wanted) == 0 ? value : other, 4096);
        xml->at++;
    }
    assert_int_equal(*xml->at++, '>');
    if (end) {
        assert_true(xml->depth > 0);
        assert_string_equal(xml->open[--xml->depth], name);
        memmove(name + 1, name, strlen(name) + 1);
        name[0] = '/';
    } else {
        assert_true(xml->depth < ARRAY_COUNT(xml->open));
        strcpy(xml->open[xml->depth++], name);
        xml->elements++;
    }
    return true;
}

static void junit_is_read_back(void **state)
{
    (void)state;
    const struct findings_report report = made_up();
    char *file = written(report_junit, &report, "junit.xml"), name[24], value[4096], text[4096];
    char last[4096] = "";
    size_t cases = 0, failures = 0, skipped = 0;
    struct xml xml = {.at = strstr(file, "?>")};
    assert_int_equal(strncmp(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", 39), 0);
    xml.at += 2;
    while (xml_next(&xml, name, xml.depth == 3 ? "message" : "name", value, text)) {
        if (strcmp(name, "testcase") == 0) {
            cases++;
            strcpy(last, value);
        }
        if (strcmp(name, "skipped") == 0) {
            skipped++;
            if (strcmp(last, "embree.-.not_finite.outside") == 0)
                assert_string_equal(value, "known, found 7 times: why # not");
            if (strcmp(last, "vulkan.f32.played") == 0)
                assert_string_equal(value, "no Vulkan device here");
            if (strcmp(last, "pipe:a.out.played") == 0)
                assert_string_equal(value, "played no trial, refused 100");
        }
        failures += strcmp(name, "failure") == 0;
        if (strcmp(name, "/failure") == 0 && strcmp(last, found[0].signature) == 0)
            assert_string_equal(text, "cause: " NASTY "\nseen: line 1\nline 2\ttab\n"
                                      "replay: raydiff replay 'f/smallest.trial'\n"
                                      "smallest: f/" MENDED "\n"
                                      "size: 1 triangle, 3 vertices, 1 ray\n"
                                      "first: f/cpu.rf16.missed.stack/first.trial");
        if (strcmp(name, "/system-out") == 0 && strcmp(last, "cpu.rf16.played") == 0)
            assert_string_equal(text,
                                "90 trials played, refused 7; its layout refused 10 of this run");
        if (strcmp(name, "/system-out") == 0 && strcmp(last, "trials") == 0)
            assert_string_equal(text, "100 trials of seed 18446744073709551615; 40 of this run: "
                                      "50000 rays judged, 2.5 s\n"
                                      "list:3: excused nothing");
    }
    assert_int_equal(cases, 1 + ARRAY_COUNT(who) + ARRAY_COUNT(found));
    assert_int_equal(failures, 2);
    assert_int_equal(skipped, 4);
    assert_non_null(strstr(file, " tests=\"8\" failures=\"2\" errors=\"0\" skipped=\"4\" "));
    accepted_by("xmllint --noout '%s'");
    free(file);
}

static void tap_is_read_back(void **state)
{
    (void)state;
    struct findings_report report = made_up();
    char *file = written(report_tap, &report, "a.tap");
    assert_int_equal(strncmp(file, "TAP version 13\n1..8\nok 1 - trials\n", 33), 0);
    static const char *const lines[] = {

        "\nok 2 - cpu.rf16.played\n",
        "\nok 3 - vulkan.f32.played # SKIP no Vulkan device here\n",
        "\nok 4 - pipe:a.out.played # SKIP played no trial, refused 100\n",
        "\nnot ok 5 - cpu.rf16.missed.stack\n",
        "\nnot ok 6 - embree.-.not_finite.outside # TODO known, found 7 times: why \\# not\n",
        "\nnot ok 7 - vulkan.f32.bits.shader\n",
        "\nnot ok 8 - vulkan.f32.missed.shader # TODO flaky, found 2 times: once\n",
        "  detail: |\n    cause: " NASTY "\n    seen: line 1\n    line 2\ttab\n    replay: ",
        "\n    smallest: f/" MENDED "\n",
        "  ---\n  message: \"known, found 7 times: why # not\"\n"};
    for (size_t i = 0; i < ARRAY_COUNT(lines); i++)
        if (!strstr(file, lines[i]))
            fail_msg("not there: %s in\n%s", lines[i], file);
    free(file);
    /* prove fails where a test does, so that it is asked about what passes. */
    report.finding = found + 1;
    report.findings = 1;
    free(written(report_tap, &report, "b.tap"));
    accepted_by("prove -Q --exec cat '%s' >/dev/null 2>&1");
}

static json_t *line_of(const char *file, const char *type, size_t number)
{
    for (const char *line = file; *line; line += strcspn(line, "\n") + 1) {
        json_t *one = json_loadb(line, strcspn(line, "\n"), 0, NULL);
        assert_non_null(one);
        if (strcmp(json_string_value(json_object_get(one, "type")), type) == 0 && number-- == 0)
            return one;
        json_decref(one);
    }
    fail_msg("no line %s", type);
    return NULL;
}

static const char *text_of(const json_t *object, const char *name)
{
    return json_string_value(json_object_get(object, name));
}

static void json_lines_are_read_back(void **state)
{
    (void)state;
    const struct findings_report report = made_up();
    char *file = written(report_jsonl, &report, "a.jsonl");
    json_t *one = line_of(file, "campaign", 0);
    assert_string_equal(text_of(one, "seed"), "18446744073709551615");
    assert_int_equal(json_integer_value(json_object_get(one, "trials")), 100);
    assert_int_equal(json_integer_value(json_object_get(one, "failures")), 2);
    assert_int_equal(json_integer_value(json_object_get(one, "trials_before")), 60);
    assert_true(json_number_value(json_object_get(one, "trials_per_s")) == 16);
    assert_true(json_number_value(json_object_get(one, "judged_rays_per_s")) == 20000);
    assert_true(json_number_value(json_object_get(one, "harness_share")) == 0.125);
    json_decref(one);
    one = line_of(file, "contestant", 0);
    assert_int_equal(json_integer_value(json_object_get(one, "played")), 90);
    assert_int_equal(json_integer_value(json_object_get(one, "refused")), 7);
    assert_int_equal(json_integer_value(json_object_get(one, "refused_in_this_run")), 10);
    assert_true(json_number_value(json_object_get(one, "seconds")) == 1.25);
    json_decref(one);
    one = line_of(file, "contestant", 1);
    assert_string_equal(text_of(one, "name"), "vulkan.f32");
    assert_string_equal(text_of(one, "why"), "no Vulkan device here");
    json_decref(one);
    one = line_of(file, "finding", 0);
    assert_string_equal(text_of(one, "cause"), NASTY);
    assert_string_equal(text_of(one, "seen"), "line 1\nline 2\ttab");
    assert_string_equal(text_of(one, "smallest"), "f/" MENDED);
    assert_true(json_is_true(json_object_get(one, "counts")));
    assert_true(json_is_null(json_object_get(one, "reason")));
    json_decref(one);
    one = line_of(file, "finding", 3);
    assert_string_equal(text_of(one, "state"), "flaky");
    assert_true(json_is_false(json_object_get(one, "counts")));
    json_decref(one);
    one = line_of(file, "note", 0);
    assert_string_equal(text_of(one, "text"), note[0]);
    json_decref(one);
    free(file);
}

/* Without findings: CI sees who played; without trials: that nothing was tested. */
static void what_was_tested_is_told(void **state)
{
    (void)state;
    struct findings_report report = {.trials = 5, .contestant = who, .contestants = 1};
    assert_int_equal(report_failures(&report), 0);
    char *file = written(report_tap, &report, "c.tap");
    assert_string_equal(
        file, "TAP version 13\n1..2\nok 1 - trials\n"
              "  ---\n  severity: comment\n  detail: |\n"
              "    5 trials of seed 0, 0 rays judged, 0.0 s\n  ...\n"
              "ok 2 - cpu.rf16.played\n"
              "  ---\n  severity: comment\n  seconds: 1.250\n  detail: |\n"
              "    90 trials played, refused 7; its layout refused 10 of this run\n  ...\n");
    free(file);
    report.trials = 0;
    report.contestants = 0;
    assert_int_equal(report_failures(&report), 1);
    file = written(report_junit, &report, "d.xml");
    assert_non_null(strstr(file, "<failure message=\"no trial was played: nothing is tested\""));
    free(file);
}

/* Whole or not at all. */
static void files_that_cannot_be_written_are_told(void **state)
{
    static writer *const write[] = {report_junit, report_tap, report_jsonl};
    (void)state;
    const struct findings_report report = made_up();
    for (size_t i = 0; i < ARRAY_COUNT(write); i++) {
        assert_int_equal(write[i](&report, root, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "is a directory"));
        assert_int_equal(write[i](&report, "/dev/full", &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "/dev/full: cannot write: "));
    }
    struct ci_junit junit;
    snprintf(path, sizeof path, "%s/dropped.xml", root);
    assert_int_equal(ci_junit_open(path, &junit, &reason), STATUS_OK);
    ci_junit_add(&junit, &(struct ci_case){.group = "a", .name = "b"});
    ci_junit_discard(&junit);
    ci_junit_discard(&junit);
    assert_int_not_equal(access(path, F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(junit_is_read_back),
        cmocka_unit_test(tap_is_read_back),
        cmocka_unit_test(json_lines_are_read_back),
        cmocka_unit_test(what_was_tested_is_told),
        cmocka_unit_test(files_that_cannot_be_written_are_told),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
