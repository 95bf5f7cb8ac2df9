/* Coverage feedback: what is kept, counted, chosen, saved and loaded. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/feedback/feedback_inner.h"
#include "fuzz/findings/finding_file.h"
#include "ref/files/file.h"

#include "tests/support/fuzz_trials.h" /* includes cmocka.h */
#include "tests/support/root.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static struct reason reason;

/* A trial that is told apart by its first vertex. */
static struct fuzz_trial numbered(uint32_t number, uint32_t triangles)
{
    struct fuzz_trial trial;
    if (fuzz_trial_make(3, triangles, 1, &trial, &reason))
        fail_msg("%s", reason.text);
    trial.scene.vertex[0] = (float)number;
    trial.ray[0].dir[2] = 1;
    return trial;
}

static struct feedback *opened(size_t bytes)
{
    struct feedback *feedback;
    if (feedback_open(bytes, &feedback, &reason))
        fail_msg("%s", reason.text);
    return feedback;
}

static struct feedback_news add(struct feedback *feedback, uint32_t number, uint32_t triangles,
                                const uint64_t coverage[COVERAGE_WORDS])
{
    struct fuzz_trial trial = numbered(number, triangles);
    struct feedback_news news;
    assert_int_equal(feedback_add(feedback, &trial, coverage, &news, &reason), STATUS_OK);
    fuzz_trial_free(&trial); /* a copy is kept */
    return news;
}

static void what_is_new_is_kept(void **state)
{
    (void)state;
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    struct rng rng = rng_make(1, 1);
    struct feedback_news news;
    const uint64_t first[COVERAGE_WORDS] = {5, 0, 0, 1}, part[COVERAGE_WORDS] = {4, 0, 0, 0},
                   more[COVERAGE_WORDS] = {4, 8, 0, 0}, none[COVERAGE_WORDS] = {0};
    assert_null(feedback_choose(feedback, &rng));
    news = add(feedback, 1, 1, none);
    assert_true(news.bits == 0 && !news.kept);
    news = add(feedback, 2, 1, first);
    assert_true(news.bits == 3 && news.kept);
    assert_false(feedback_wants(feedback, part));
    news = add(feedback, 3, 1, part);
    assert_true(news.bits == 0 && !news.kept);
    assert_true(feedback_wants(feedback, more));
    /* Only counted: the state is known, but no trial that reaches it is. */
    assert_int_equal(feedback_add(feedback, NULL, more, &news, &reason), STATUS_OK);
    assert_true(news.bits == 1 && !news.kept);
    assert_true(feedback_wants(feedback, more));
    news = add(feedback, 4, 1, more);
    assert_true(news.bits == 0 && news.kept);
    assert_int_equal(feedback_count(feedback), 2);
    assert_true(feedback->entry[0].trial.scene.vertex[0] == 2);
    assert_true(feedback->entry[1].trial.scene.vertex[0] == 4);
    assert_int_equal(coverage_count(feedback->map), 4);
    const uint64_t reached[] = {1, 0, 4};
    for (uint32_t bit = 0; bit < 3; bit++)
        assert_int_equal(feedback->reached[bit], reached[bit]);
    assert_int_equal(feedback->reached[67], 2);
    assert_int_equal(feedback->reached[192], 1);
    feedback_close(feedback);
    feedback_close(NULL);
}

/* However many trials come: no more than there are bits, no more than the bytes, none that is far
 * too large; what was left out for that is still wanted. */
static void it_is_bounded(void **state)
{
    (void)state;
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    uint64_t all[COVERAGE_WORDS];
    memset(all, 0xFF, sizeof all);
    for (uint32_t i = 0; i < 3 * COVERAGE_BITS; i++) {
        uint64_t one[COVERAGE_WORDS] = {0};
        one[i % COVERAGE_BITS / 64] = (uint64_t)1 << i % 64;
        struct feedback_news news = add(feedback, i, 1, one);
        assert_int_equal(news.kept, i < COVERAGE_BITS);
        assert_int_equal(news.bits, i < COVERAGE_BITS);
    }
    assert_false(feedback_wants(feedback, all));
    assert_int_equal(feedback_count(feedback), COVERAGE_BITS);
    feedback_close(feedback);

    feedback = opened(64 << 10);
    const uint64_t bit[COVERAGE_WORDS] = {1};
    assert_false(add(feedback, 1, 1000, bit).kept); /* 12,000 bytes: more than an eighth */
    assert_true(feedback_wants(feedback, bit));
    assert_true(add(feedback, 1, 1, bit).kept);
    size_t bytes = 0;
    for (uint32_t i = 0; i < COVERAGE_BITS; i++) {
        uint64_t one[COVERAGE_WORDS] = {0};
        one[i / 64] = (uint64_t)1 << i % 64;
        add(feedback, i, 100, one);
    }
    for (size_t i = 0; i < feedback_count(feedback); i++)
        bytes += 12 * (size_t)feedback->entry[i].trial.scene.tri_count;
    assert_in_range(bytes, (64 << 10) / 2, 64 << 10);
    assert_true(feedback_wants(feedback, all));
    feedback_close(feedback);
}

/* A made-up campaign: state k is reached by one trial in 2^k. */
static void fill(struct feedback *feedback, uint32_t trials)
{
    struct rng rng = rng_make(9, 9);
    for (uint32_t i = 0; i < trials; i++) {
        uint64_t coverage[COVERAGE_WORDS] = {1, 0, 0, 0};
        while (rng_below(&rng, 2) && coverage[0] < (uint64_t)1 << 32)
            coverage[0] <<= 1;
        add(feedback, i, 1, coverage);
    }
}

static void choices_are_repeatable(void **state)
{
    (void)state;
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    struct rng rng = rng_make(3, 4);
    uint64_t hash = 0xCBF29CE484222325u;
    fill(feedback, 500);
    for (uint32_t i = 0; i < 1000; i++)
        hash = (hash ^ fuzz_trial_hash(feedback_choose(feedback, &rng))) * 0x100000001B3u;
    feedback_close(feedback);
    /* The same on any machine: what this printed when it was written. */
    assert_int_equal(hash, 0x84C1B0F92FAB4A32u);
}

/* A trial's share is as its rarest state is rare; and none is left alone for ever. */
static void the_rare_are_chosen(void **state)
{
    (void)state;
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    struct rng rng = rng_make(5, 6);
    const uint32_t times[] = {1000, 100, 1};
    size_t early[3] = {0}, all[3] = {0};
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t i = 0; i < times[k]; i++) {
            const uint64_t coverage[COVERAGE_WORDS] = {8 | (uint64_t)1 << k}; /* all share one */
            add(feedback, k, 1, coverage);
        }
    for (uint32_t i = 0; i < 100000; i++) {
        size_t which = (size_t)feedback_choose(feedback, &rng)->scene.vertex[0];
        early[which] += i < 50;
        all[which]++;
    }
    assert_in_range(early[2], 40, 50);
    assert_in_range(all[2], 80000, 95000);
    assert_in_range(all[1], 5000, 15000);
    assert_in_range(all[0], 1000, 5000);
    feedback_close(feedback);
}

/* --- files ------------------------------------------------------------------------------------ */

static void write_text(const char *path, const char *text)
{
    FILE *to = fopen(path, "w");
    assert_non_null(to);
    fputs(text, to);
    assert_int_equal(fclose(to), 0);
}

static enum status load(const char *path, size_t most, struct feedback_list *list)
{
    struct folder folder;
    enum status status = folder_open(path, false, &folder, &reason);
    if (!status)
        status = feedback_load(&folder, most, list, &reason);
    folder_close(&folder);
    return status;
}

static enum status save(struct feedback *feedback, const char *path)
{
    struct folder folder;
    enum status status = folder_open(path, true, &folder, &reason);
    if (!status)
        status = feedback_save(feedback, &folder, &reason);
    folder_close(&folder);
    return status;
}

static size_t find_trial(const struct feedback_list *list, uint64_t hash)
{
    size_t found = 0;
    for (size_t i = 0; i < list->count; i++)
        found += fuzz_trial_hash(&list->trial[i]) == hash;
    return found;
}

static void a_corpus_is_saved_and_loaded(void **state)
{
    (void)state;
    char folder[200], path[300];
    snprintf(folder, sizeof folder, "%s/corpus", root);
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    struct feedback_list list;
    fill(feedback, 200);
    size_t count = feedback_count(feedback);
    assert_true(count > 4);
    assert_int_equal(save(feedback, folder), STATUS_OK);
    assert_int_equal(load(folder, FEEDBACK_BYTES, &list), STATUS_OK);
    assert_int_equal(list.count, count);
    assert_int_equal(list.left_out, 0);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(find_trial(&list, fuzz_trial_hash(&feedback->entry[i].trial)), 1);
    for (size_t i = 1; i < count; i++) /* in the order of their names, which are their hashes */
        assert_true(fuzz_trial_hash(&list.trial[i - 1]) < fuzz_trial_hash(&list.trial[i]));
    feedback_list_free(&list);

    /* What was written once is not written again, and what is added later is. */
    snprintf(path, sizeof path, "%s/%016llx.trial", folder,
             (unsigned long long)fuzz_trial_hash(&feedback->entry[0].trial));
    assert_int_equal(unlink(path), 0);
    const uint64_t fresh[COVERAGE_WORDS] = {0, 0, 1};
    assert_true(add(feedback, 7777, 1, fresh).kept);
    assert_int_equal(save(feedback, folder), STATUS_OK);
    assert_int_equal(load(folder, FEEDBACK_BYTES, &list), STATUS_OK);
    assert_int_equal(list.count, count);
    feedback_list_free(&list);
    feedback_close(feedback);

    /* A corpus that is too large is read as far as it may be, and that is said. */
    assert_int_equal(load(folder, 2000, &list), STATUS_OK);
    assert_in_range(list.count, 1, count - 1);
    assert_int_equal(list.count + list.left_out, count);
    assert_non_null(strstr(list.said.text, "larger than 2000 bytes"));
    feedback_list_free(&list);
}

static void torn_and_foreign_files_are_said(void **state)
{
    (void)state;
    char folder[200], path[300], *bytes;
    size_t size;
    snprintf(folder, sizeof folder, "%s/torn", root);
    struct feedback *feedback = opened(FEEDBACK_BYTES);
    struct feedback_list list;
    fill(feedback, 50);
    assert_int_equal(save(feedback, folder), STATUS_OK);
    snprintf(path, sizeof path, "%s/%016llx.trial", folder,
             (unsigned long long)fuzz_trial_hash(&feedback->entry[0].trial));
    assert_int_equal(file_read(path, &bytes, &size, &reason), STATUS_OK);
    bytes[size / 2] = '\0';
    write_text(path, bytes);
    free(bytes);
    snprintf(path, sizeof path, "%s/notes.txt", folder);
    write_text(path, "no coverage\n");
    snprintf(path, sizeof path, "%s/.hidden.trial", folder);
    write_text(path, "nor this\n");
    snprintf(path, sizeof path, "%s/zzz.trial", folder); /* the last */
    write_text(path, "what is this?\n");
    assert_int_equal(load(folder, FEEDBACK_BYTES, &list), STATUS_OK);
    assert_int_equal(list.count, feedback_count(feedback) - 1);
    assert_int_equal(list.left_out, 2);
    assert_non_null(strstr(list.said.text, ".trial:"));
    assert_null(strchr(list.said.text, '\n'));
    feedback_list_free(&list);

    /* What a killed writer left is removed, and nothing else. */
    snprintf(path, sizeof path, "%s/0123.trial.99.0.tmp", folder);
    write_text(path, "raydiff tri");
    struct folder open;
    assert_int_equal(folder_open(folder, false, &open, &reason), STATUS_OK);
    assert_int_equal(folder_clean(&open, &reason), STATUS_OK);
    folder_close(&open);
    assert_int_not_equal(access(path, F_OK), 0);
    snprintf(path, sizeof path, "%s/notes.txt", folder);
    assert_int_equal(access(path, F_OK), 0);

    /* A folder that is none. */
    assert_int_equal(load(path, FEEDBACK_BYTES, &list), STATUS_INPUT);
    struct feedback *other = opened(FEEDBACK_BYTES);
    fill(other, 5);
    assert_int_equal(save(other, path), STATUS_INPUT);
    feedback_close(other);
    feedback_close(feedback);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_new_is_kept),
        cmocka_unit_test(it_is_bounded),
        cmocka_unit_test(choices_are_repeatable),
        cmocka_unit_test(the_rare_are_chosen),
        cmocka_unit_test(a_corpus_is_saved_and_loaded),
        cmocka_unit_test(torn_and_foreign_files_are_said),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
