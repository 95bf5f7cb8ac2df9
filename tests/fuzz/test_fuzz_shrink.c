/* Laws of fuzz/shrink/shrink.h on questions whose smallest answer is known: what comes out still
 * shows it, is as small as it can be, the same every time, and is not made smaller by doing it
 * again. */
#include "fuzz/gen/gen.h"
#include "fuzz/play/number_set.h"
#include "fuzz/shrink/shrink.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* A question, and what was asked. */
struct shrink_question {
    bool (*holds)(const struct fuzz_trial *trial);
    size_t calls, candidates;
    size_t fails_after;           /* calls; 0: never */
    struct fuzz_trial_size least; /* of all for which it holds */
    bool any;
    struct number_set in_vain; /* hashes, with bit 0 set, of those for which it does not */
};

/* What is asked about is smaller than the best so far by something that people see: its hash does
 * not count. It was not asked about in vain before. Returns the hash. */
static uint64_t is_news(const struct shrink_question *question, const struct fuzz_trial *trial)
{
    struct fuzz_trial_size size = fuzz_trial_size(trial), best = question->least;
    best.hash = size.hash;
    assert_true(!question->any || fuzz_trial_size_compare(&size, &best) < 0);
    assert_false(number_set_has(&question->in_vain, size.hash | 1));
    return size.hash;
}

static enum status answer(void *user, const struct fuzz_trial *candidate, size_t count,
                          size_t *first, struct reason *reason)
{
    struct shrink_question *question = user;
    uint64_t hash[SHRINK_BATCH];
    question->calls++;
    assert_true(count >= 1 && count <= SHRINK_BATCH);
    if (question->calls == question->fails_after)
        return (fail)(reason, STATUS_DEVICE, "as planned");
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(fuzz_trial_check(&candidate[i], reason), STATUS_OK);
        hash[i] = is_news(question, &candidate[i]);
        for (size_t k = 0; k < i; k++)
            assert_true(hash[k] != hash[i]);
    }
    question->candidates += count;
    for (*first = 0; *first < count && !question->holds(&candidate[*first]); ++*first)
        assert_true(number_set_add(&question->in_vain, hash[*first] | 1));
    if (*first < count) {
        struct fuzz_trial_size size = fuzz_trial_size(&candidate[*first]);
        /* Each that is taken is smaller than the one before. */
        assert_true(!question->any || fuzz_trial_size_compare(&size, &question->least) < 0);
        question->least = size;
        question->any = true;
    }
    return STATUS_OK;
}

static struct fuzz_trial generated(uint64_t index, uint32_t least, uint32_t rays)
{
    const struct gen_options options = {
        .triangles_least = least, .triangles_most = least + 20, .rays = rays};
    struct fuzz_trial trial;
    struct reason reason;
    if (gen_trial(8, index, &options, &trial, &reason))
        fail_msg("%s", reason.text);
    return trial;
}

static struct fuzz_trial shrink(const struct fuzz_trial *from,
                                bool (*holds)(const struct fuzz_trial *), uint64_t asks,
                                struct shrink_stats *stats)
{
    struct shrink_question question = {.holds = holds};
    const struct shrink_options options = {.asks = asks};
    struct fuzz_trial out;
    struct reason reason;
    if (fuzz_shrink_trial(from, answer, &question, &options, &out, stats, &reason))
        fail_msg("%s", reason.text);
    free(question.in_vain.slot);
    struct fuzz_trial_size size = fuzz_trial_size(&out);
    assert_int_equal(fuzz_trial_size_compare(&size, &stats->after), 0);
    if (stats->end != SHRINK_NOT_SHOWN) {
        assert_true(holds(&out));
        assert_int_equal(fuzz_trial_size_compare(&size, &question.least), 0);
        assert_true(stats->asks >= stats->tried && stats->tried > stats->accepted);
    }
    return out;
}

/* --- questions --- */

static bool far_right(const struct fuzz_trial *trial)
{
    for (size_t i = 0; i < 3 * (size_t)trial->scene.tri_count; i++)
        if (trial->scene.vertex[3 * (size_t)trial->scene.index[i]] > 0.3f)
            return true;
    return false;
}

static bool two_ways(const struct fuzz_trial *trial)
{
    bool up = false, down = false;
    for (size_t i = 0; i < trial->ray_count; i++) {
        up = up || trial->ray[i].dir[1] > 0;
        down = down || trial->ray[i].dir[1] < 0;
    }
    return up && down;
}

static bool many(const struct fuzz_trial *trial)
{
    return trial->scene.tri_count >= 137 && trial->ray_count >= 3;
}

/* A coordinate that only float16 steps above 1 have: 11 significant bits, the last one set. */
static bool odd_step(const struct fuzz_trial *trial)
{
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++)
        if ((float_bits(trial->scene.vertex[i]) & 0x3FFFu) == 0x2000u)
            return trial->scene.tri_count >= 1;
    return false;
}

/* A small leaf and another builder matter, the rest does not. */
static bool members(const struct fuzz_trial *trial)
{
    return trial->build.leaf <= 2 && trial->builder == builder_find("rtrs");
}

/* One ray is enough once few triangles are left, which are tried after the rays. */
static bool in_turn(const struct fuzz_trial *trial)
{
    return trial->ray_count >= (trial->scene.tri_count > 1 ? 4 : 1);
}

static bool parted(const struct fuzz_trial *trial)
{
    return trial->build.presplit > 0;
}

static bool everything(const struct fuzz_trial *trial)
{
    (void)trial;
    return true;
}

static bool nothing(const struct fuzz_trial *trial)
{
    (void)trial;
    return false;
}

static void finds_the_smallest(void **state)
{
    (void)state;
    static const struct {
        bool (*holds)(const struct fuzz_trial *trial);
        uint32_t triangles, rays, vertices;
        uint64_t bits_most;
    } cases[] = {
        {far_right, 1, 0, 1, 1},       /* 1 0 0 */
        {two_ways, 0, 2, 0, 1 + 2},    /* 0 1 0 and 0 -1 0 */
        {many, 137, 3, 1, 0},          /* 137 times the same triangle */
        {odd_step, 1, 0, 1, 10 + 1},   /* 0x1.004p+0, and an exponent */
        {members, 0, 0, 0, 1 + 1 + 2}, /* rtrs, leaf 1 or 2 */
        {in_turn, 0, 1, 0, 2},         {everything, 0, 0, 0, 0},
        {parted, 0, 0, 0, 1 + 1}, /* 1 part a triangle */
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
        for (uint64_t index = 0; index < 5; index++) {
            struct fuzz_trial trial = generated(index, cases[i].holds == many ? 500 : 30, 60);
            struct shrink_stats stats, again;
            trial.build.leaf = 2;
            const bool parts = cases[i].holds == everything || cases[i].holds == parted;
            trial.builder = builder_find(parts ? "ploc" : "rtrs");
            trial.build.presplit = parts ? 0.3f : 0;
            assert_true(cases[i].holds != odd_step || trial.scene.vertex_count > 0);
            if (cases[i].holds == odd_step)
                trial.scene.vertex[trial.scene.index[4]] = 0x1.aacp+3f;
            assert_true(cases[i].holds(&trial));
            struct fuzz_trial out = shrink(&trial, cases[i].holds, 0, &stats);
            assert_int_equal(stats.end, SHRINK_FIXPOINT);
            if (stats.after.triangles != cases[i].triangles || stats.after.rays != cases[i].rays ||
                stats.after.vertices != cases[i].vertices || stats.after.bits > cases[i].bits_most)
                fail_msg("case %zu: %u triangles, %u rays, %u vertices, %u bits", i,
                         stats.after.triangles, stats.after.rays, stats.after.vertices,
                         (unsigned)stats.after.bits);
            struct fuzz_trial same = shrink(&out, cases[i].holds, 0, &again);
            assert_int_equal(fuzz_trial_hash(&same), fuzz_trial_hash(&out));
            assert_int_equal(again.accepted, 0);
            assert_int_equal(again.end, SHRINK_FIXPOINT);
            assert_string_equal(out.origin.recipe, trial.origin.recipe);
            fuzz_trial_free(&same);
            fuzz_trial_free(&out);
            fuzz_trial_free(&trial);
        }
}

static void the_same_every_time_and_never_more_than_was_allowed(void **state)
{
    (void)state;
    struct fuzz_trial trial = generated(3, 300, 100);
    for (uint64_t asks = 10; asks < 20000; asks *= 3) {
        struct shrink_stats stats[2];
        struct fuzz_trial out[2];
        for (int i = 0; i < 2; i++)
            out[i] = shrink(&trial, many, asks, &stats[i]);
        assert_int_equal(fuzz_trial_hash(&out[0]), fuzz_trial_hash(&out[1]));
        assert_int_equal(stats[0].asks, stats[1].asks);
        assert_true(stats[0].asks <= asks);
        assert_true(stats[0].end == SHRINK_OUT_OF_ASKS || stats[0].end == SHRINK_FIXPOINT);
        assert_true(asks > 300 || stats[0].end == SHRINK_OUT_OF_ASKS);
        assert_true(asks < 1000 || stats[0].accepted > 10);
        fuzz_trial_free(&out[0]);
        fuzz_trial_free(&out[1]);
    }
    fuzz_trial_free(&trial);
}

/* The end "asks" means that there were too few of them for the result itself. What was too dear in
 * an earlier round does not count: where asks are left, the result alone ends in the same way. */
static void its_end_is_that_of_the_result_alone(void **state)
{
    (void)state;
    bool (*const question[])(const struct fuzz_trial *) = {far_right, two_ways, many, in_turn};
    size_t ended[2] = {0}; /* by a fixpoint, by asks */
    for (size_t i = 0; i < ARRAY_COUNT(question); i++)
        for (uint64_t asks = 200; asks < 400000; asks *= 4) {
            struct fuzz_trial trial = generated(3, 500, 100);
            struct shrink_stats stats, again;
            struct fuzz_trial out = shrink(&trial, question[i], asks, &stats);
            const uint64_t dearest = 1 + out.scene.tri_count / 64 + out.ray_count / 64;
            if (stats.asks + dearest <= asks) {
                struct fuzz_trial same = shrink(&out, question[i], asks, &again);
                assert_int_equal(again.accepted, 0);
                if (again.end != stats.end)
                    fail_msg("question %zu, %u asks: %s, of the result alone %s", i, (unsigned)asks,
                             shrink_end_name(stats.end), shrink_end_name(again.end));
                ended[stats.end == SHRINK_OUT_OF_ASKS]++;
                fuzz_trial_free(&same);
            }
            fuzz_trial_free(&out);
            fuzz_trial_free(&trial);
        }
    assert_true(ended[0] > 2 && ended[1] > 0);
}

static uint64_t only; /* the hash of a trial */

static bool itself(const struct fuzz_trial *trial)
{
    return fuzz_trial_hash(trial) == only;
}

/* Where each candidate costs one ask and all are in vain, every budget is spent to the last, unless
 * what is dearer than a share of it is left out. */
static void a_budget_may_be_spent_to_the_last(void **state)
{
    (void)state;
    struct fuzz_trial trial = generated(3, 30, 20);
    size_t spent = 0;
    assert_true(trial.scene.tri_count < 64 && trial.world.instance_count < 64);
    only = fuzz_trial_hash(&trial);
    for (uint64_t asks = 500; asks < 1500; asks += 37) {
        struct shrink_stats stats;
        struct fuzz_trial out = shrink(&trial, itself, asks, &stats);
        assert_int_equal(stats.asks, stats.tried);
        spent += stats.asks == asks;
        fuzz_trial_free(&out);
    }
    assert_true(spent > 5);
    fuzz_trial_free(&trial);
}

static void time_ends_it_and_is_said(void **state)
{
    (void)state;
    struct fuzz_trial trial = generated(3, 30, 50), out;
    struct shrink_question question = {.holds = far_right};
    const struct shrink_options options = {.ns = 1};
    struct shrink_stats stats;
    struct reason reason;
    if (fuzz_shrink_trial(&trial, answer, &question, &options, &out, &stats, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(stats.end, SHRINK_OUT_OF_TIME);
    assert_string_equal(shrink_end_name(stats.end), "time");
    free(question.in_vain.slot);
    assert_int_equal(fuzz_trial_hash(&out), fuzz_trial_hash(&trial));
    fuzz_trial_free(&out);
    fuzz_trial_free(&trial);
}

static void what_is_not_shown_is_left_alone(void **state)
{
    (void)state;
    struct fuzz_trial trial = generated(3, 30, 50);
    struct shrink_stats stats;
    struct fuzz_trial out = shrink(&trial, nothing, 0, &stats);
    assert_int_equal(stats.end, SHRINK_NOT_SHOWN);
    assert_int_equal(stats.tried, 1);
    assert_int_equal(fuzz_trial_hash(&out), fuzz_trial_hash(&trial));
    fuzz_trial_free(&out);
    fuzz_trial_free(&trial);
}

static void an_error_ends_it(void **state)
{
    (void)state;
    struct fuzz_trial trial = generated(3, 300, 50);
    const struct shrink_options options = {0};
    for (size_t call = 1; call < 40; call += 7) {
        struct shrink_question question = {.holds = many, .fails_after = call};
        struct fuzz_trial out;
        struct shrink_stats stats;
        struct reason reason;
        assert_int_equal(
            fuzz_shrink_trial(&trial, answer, &question, &options, &out, &stats, &reason),
            STATUS_DEVICE);
        assert_string_equal(reason.text, "as planned");
        assert_null(out.ray);
        assert_int_equal(out.scene.tri_count, 0);
        assert_int_equal(question.calls, call);
        free(question.in_vain.slot);
    }
    fuzz_trial_free(&trial);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_smallest),
        cmocka_unit_test(the_same_every_time_and_never_more_than_was_allowed),
        cmocka_unit_test(its_end_is_that_of_the_result_alone),
        cmocka_unit_test(a_budget_may_be_spent_to_the_last),
        cmocka_unit_test(time_ends_it_and_is_said),
        cmocka_unit_test(what_is_not_shown_is_left_alone),
        cmocka_unit_test(an_error_ends_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
