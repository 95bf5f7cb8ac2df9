/* Memory that runs out while texts are read and trials are made: each allocation in turn fails. */
#include "tests/support/allocations.h"

#include "fuzz/feedback/feedback.h"
#include "fuzz/feedback/pair_coverage.h"
#include "fuzz/findings/baseline.h"
#include "fuzz/findings/finding_file.h"
#include "fuzz/gen/covering.h"
#include "fuzz/gen/gen.h"
#include "fuzz/gen/mutate.h"
#include "ref/base/rng.h"
#include "ref/files/file.h"
#include "ref/outside/pipe_text.h"
#include "ref/store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"

/* --- texts ------------------------------------------------------------------------------------ */

static enum status do_pipe(const void *of, struct reason *reason)
{
    const struct pipe_limits limits = pipe_limits_none();
    struct pipe_text text;
    enum status status = pipe_text_parse("file", of, strlen(of), &limits, &text, reason);
    if (status)
        assert_true(!text.ray && !text.hit && !text.tag && !text.mode && !text.world.mesh &&
                    !text.scene.vertex);
    pipe_text_free(&text);
    return status;
}

/* Requests and answers, of a scene and of a world. Each array has to grow, too. */
static void requests_and_answers(void **state)
{
    (void)state;
    static const char scene[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nt 0 1 2\n",
                      world[] = "mesh\nv 0 0 0\nv 1 0 0\nv 0 1 0\nt 0 1 2\ng 1 filtered\n",
                      placed[] = "i 0 9 255 0 1 0 0 5 0 1 0 0 0 0 1 0\n",
                      ray[] = "r 0.25 0.25 -1 0 0 0 1 9\n", mode[] = "r 0 0 -1 0 0 0 1 9 255 16\n",
                      hit[] = "h 1 0.25 0.25 0\nm\n";
    static char text[4][8192];
    size_t used[4];
    used[0] = (size_t)snprintf(text[0], sizeof *text, "raydiff 1\nquery any\n");
    used[1] = (size_t)snprintf(text[1], sizeof *text, "raydiff 2\nquery any\nfilter cells 7 128\n");
    used[2] = (size_t)snprintf(text[2], sizeof *text, "raydiff 1\n");
    for (int i = 0; i < 20; i++) {
        used[0] += (size_t)snprintf(text[0] + used[0], sizeof *text - used[0], "%s", scene);
        used[1] += (size_t)snprintf(text[1] + used[1], sizeof *text - used[1], "%s", world);
        used[2] += (size_t)snprintf(text[2] + used[2], sizeof *text - used[2], "%s", hit);
    }
    for (int i = 0; i < 20; i++)
        used[1] += (size_t)snprintf(text[1] + used[1], sizeof *text - used[1], "%s", placed);
    for (int i = 0; i < 20; i++) {
        used[0] += (size_t)snprintf(text[0] + used[0], sizeof *text - used[0], "%s", ray);
        used[1] += (size_t)snprintf(text[1] + used[1], sizeof *text - used[1], "%s", mode);
    }
    for (int i = 0; i < 3; i++)
        strcat(text[i], "end\n");
    assert_true(each_fails("a request", do_pipe, text[0], 1) > 3);
    assert_true(each_fails("a world", do_pipe, text[1], 1) > 40);
    assert_true(each_fails("an answer", do_pipe, text[2], 1) > 0);
}

static enum status do_waivers(const void *of, struct reason *reason)
{
    struct waivers list;
    (void)of;
    enum status status = waivers_shipped_read(&list, reason);
    if (status)
        assert_true(!list.waiver && !list.text);
    waivers_free(&list);
    return status;
}

static enum status do_baseline(const void *of, struct reason *reason)
{
    struct baseline baseline;
    (void)of;
    enum status status = baseline_open(&baseline, reason);
    for (int i = 0; i < 9 && !status; i++)
        status = baseline_add(&baseline, "again", "# nothing\n", 10, reason);
    baseline_close(&baseline);
    return status;
}

static enum status do_finding(const void *of, struct reason *reason)
{
    struct finding_file file;
    enum status status = finding_file_parse("file", of, strlen(of), &file, reason);
    if (status)
        assert_true(!file.trial.ray && !file.trial.scene.vertex && !file.trial.world.instance);
    finding_file_free(&file);
    return status;
}

static void lists_and_findings(void **state)
{
    (void)state;
    static const char *const paths[] = {"fuzz/corpus/rounded-inward.trial",
                                        "fuzz/corpus/inactive-instance.trial"};
    assert_true(each_fails("waivers", do_waivers, NULL, 1) > 1);
    assert_true(each_fails("a baseline", do_baseline, NULL, 1) > 10);
    for (size_t i = 0; i < ARRAY_COUNT(paths); i++) {
        char *text;
        size_t size;
        struct reason reason;
        assert_int_equal(file_read(paths[i], &text, &size, &reason), STATUS_OK);
        assert_true(each_fails(paths[i], do_finding, text, 1) > 2);
        free(text);
    }
}

/* --- trials ----------------------------------------------------------------------------------- */

struct drawn_trial {
    struct gen_options options;
    uint64_t index;
    const struct fuzz_trial *base;
};

static enum status do_gen(const void *of, struct reason *reason)
{
    const struct drawn_trial *drawn = of;
    struct fuzz_trial trial;
    enum status status = gen_trial(3, drawn->index, &drawn->options, &trial, reason);
    if (status)
        assert_true(!trial.ray && !trial.scene.vertex && !trial.world.instance);
    fuzz_trial_free(&trial);
    return status;
}

static enum status do_mutate(const void *of, struct reason *reason)
{
    const struct drawn_trial *drawn = of;
    struct fuzz_trial trial;
    struct rng rng = rng_make(5, drawn->index);
    enum status status = fuzz_trial_copy(drawn->base, &trial, reason);
    if (!status)
        status = gen_mutate(&rng, &trial, reason);
    fuzz_trial_free(&trial);
    return status;
}

static void trials_are_made_or_not(void **state)
{
    (void)state;
    long made = 0, changed = 0;
    for (int worlds = 0; worlds < 2; worlds++) {
        const struct gen_options options = {
            .triangles_least = 4, .triangles_most = 9, .rays = 6, .worlds = worlds};
        struct drawn_trial drawn = {.options = options};
        struct fuzz_trial base;
        struct reason reason;
        assert_int_equal(gen_trial(3, 1, &options, &base, &reason), STATUS_OK);
        drawn.base = &base;
        for (drawn.index = 0; drawn.index < 60; drawn.index++) {
            made += each_fails("a trial", do_gen, &drawn, 1);
            changed += each_fails("an edit", do_mutate, &drawn, 1);
        }
        fuzz_trial_free(&base);
    }
    assert_true(made > 500 && changed > 400);
}

static enum status do_feedback(const void *of, struct reason *reason)
{
    uint64_t coverage[COVERAGE_WORDS] = {0};
    struct feedback *feedback = NULL;
    struct feedback_news news;
    enum status status = feedback_open((size_t)1 << 20, &feedback, reason);
    for (uint32_t i = 0; i < 20 && !status; i++) {
        coverage[0] = (uint64_t)1 << i;
        status = feedback_add(feedback, of, coverage, &news, reason);
    }
    feedback_close(feedback);
    return status;
}

static enum status do_pairs(const void *of, struct reason *reason)
{
    struct pair_coverage *pairs = NULL;
    enum status status = pair_coverage_open(of, &pairs, reason);
    if (status)
        assert_null(pairs);
    pair_coverage_close(pairs);
    return status;
}

static enum status do_covering(const void *of, struct reason *reason)
{
    struct covering covering;
    enum status status = covering_make(of, 4, &covering, reason);
    if (status)
        assert_null(covering.member);
    covering_free(&covering);
    return status;
}

static void add(struct pair_tables *tables, enum pair_factor factor, const void *member)
{
    tables->member[factor][tables->count[factor]++] = member;
}

static void what_trials_have_met(void **state)
{
    (void)state;
    static const uint32_t members[] = {3, 4, 2, 5};
    static struct pair_tables tables;
    const struct gen_options options = {
        .triangles_least = 4, .triangles_most = 9, .rays = 6, .worlds = true};
    struct fuzz_trial trial;
    struct reason reason;
    tables = (struct pair_tables){.count = {[MEET_OPTIMIZE] = 2, [MEET_MOTION] = 2}};
    add(&tables, MEET_ENGINE, engine_find("cpu"));
    add(&tables, MEET_LAYOUT, layout_find("f32"));
    add(&tables, MEET_LAYOUT, layout_find("cwbvh80"));
    add(&tables, MEET_BUILDER, builder_find("median"));
    add(&tables, MEET_STORE, tri_stores[0]);
    add(&tables, MEET_STORE, tri_store_find("compact"));
    add(&tables, MEET_TRI, tri_test_find("mt"));
    add(&tables, MEET_BOX, box_test_find("robust"));
    assert_int_equal(gen_trial(3, 1, &options, &trial, &reason), STATUS_OK);
    assert_true(each_fails("feedback", do_feedback, &trial, 1) > 20);
    assert_true(each_fails("pairs", do_pairs, &tables, 1) > 2);
    assert_true(each_fails("covering", do_covering, members, 1) > 1);
    fuzz_trial_free(&trial);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requests_and_answers),
        cmocka_unit_test(lists_and_findings),
        cmocka_unit_test(trials_are_made_or_not),
        cmocka_unit_test(what_trials_have_met),
    };
    return cmocka_run_group_tests_name("text_memory", tests, NULL, NULL);
}
