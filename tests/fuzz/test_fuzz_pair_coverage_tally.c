/* What the tally of pairs comes to: by hand, from its file, and against what a campaign played. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/campaign/campaign.h"
#include "fuzz/feedback/pair_coverage.h"
#include "fuzz/campaign/worker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/pair_fixture.h"

/* Two builders, one of them as published, a layout, a test each; engine cpu and brute. */
static struct pair_coverage *open_few(uint32_t motions)
{
    static struct pair_tables tables;
    struct pair_coverage *m;
    tables = (struct pair_tables){.count = {[MEET_OPTIMIZE] = 2, [MEET_MOTION] = motions}};
    add(&tables, MEET_ENGINE, engine_find("cpu"));
    add(&tables, MEET_ENGINE, engine_find("brute"));
    add(&tables, MEET_LAYOUT, layout_find("f32"));
    add(&tables, MEET_LAYOUT, layout_find("rtrs_direct"));
    add(&tables, MEET_BUILDER, builder_find("median"));
    add(&tables, MEET_BUILDER, builder_find("rtrs"));
    add(&tables, MEET_STORE, tri_stores[0]);
    add(&tables, MEET_TRI, tri_test_find("mt"));
    add(&tables, MEET_BOX, box_test_find("robust"));
    if (pair_coverage_open(&tables, &m, &reason))
        fail_msg("%s", reason.text);
    return m;
}

static void meet(struct pair_coverage *m, const char *engine, const char *layout,
                 const char *builder, bool optimized, bool moved, uint32_t times)
{
    struct combination met = pair_coverage_of(
        m, engine_find(engine), layout_find(layout), builder_find(builder), tri_stores[0],
        tri_test_find("mt"), box_test_find("robust"), optimized, moved);
    for (uint32_t i = 0; i < times; i++)
        pair_coverage_add(m, &met);
}

static bool possible(const struct pair_coverage *m, enum pair_factor a, const char *x,
                     enum pair_factor b, const char *y)
{
    return pair_coverage_of_pair(m, a, named(m, a, x), b, named(m, b, y))->possible;
}

/* Of 73 pairs engine brute meets the triangle test's alone and not 10 others, and what is as
 * published is neither optimized nor refitted. A trial of an engine with a tree is 28 pairs. */
static void summaries_by_hand(void **state)
{
    (void)state;
    struct pair_coverage *m = open_few(2);
    char name[PAIR_NAME_MOST], before[PAIR_NAME_MOST] = "";
    uint64_t count, least = 0, sum = 0;
    assert_false(possible(m, MEET_BUILDER, "rtrs", MEET_OPTIMIZE, "reinsert"));
    assert_true(possible(m, MEET_BUILDER, "rtrs", MEET_OPTIMIZE, "plain"));
    assert_true(possible(m, MEET_BUILDER, "median", MEET_OPTIMIZE, "reinsert"));
    assert_false(possible(m, MEET_LAYOUT, "rtrs_direct", MEET_MOTION, "moved"));
    assert_true(possible(m, MEET_LAYOUT, "rtrs_direct", MEET_MOTION, "still"));
    struct pair_coverage_summary none = pair_coverage_summarize(m, 1);
    assert_int_equal(none.possible + none.impossible, 73);
    assert_int_equal(none.impossible, 10 + 2);
    assert_int_equal(none.met, 0);
    assert_int_equal(none.below, none.possible);
    assert_true(none.least == 0 && none.median == 0);
    meet(m, "cpu", "f32", "median", true, true, 9);
    struct pair_coverage_summary some = pair_coverage_summarize(m, 9);
    assert_int_equal(some.met, 28);
    assert_int_equal(some.below, some.possible - 28);
    assert_true(some.least == 0);
    assert_int_equal(pair_coverage_summarize(m, 10).below, some.possible);
    meet(m, "cpu", "rtrs_direct", "rtrs", false, false, 3);
    meet(m, "cpu", "f32", "rtrs", false, true, 2);
    meet(m, "cpu", "rtrs_direct", "median", false, false, 2);
    meet(m, "cpu", "rtrs_direct", "median", true, false, 2);
    meet(m, "cpu", "f32", "median", true, false, 2);
    meet(m, "brute", "f32", "median", true, true, 5);
    assert_int_equal(pair_coverage_summarize(m, 1).below, 0);
    assert_true(pair_coverage_summarize(m, 1).least == 2);
    const uint64_t median = pair_coverage_summarize(m, 1).median;
    for (uint32_t i = 0; i < some.possible; i++) { /* each pair once, the rarest first */
        assert_true(pair_coverage_rarest(m, i, name, &count));
        assert_string_not_equal(name, before);
        assert_true(count >= least);
        strcpy(before, name);
        least = count;
        sum += count;
        if (i == some.possible / 2)
            assert_true(count == median);
    }
    assert_true(median > 2 && median < 20);
    assert_int_equal(sum, 28 * (9 + 3 + 2 + 2 + 2 + 2) + 5);
    assert_string_equal(name, "tri.mt box.robust"); /* the last that met in all 20 */
    assert_false(pair_coverage_rarest(m, some.possible, name, &count));
    pair_coverage_close(m);
}

/* Of a file in the folder of temporary files. */
static enum status read_tally(struct pair_coverage *m, const char *path)
{
    struct folder folder;
    assert_int_equal(folder_open("/tmp", false, &folder, &reason), STATUS_OK);
    enum status status = pair_coverage_read(m, &folder, strrchr(path, '/') + 1, &reason);
    folder_close(&folder);
    return status;
}

static void write_tally(const struct pair_coverage *m, const char *path)
{
    struct folder folder;
    assert_int_equal(folder_open("/tmp", false, &folder, &reason), STATUS_OK);
    assert_int_equal(pair_coverage_write(m, &folder, strrchr(path, '/') + 1, &reason), STATUS_OK);
    folder_close(&folder);
}

static void tallies_come_back_from_their_file(void **state)
{
    (void)state;
    char path[] = "/tmp/pair_coverage.XXXXXX", name[PAIR_NAME_MOST];
    struct pair_coverage *m = open_all(), *again = open_all();
    uint64_t count;
    int made = mkstemp(path);
    assert_true(made >= 0);
    close(made);
    unlink(path);
    assert_int_equal(read_tally(again, path), STATUS_OK); /* there is none */
    for (uint32_t turn = 0; turn < 700; turn++) {
        struct combination drawn;
        pair_coverage_draw(m, 5, turn, 64, &drawn);
        pair_coverage_add(m, &drawn);
    }
    write_tally(m, path);
    assert_int_equal(read_tally(again, path), STATUS_OK);
    struct pair_coverage_summary x = pair_coverage_summarize(m, 2),
                                 y = pair_coverage_summarize(again, 2);
    assert_memory_equal(&x, &y, sizeof x);
    for (uint32_t i = 0; i < 20; i++) {
        char other[PAIR_NAME_MOST];
        uint64_t other_count;
        assert_true(pair_coverage_rarest(m, i, name, &count));
        assert_true(pair_coverage_rarest(again, i, other, &other_count));
        assert_string_equal(name, other);
        assert_int_equal(count, other_count);
    }
    static const char *const bad[] = {"", " 3 4", " many", " 3 and more"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fprintf(file, "engine.cpu layout.f32 3\nengine.cpu layout.f32%s\n", bad[i]);
        fclose(file);
        assert_int_equal(read_tally(again, path), STATUS_INPUT);
        assert_non_null(strstr(reason.text, ":2:"));
    }
    unlink(path);
    pair_coverage_close(m);
    pair_coverage_close(again);
}

/* What an earlier run has played is not drawn again before all others. */
static void draws_go_on_from_the_file(void **state)
{
    (void)state;
    char path[] = "/tmp/pair_coverage.XXXXXX";
    struct pair_coverage *m = open_few(1);
    struct combination drawn;
    int file = mkstemp(path);
    assert_true(file >= 0);
    static const char *const with[] = {
        "engine.cpu", "builder.median", "builder.rtrs",      "store.indexed", "tri.mt",
        "box.robust", "optimize.plain", "optimize.reinsert", "motion.still"};
    for (size_t i = 0; i < ARRAY_COUNT(with); i++)
        assert_true(dprintf(file, "layout.f32 %s 1000\n", with[i]) > 0);
    close(file);
    assert_int_equal(read_tally(m, path), STATUS_OK);
    unlink(path);
    uint32_t other = named(m, MEET_LAYOUT, "rtrs_direct"), cpu = named(m, MEET_ENGINE, "cpu"),
             trees = 0;
    for (uint32_t turn = 0; turn < 20; turn++) {
        pair_coverage_draw(m, 1, turn, 8, &drawn);
        if (drawn.member[MEET_ENGINE] != cpu) /* brute: no layout takes part */
            continue;
        assert_int_equal(drawn.member[MEET_LAYOUT], other);
        trees++;
    }
    assert_true(trees > 5);
    pair_coverage_close(m);
}

static const struct work_rules rules = {
    .seed = 12, .gen = {.triangles_least = 8, .triangles_most = 30, .rays = 40}};

/* Trials by pairs of factors, of engines by each. */
struct coverage_tally {
    uint64_t engine[ARRAY_COUNT(engine_names)][MEET_FACTORS];
    uint64_t still, moved; /* by layouts */
};

static struct coverage_tally tally_of(const struct pair_coverage *m)
{
    char path[] = "/tmp/pair_coverage.XXXXXX", first[PAIR_NAME_MOST], second[PAIR_NAME_MOST];
    struct coverage_tally tally = {.still = 0};
    unsigned long long count;
    int made = mkstemp(path);
    assert_true(made >= 0);
    close(made);
    write_tally(m, path);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fscanf(file, "%119s %119s %llu", first, second, &count) == 3) {
        for (size_t e = 0; e < ARRAY_COUNT(engine_names); e++)
            for (enum pair_factor f = 0; f < MEET_FACTORS; f++)
                if (strncmp(first, "engine.", 7) == 0 && strcmp(first + 7, engine_names[e]) == 0 &&
                    strncmp(second, pair_factor_name(f), strcspn(second, ".")) == 0)
                    tally.engine[e][f] += count;
        bool layout = strncmp(first, "layout.", 7) == 0;
        tally.still += layout && strcmp(second, "motion.still") == 0 ? count : 0;
        tally.moved += layout && strcmp(second, "motion.moved") == 0 ? count : 0;
    }
    fclose(file);
    unlink(path);
    return tally;
}

/* Whoever played met as many triangle tests, layouts, builders; a tree that moved was refitted, or
 * is in no pair of motion. */
static void tally_is_of_what_was_played(void *user, const struct campaign_view *view)
{
    const struct coverage_tally tally = tally_of(view->options->pair_coverage);
    uint64_t on_trees = 0, refused = 0;
    for (size_t e = 0; e < ARRAY_COUNT(engine_names); e++) {
        const struct engine *engine = engine_find(engine_names[e]);
        uint64_t played = view->trials - view->refused[e] - view->unasked[e];
        refused += view->refused[e];
        if (!engine->own_tri)
            assert_int_equal(tally.engine[e][MEET_TRI], played);
        if (!engine->needs_packed)
            continue;
        assert_int_equal(tally.engine[e][MEET_LAYOUT], played);
        assert_int_equal(tally.engine[e][MEET_BUILDER], played);
        on_trees += played;
    }
    assert_int_equal(tally.moved, view->refitted);
    assert_int_equal(tally.still + tally.moved + view->rebuilt, on_trees);
    assert_true(view->refitted > 20 && view->rebuilt > 5 && refused > 0);
    *(bool *)user = true;
}

/* Who meets does not depend on who plays: a block's members are drawn from what blocks long before
 * it have missed. */
static void tallies_are_those_of_any_number_of_workers(void **state)
{
    (void)state;
    static char text[2][200000];
    for (uint32_t jobs = 1; jobs <= 2; jobs++) {
        char folder[] = "/tmp/pair_coverage.XXXXXX", path[64], command[100];
        const struct engine *engine[ARRAY_COUNT(engine_names)];
        struct campaign_options options = {.trials = 16 * FUZZ_BATCH,
                                           .shard = 1,
                                           .shards = 1,
                                           .jobs = jobs,
                                           .trial_ms = 10000,
                                           .identity = "gen=0",
                                           .rules = rules};
        const struct engine_options engines_of = {.threads = 1, .device = -1};
        struct findings *findings;
        for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
            engine[i] = engine_find(engine_names[i]);
        assert_non_null(mkdtemp(folder));
        options.folder = folder;
        options.pair_coverage = open_all();
        assert_int_equal(fuzz_field_draw(engine, ARRAY_COUNT(engine), &engines_of,
                                         &options.rules.field, &reason),
                         0);
        assert_int_equal(findings_open(folder, &findings, &reason), STATUS_OK);
        bool ended = false;
        options.user = &ended;
        if (campaign_run(&options, findings, tally_is_of_what_was_played, &reason))
            fail_msg("%s", reason.text);
        assert_true(ended);
        assert_int_equal(findings_count(findings), 0);
        findings_close(findings);
        assert_true(pair_coverage_summarize(options.pair_coverage, 1).met > 100);
        pair_coverage_close(options.pair_coverage);
        snprintf(path, sizeof path, "%s/pairs.txt", folder);
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        assert_true(fread(text[jobs - 1], 1, sizeof text[0] - 1, file) > 1000);
        fclose(file);
        snprintf(command, sizeof command, "rm -rf %s", folder);
        assert_int_equal(system(command), 0);
    }
    assert_string_equal(text[0], text[1]);
}

/* Pairs are of members: a table that has none is named. */
static void an_empty_table_is_named(void **state)
{
    (void)state;
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++) {
        struct pair_tables tables = all_tables();
        struct pair_coverage *m = NULL;
        char why[60];
        snprintf(why, sizeof why, "pairs: there is no %s", pair_factor_name(a));
        tables.count[a] = 0;
        assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_INPUT);
        assert_string_equal(reason.text, why);
        assert_null(m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(summaries_by_hand),
        cmocka_unit_test(tallies_come_back_from_their_file),
        cmocka_unit_test(draws_go_on_from_the_file),
        cmocka_unit_test(tallies_are_those_of_any_number_of_workers),
        cmocka_unit_test(an_empty_table_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
