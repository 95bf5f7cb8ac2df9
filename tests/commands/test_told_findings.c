/* Numbers that raydiff min, replay and fuzz --self-test tell: no two are the same, and each is
 * looked for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/fuzz/cmd_min.h"
#include "cmd/fuzz/cmd_replay.h"
#include "cmd/fuzz/cmd_selftest.h"

#include "tests/commands/told.h"

/* --- min -------------------------------------------------------------------------------------- */

static struct min_row min_made(enum min_fate fate)
{
    return (struct min_row){
        .path = "p",
        .written = "w",
        .file = {.signature = {.engine = "cpu", .layout = layout_find("f32")}},
        .engine = engine_find("cpu"),
        .stats =
            {.before = {.instances = 11, .triangles = 12, .rays = 13, .vertices = 14, .bits = 15},
             .after = {.instances = 21, .triangles = 22, .rays = 23, .vertices = 24, .bits = 25},
             .asks = 31,
             .tried = 32,
             .accepted = 33,
             .rounds = 34,
             .finding = {.ray = 35}},
        .bytes_before = 36,
        .bytes_after = 37,
        .fate = fate,
        .code = 1,
    };
}

static const struct told_number min_numbers[] = {
    {"exit", 2},
    {"findings.0.before.instances", 11},
    {"findings.0.before.triangles", 12},
    {"findings.0.before.rays", 13},
    {"findings.0.before.vertices", 14},
    {"findings.0.before.bits", 15},
    {"findings.0.before.bytes", 36},
    {"findings.0.after.instances", 21},
    {"findings.0.after.triangles", 22},
    {"findings.0.after.rays", 23},
    {"findings.0.after.vertices", 24},
    {"findings.0.after.bits", 25},
    {"findings.0.after.bytes", 37},
    {"findings.0.asks", 31},
    {"findings.0.tried", 32},
    {"findings.0.accepted", 33},
    {"findings.0.rounds", 34},
    {"findings.0.exit", 1},
};

static void what_was_shrunk(void **state)
{
    (void)state;
    static struct min_row row;
    struct reason reason;
    row = min_made(MIN_SMALLER);
    const char *const page[] = {
        "before 11 instances, 12 triangles, 13 rays, 14 vertices, 15 bits of numbers, 36 bytes",
        "after 21 instances, 22 triangles, 23 rays, 24 vertices, 25 bits of numbers, 37 bytes",
        "asked 32 trials in 34 rounds (31 asks), 33 smaller;",
    };
    const char *const line[] = {"finding triangles, rays now asks\n", " 12, 13 22, 23 31 smaller"};
    told_begin(&stdout);
    min_print(&row);
    told_text(told_end(), page, ARRAY_COUNT(page));
    told_begin(&stdout);
    min_print_line(NULL);
    min_print_line(&row);
    told_text(told_end(), line, ARRAY_COUNT(line));
    assert_int_equal(min_write_json(told_file(), &row, 1, 2, &reason), STATUS_OK);
    told_json(told_file_json(), min_numbers, ARRAY_COUNT(min_numbers));
}

/* --- replay ----------------------------------------------------------------------------------- */

static const struct told_number replay_numbers[] = {
    {"exit", 2},
    {"files.0.exit", 1},
    {"files.0.fails", 1},
    {"files.0.triangles", 41},
    {"files.0.rays", 42},
    {"files.0.instances", 43},
    {"files.0.played.0.findings.0.ray", 17},
    {"files.0.played.0.findings.0.expected", 0},
    {"files.0.played.0.findings.1.ray", 18},
    {"files.0.played.0.findings.1.expected", 1},
};

static void what_was_replayed(void **state)
{
    (void)state;
    static const struct turnout none;
    static struct replay_file file;
    const struct screen screen = {.width = 4000, .wide = true};
    struct reason reason;
    file = (struct replay_file){.path = "p", .played_count = 1, .fails = true, .code = 1};
    file.file.trial = (struct fuzz_trial){.origin = {.seed = 44, .index = 45, .version = 46},
                                          .scene = {.tri_count = 41},
                                          .world = {.is = true, .instance_count = 43},
                                          .ray_count = 42,
                                          .builder = builders_all[0],
                                          .build = {.leaf = 47},
                                          .box = box_tests[0],
                                          .tri = tri_tests[0]};
    file.played[0] = (struct replay_played){
        .who = {.engine = engine_find("cpu"), .layout = layout_find("f32")},
        .finding = {{.ray = 17, .signature = {.engine = "cpu"}, .said = "a"},
                    {.ray = 18, .signature = {.engine = "cpu"}, .said = "b"}},
        .finding_count = 2,
        .expected = 1};
    const char *const page[] = {
        "trial 43 instances, 41 triangles, 42 rays, builder median, leaf 47,",
        "from seed 44, trial 45 of stream gen, generators 46",
    };
    told_begin(&stdout);
    replay_print(&screen, false, &file);
    told_text(told_end(), page, ARRAY_COUNT(page));
    assert_int_equal(replay_write_json(told_file(), &file, 1, &none, 2, &reason), STATUS_OK);
    told_json(told_file_json(), replay_numbers, ARRAY_COUNT(replay_numbers));
}

/* --- the self-test ---------------------------------------------------------------------------- */

static struct selftest_bug bug = {.bug = "B", .unit = "u", .engines = "cpu", .layouts = "f32"};

static struct selftest_row bug_played(bool control, enum selftest_end end, uint64_t trials,
                                      double seconds)
{
    return (struct selftest_row){
        .bug = &bug,
        .control = control,
        .ended = true,
        .job = {.result = {.end = end, .trials = trials, .seconds = seconds}}};
}

static const struct told_number bug_numbers[] = {
    {"seed", 59},
    {"passed", 0},
    {"found", 4},
    {"of", 5},
    {"skipped", 2},
    {"median_s", (3 + 5.5) / 2},
    {"slowest_s", 8},
    {"seconds", 99},
    {"bugs.0.trials", 101},
    {"bugs.0.seconds", 8},
    {"bugs.1.trials", 102},
    {"bugs.1.seconds", 3},
    {"bugs.2.trials", 103},
    {"bugs.2.seconds", 2},
    {"bugs.3.trials", 104},
    {"bugs.3.seconds", 5.5},
    {"bugs.4.trials", 105},
    {"bugs.4.seconds", 11},
    {"bugs.5.trials", 106},
    {"bugs.5.seconds", 12},
    {"controls.0.trials", 107},
    {"controls.0.seconds", 13},
    {"controls.1.trials", 108},
    {"controls.1.seconds", 14},
    {"controls.2.trials", 109},
    {"controls.2.seconds", 15},
    {"controls.3.trials", 110},
    {"controls.3.seconds", 16},
};

/* The median of an even number of bugs is the mean of the two in the middle; what was not found has
 * no time; what was skipped is not among the played. */
static void what_a_self_test_tells(void **state)
{
    (void)state;
    static struct selftest_row row[10];
    struct selftest_command c = {.seed = 59, .row = row, .rows = 10, .planted = 6};
    struct reason reason;
    row[0] = bug_played(false, SELFTEST_FOUND, 101, 8);
    row[1] = bug_played(false, SELFTEST_FOUND, 102, 3);
    row[2] = bug_played(false, SELFTEST_FOUND, 103, 2);
    row[3] = bug_played(false, SELFTEST_FOUND, 104, 5.5);
    row[4] = bug_played(false, SELFTEST_CLEAN, 105, 11);
    row[5] = bug_played(false, SELFTEST_SKIPPED, 106, 12);
    row[6] = bug_played(true, SELFTEST_CLEAN, 107, 13);
    row[7] = bug_played(true, SELFTEST_CLEAN, 108, 14);
    row[8] = bug_played(true, SELFTEST_SKIPPED, 109, 15);
    row[9] = bug_played(true, SELFTEST_FOUND, 110, 16);
    struct selftest_sum sum = selftest_sum(&c);
    assert_int_equal(sum.clean, 2);
    assert_int_equal(sum.controls, 3);
    sum.seconds = 99;
    const char *const lines[] = {" 101 8.00",
                                 " 102 3.00",
                                 " 103 2.00",
                                 " 104 5.50",
                                 " 105 11.00 NOT FOUND",
                                 " 106 12.00 skipped",
                                 " 107 13.00 clean",
                                 " 108 14.00 clean",
                                 " 109 15.00 skipped",
                                 " 110 16.00 NOT CLEAN",
                                 "99 s in all; a bug's median 4.25 s, the slowest 8.00 s",
                                 "2 skipped",
                                 "without a bug 2 of 3 clean",
                                 "found 4 of 5"};
    told_begin(&stdout);
    selftest_print_head();
    selftest_print_rows(&c);
    selftest_print_sum(&sum);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    c.json = told_file();
    assert_int_equal(selftest_json(&c, &sum, &reason), STATUS_OK);
    told_json(told_file_json(), bug_numbers, ARRAY_COUNT(bug_numbers));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_shrunk),
        cmocka_unit_test(what_was_replayed),
        cmocka_unit_test(what_a_self_test_tells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
