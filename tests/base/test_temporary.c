/* What killed writers leave is removed by the next writer of the same goal, and nothing else is. */
#define _GNU_SOURCE /* mkdtemp, O_TMPFILE */
#include "ref/files/file.h"
#include "ref/files/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/root.h"

static struct reason reason;
static char path[128];

/* A folder for each test. */
static int new_root(void **state)
{
    strcpy(root, "/tmp/raydiff-test-XXXXXX");
    return make_root(state);
}

static const char *in_root(const char *name)
{
    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static bool is_there(const char *name)
{
    struct stat about;
    return lstat(in_root(name), &about) == 0;
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(in_root(name), "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static unsigned entries(void)
{
    DIR *listing = opendir(root);
    unsigned count = 0;
    assert_non_null(listing);
    while (readdir(listing))
        count++;
    closedir(listing);
    return count - 2;
}

static bool has_nameless(void)
{
    int file = open(root, O_TMPFILE | O_WRONLY, 0600);
    if (file >= 0)
        close(file);
    return file >= 0;
}

/* Runs it in a process that is then killed. */
static void killed(void (*run)(void))
{
    int status;
    pid_t pid = fork();
    if (pid == 0) {
        run();
        kill(getpid(), SIGKILL);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

static void begin_file(void)
{
    static struct file_out out;
    if (file_out_open(in_root("goal"), &out, &reason))
        _exit(1);
    fputs("half", out.stream);
    fflush(out.stream);
}

static void who_is_killed_leaves_no_file(void **state)
{
    (void)state;
    if (!has_nameless()) {
        print_message("SKIP the file system has no files without a name\n");
        skip();
    }
    put("goal", "old");
    killed(begin_file);
    assert_int_equal(entries(), 1);
}

static void begin_two_with_names(void)
{
    char *first, *second;
    if (temporary_named(AT_FDCWD, in_root("goal"), &first) < 0 ||
        temporary_named(AT_FDCWD, in_root("goal"), &second) < 0)
        _exit(1);
}

static void write_goal(void)
{
    struct file_out out;
    assert_int_equal(file_out_open(in_root("goal"), &out, &reason), STATUS_OK);
    fputs("new", out.stream);
    assert_int_equal(file_out_commit(&out, &reason), STATUS_OK);
}

static void the_next_writer_removes_what_is_left(void **state)
{
    (void)state;
    killed(begin_two_with_names);
    assert_int_equal(entries(), 2);
    write_goal();
    assert_true(is_there("goal"));
    assert_int_equal(entries(), 1);
    /* The second of two, where the first went well. */
    killed(begin_two_with_names);
    assert_int_equal(unlink(in_root("goal.raydiff.0.tmp")), 0);
    write_goal();
    assert_int_equal(entries(), 1);
}

static void another_writers_file_stays(void **state)
{
    char *name, *other;
    (void)state;
    int file = temporary_named(AT_FDCWD, in_root("goal"), &name);
    assert_true(file >= 0);
    assert_non_null(strstr(name, "goal.raydiff.0.tmp"));
    write_goal();
    assert_true(is_there("goal.raydiff.0.tmp"));
    int second = temporary_named(AT_FDCWD, in_root("goal"), &other);
    assert_true(second >= 0);
    assert_non_null(strstr(other, "goal.raydiff.1.tmp"));
    close(second);
    write_goal();
    assert_false(is_there("goal.raydiff.1.tmp"));
    assert_true(is_there("goal.raydiff.0.tmp"));
    close(file);
    free(name);
    free(other);
}

static void what_is_not_ours_stays(void **state)
{
    (void)state;
    put("victim", "theirs");
    assert_int_equal(symlink("victim", in_root("goal.raydiff.0.tmp")), 0);
    assert_int_equal(mkdir(in_root("goal.raydiff.1.tmp"), 0700), 0);
    assert_int_equal(mkfifo(in_root("goal.raydiff.2.tmp"), 0600), 0);
    put("goal.raydiff.3.tmp", "theirs");
    const bool other = chown(in_root("goal.raydiff.3.tmp"), 1, 1) == 0;
    put("goal.0.tmp", "no name of ours");
    put("goals.raydiff.0.tmp", "another goal's");
    put("goal", "old"); /* so that a temporary name is needed, too */
    write_goal();
    assert_int_equal(entries(), 7 + (other ? 1 : 0));
    assert_true(is_there("goal.raydiff.0.tmp") && is_there("victim"));
}

static void a_goal_that_is_there_is_replaced(void **state)
{
    char *temporary;
    (void)state;
    if (!has_nameless()) {
        print_message("SKIP the file system has no files without a name\n");
        skip();
    }
    put("goal", "old");
    int file = temporary_nameless(AT_FDCWD, in_root("goal"));
    assert_true(file >= 0);
    assert_true(temporary_link(file, AT_FDCWD, in_root("goal"), &temporary));
    assert_non_null(temporary);
    assert_non_null(strstr(temporary, "goal.raydiff.0.tmp"));
    write_goal(); /* meanwhile another */
    assert_true(is_there("goal.raydiff.0.tmp"));
    assert_int_equal(rename(temporary, in_root("goal")), 0);
    assert_int_equal(entries(), 1);
    free(temporary);
    close(file);
    file = temporary_nameless(AT_FDCWD, in_root("free"));
    assert_true(temporary_link(file, AT_FDCWD, in_root("free"), &temporary));
    assert_null(temporary);
    assert_true(is_there("free"));
    close(file);
    assert_int_equal(temporary_nameless(AT_FDCWD, in_root("no/such/folder")), -1);
}

static void names_are_known(void **state)
{
    (void)state;
    static const char *const yes[] = {"stats.json.raydiff.0.tmp", "a.raydiff.17.tmp", "a.12.0.tmp"};
    static const char *const no[] = {"",
                                     ".tmp",
                                     "a.tmp",
                                     "a.0.tmp",
                                     "a.x.0.tmp",
                                     ".0.0.tmp",
                                     ".raydiff.0.tmp",
                                     "a.raydiff.0.tmpx",
                                     "araydiff.0.tmp",
                                     "a.raydiff..tmp",
                                     "a.raydiff.0"};
    for (size_t i = 0; i < ARRAY_COUNT(yes); i++)
        assert_true(temporary_is_name(yes[i]));
    for (size_t i = 0; i < ARRAY_COUNT(no); i++)
        if (temporary_is_name(no[i]))
            fail_msg("%s", no[i]);
}

static void begin_folder(void)
{
    char *folder, file[256];
    if (temporary_folder(root, "work", &folder) < 0)
        _exit(1);
    snprintf(file, sizeof file, "%s/out", folder);
    FILE *out = fopen(file, "w");
    fputs("half", out);
    fclose(out);
}

static void folders_of_the_killed_are_removed(void **state)
{
    char *folder, *second;
    (void)state;
    killed(begin_folder);
    killed(begin_folder);
    assert_int_equal(mkdir(in_root("work.short"), 0700), 0);
    assert_int_equal(mkdir(in_root("other.abcdef"), 0700), 0);
    assert_int_equal(symlink("other.abcdef", in_root("work.abcdef")), 0);
    put("work.ghijkl", "a file");
    int file = temporary_folder(root, "work", &folder);
    assert_true(file >= 0);
    assert_int_equal(entries(), 5);
    int other = temporary_folder(root, "work", &second); /* the first is in use */
    assert_true(other >= 0);
    assert_int_equal(entries(), 6);
    close(file);
    close(other);
    assert_true(temporary_folder_remove(second));
    assert_true(temporary_folder_remove(folder));
    assert_int_equal(entries(), 4);
    free(folder);
    free(second);
    assert_int_equal(temporary_folder(in_root("no"), "work", &folder), -1);
    assert_int_equal(errno, ENOENT);
    assert_null(folder);
}

int main(void)
{
#define IN_ROOT(test) cmocka_unit_test_setup_teardown(test, new_root, remove_root)
    const struct CMUnitTest tests[] = {
        IN_ROOT(who_is_killed_leaves_no_file),      IN_ROOT(the_next_writer_removes_what_is_left),
        IN_ROOT(another_writers_file_stays),        IN_ROOT(what_is_not_ours_stays),
        IN_ROOT(a_goal_that_is_there_is_replaced),  cmocka_unit_test(names_are_known),
        IN_ROOT(folders_of_the_killed_are_removed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
