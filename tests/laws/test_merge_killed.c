/* What killed merges left is gone after the next one of the same name, and nothing else is: not
 * what a process that lives may still write, nor what is called otherwise, nor files of others. */
#define _GNU_SOURCE /* mkdtemp, asprintf */
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

#define FINDINGS 10

/* A process that has ended, or one that waits until it is killed; it then holds `folder`. */
static pid_t process(bool lives, const char *folder)
{
    int ready[2];
    char byte = 0;
    struct findings *findings;
    fflush(NULL);
    assert_int_equal(pipe(ready), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        close(ready[0]);
        if (folder && findings_open(folder, &findings, &reason))
            _exit(1);
        if (!lives || write(ready[1], "r", 1) != 1)
            _exit(0);
        for (;;)
            pause();
    }
    close(ready[1]);
    if (lives)
        assert_int_equal(read(ready[0], &byte, 1), 1);
    else
        assert_int_equal(waitpid(child, NULL, 0), child);
    close(ready[0]);
    return child;
}

static void end(pid_t child)
{
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
}

static bool is_there(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0;
}

/* A folder as a merge has it when it is killed; true if a merge to `to` takes it away. */
static bool is_removed(const char *name, const char *to)
{
    const char *const plain[] = {in_root("plain")};
    char *left = join_path(root, name);
    assert_campaign(left, 3, 2, FINDINGS);
    assert_merge(plain, 1, to);
    bool removed = !is_there(left);
    if (!removed) { /* then it is whole */
        struct findings *findings = look(left);
        assert_true(findings_count(findings) > 0);
        findings_close(findings);
        assert_int_equal(remove_tree(left), 0);
    }
    assert_same_folders(to, in_root("whole"), compare_folders(in_root("whole"), to));
    assert_int_equal(remove_tree(to), 0);
    free(left);
    return removed;
}

static void what_a_dead_merge_left_is_removed_by_its_name(void **state)
{
    (void)state;
    static const struct {
        const char *before, *behind;
        bool removed;
    } name[] = {{"to.", ".tmp", true},   {"to.", ".tmpx", false}, {"to.", "x.tmp", false},
                {"to.", "", false},      {"to.0", ".tmp", false}, {"to.-", ".tmp", false},
                {"tox.", ".tmp", false}, {"t.", ".tmp", false},   {"to..", ".tmp", false},
                {"to", ".tmp", false},   {".to.", ".tmp", false}};
    const pid_t dead = process(false, NULL), alive = process(true, NULL);
    char text[60], *to = join_path(root, "to");
    for (size_t i = 0; i < ARRAY_COUNT(name); i++)
        for (int lives = 0; lives < 2; lives++) {
            snprintf(text, sizeof text, "%s%ld%s", name[i].before, (long)(lives ? alive : dead),
                     name[i].behind);
            if (is_removed(text, to) != (name[i].removed && !lives))
                fail_msg("%s of a %s process", text, lives ? "living" : "dead");
        }
    assert_int_equal(chdir(root), 0); /* a name without a folder is one of this folder */
    snprintf(text, sizeof text, "to.%ld.tmp", (long)dead);
    assert_true(is_removed(text, "to"));
    snprintf(text, sizeof text, "to.%ld.tmp", (long)alive);
    assert_false(is_removed(text, "to"));
    assert_int_equal(chdir("/"), 0);
    free(to);
    end(alive);
}

/* Another process, of another machine, may have the number of none of this one. */
static void what_is_written_to_stays(void **state)
{
    (void)state;
    char text[60];
    snprintf(text, sizeof text, "to.%ld.tmp", (long)process(false, NULL));
    char *left = join_path(root, text), *to = join_path(root, "to");
    const pid_t writer = process(true, left);
    const char *const plain[] = {in_root("plain")};
    assert_merge(plain, 1, to);
    assert_true(is_there(left));
    assert_int_equal(remove_tree(to), 0);
    end(writer);
    assert_merge(plain, 1, to);
    assert_false(is_there(left));
    assert_int_equal(remove_tree(to), 0);
    free(left);
    free(to);
}

static void files_of_others_stay(void **state)
{
    (void)state;
    char text[60];
    snprintf(text, sizeof text, "to.%ld.tmp", (long)process(false, NULL));
    char *left = join_path(root, text), *to = join_path(root, "to");
    const char *const plain[] = {in_root("plain")};
    assert_campaign(left, 3, 2, FINDINGS);
    char *notes = join_path(left, "notes"), *own = join_path(notes, "text"), *one, command[900];
    assert_int_equal(mkdir(notes, 0777), 0);
    FILE *file = fopen(own, "w");
    assert_non_null(file);
    assert_int_equal(fclose(file), 0);
    assert_merge(plain, 1, to);
    assert_true(is_there(own));
    snprintf(command, sizeof command, "test \"$(ls -A '%s')\" = notes", left);
    assert_int_equal(system(command), 0); /* and nothing else */
    one = join_path(left, "findings.jsonl");
    assert_false(is_there(one));
    assert_int_equal(remove_tree(left), 0);
    free(one);
    free(own);
    free(notes);
    free(left);
    free(to);
}

static int prepare(void **state)
{
    if (make_root(state) || campaign(in_root("plain"), 0, 1, FINDINGS))
        return 1;
    const char *const plain[] = {in_root("plain")};
    return findings_merge(plain, 1, in_root("whole"), &reason) != STATUS_OK;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_dead_merge_left_is_removed_by_its_name),
        cmocka_unit_test(what_is_written_to_stays),
        cmocka_unit_test(files_of_others_stay),
    };
    return cmocka_run_group_tests_name("merge_killed", tests, prepare, remove_root);
}
