/* Folders of findings that were killed, and their merge: nothing lost, nothing twice. */
#define _GNU_SOURCE /* mkdtemp, usleep */
#include "fuzz/findings/findings.h"
#include "ref/base/rng.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <signal.h>
#include <sys/wait.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/campaigns.h"

/* Killed at random moments and resumed, a campaign leaves what an undisturbed one leaves. */
static void a_killed_campaign_loses_and_repeats_nothing(void **state)
{
    (void)state;
    const char *killed = in_root("killed"), *whole = in_root("whole");
    struct rng rng = rng_make(11, 0);
    int kills = 0, status = 1;
    for (int turn = 0; turn < 400; turn++) {
        fflush(NULL);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0)
            _exit(campaign(killed, 1, 1, 2200));
        /* ever longer, or a slow machine never ends it */
        usleep(1000 + rng_below(&rng, kills < 60 ? 12000 : 200000u << turn / 80));
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, &status, 0), child);
        if (WIFEXITED(status))
            break;
        kills++;
    }
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_true(kills >= 20);
    assert_campaign(whole, 1, 1, 2200);
    const char *const a[] = {killed}, *const b[] = {whole};
    assert_merge(a, 1, in_root("killed-merged"));
    assert_merge(b, 1, in_root("whole-merged"));
    assert_same_folders(in_root("killed-merged"), in_root("whole-merged"), 16);
    for (size_t k = 0; k < 5; k++) { /* nothing half-done lies around */
        char path[600];
        struct fuzz_signature signature;
        char folder[FUZZ_SIGNATURE_MOST];
        assert_int_equal(fuzz_signature_parse(names[k], &signature, &reason), STATUS_OK);
        fuzz_signature_folder(&signature, folder);
        snprintf(path, sizeof path, "%s/%s", killed, folder);
        DIR *listing = opendir(path);
        assert_non_null(listing);
        struct dirent *one;
        while ((one = readdir(listing)) != NULL)
            assert_null(strstr(one->d_name, ".tmp"));
        closedir(listing);
    }
    print_message("%d kills\n", kills);
}

static void merged_shards_are_one_run(void **state)
{
    (void)state;
    static const char *const order[][8] = {{"s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7"},
                                           {"s5", "s2", "s7", "s0", "s1", "s6", "s3", "s4"}};
    char name[20];
    const char *folder[8];
    assert_campaign(in_root("run"), 8, 1, 2400);
    for (uint64_t i = 0; i < 8; i++) {
        snprintf(name, sizeof name, "s%llu", (unsigned long long)i);
        assert_campaign(in_root(name), 8 + i, 8, 2400);
    }
    const char *const run[] = {in_root("run")};
    assert_merge(run, 1, in_root("run-merged"));
    for (size_t turn = 0; turn < 2; turn++) {
        char paths[8][400];
        for (size_t i = 0; i < 8; i++) {
            snprintf(paths[i], sizeof paths[i], "%s", in_root(order[turn][i]));
            folder[i] = paths[i];
        }
        snprintf(name, sizeof name, "merged%zu/", turn);
        assert_merge(folder, 8, in_root(name));
        assert_same_folders(in_root(turn ? "merged1" : "merged0"), in_root("run-merged"), 16);
    }
    /* A shard more is seen. */
    const char *const seven[] = {in_root("s1"), in_root("s2"), in_root("s3"), in_root("s4")};
    assert_merge(seven, 4, in_root("four-merged"));
    struct findings *four = look(in_root("four-merged")), *all = look(in_root("run-merged"));
    struct fuzz_signature signature;
    assert_int_equal(fuzz_signature_parse(names[0], &signature, &reason), STATUS_OK);
    assert_true(findings_find(four, &signature)->count < findings_find(all, &signature)->count);
    findings_close(four);
    findings_close(all);
}

static void merge_refuses_and_leaves_nothing(void **state)
{
    (void)state;
    struct stat about;
    assert_campaign(in_root("plain"), 0, 1, 50);
    const char *const twice[] = {in_root("plain"), in_root("./plain")};
    assert_int_equal(findings_merge(twice, 2, in_root("m1"), &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "named twice"));
    assert_int_not_equal(stat(in_root("m1"), &about), 0);
    const char *const plain[] = {in_root("plain")};
    assert_int_equal(findings_merge(plain, 1, in_root("plain"), &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "it exists and is not empty"));
    const char *const none[] = {in_root("plain"), in_root("nothing")};
    assert_int_equal(findings_merge(none, 2, in_root("m2"), &reason), STATUS_INPUT);
    assert_int_equal(mkdir(in_root("m3"), 0777), 0);
    assert_merge(plain, 1, in_root("m3"));
    DIR *listing = opendir(root);
    struct dirent *one;
    while ((one = readdir(listing)) != NULL)
        assert_null(strstr(one->d_name, ".tmp"));
    closedir(listing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_killed_campaign_loses_and_repeats_nothing),
        cmocka_unit_test(merged_shards_are_one_run),
        cmocka_unit_test(merge_refuses_and_leaves_nothing),
    };
    return cmocka_run_group_tests_name("fuzz_merge", tests, make_root, remove_root);
}
