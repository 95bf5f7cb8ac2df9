/* Folders of others (ref/files/folder.h): what is there is read, and nothing else is: each other
 * thing that a name can be is told, and opens no file. */
#define _GNU_SOURCE /* mkdtemp, mkfifo, symlink */
#include "ref/files/folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/root.h"

static struct folder folder;

static const char *path_in(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static void write_file(const char *name, const char *text)
{
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static int make(void **state)
{
    struct reason reason;
    if (make_root(state) || folder_open(root, false, &folder, &reason))
        return 1;
    write_file("file", "abc\n");
    write_file("empty", "");
    if (mkdir(path_in("folder"), 0700) || mkfifo(path_in("pipe"), 0600))
        return 1;
    return symlink("file", path_in("link"));
}

static int drop(void **state)
{
    folder_close(&folder);
    return remove_root(state);
}

/* What a name is, and what is told of it where a file is expected. */
static const struct {
    const char *name, *text, *rule;
} things[] = {
    {"file", "abc\n", NULL},
    {"empty", NULL, "is empty"},
    {"missing", NULL, "No such file or directory"},
    {"folder", NULL, "folder"},
    {"pipe", NULL, "pipe"},
    {"link", NULL, "link"},
};

static void files_alone_are_read(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(things); i++) {
        struct reason reason = {""};
        char *bytes = (char *)root;
        size_t size = 77;
        enum status status = folder_read(&folder, things[i].name, 100, &bytes, &size, &reason);
        if (things[i].text) {
            if (status)
                fail_msg("%s: %s", things[i].name, reason.text);
            assert_int_equal(size, strlen(things[i].text));
            assert_memory_equal(bytes, things[i].text, size);
            free(bytes);
            continue;
        }
        if (status != STATUS_INPUT || !strstr(reason.text, things[i].rule) ||
            !strstr(reason.text, path_in(things[i].name)))
            fail_msg("%s: %s: '%s'", things[i].name, status_text(status), reason.text);
        assert_null(bytes);
        assert_int_equal(size, 0);
    }
}

static void no_more_is_read_than_is_allowed(void **state)
{
    (void)state;
    for (size_t most = 0; most < 8; most++) {
        struct reason reason = {""};
        char *bytes;
        size_t size;
        enum status status = folder_read(&folder, "file", most, &bytes, &size, &reason);
        assert_int_equal(status, most < 4 ? STATUS_INPUT : STATUS_OK);
        assert_int_equal(size, most < 4 ? 0 : 4);
        free(bytes);
    }
}

static void what_is_there_is_told_by_its_kind(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(things); i++) {
        const bool is_file = i < 2, is_missing = i == 2, is_folder = i == 3;
        struct reason reason = {""};
        bool there = true;
        enum status status = folder_has(&folder, things[i].name, &there, &reason);
        assert_int_equal(status, is_file || is_missing ? STATUS_OK : STATUS_INPUT);
        assert_int_equal(status || there, status || is_file);
        there = true;
        status = folder_has_folder(&folder, things[i].name, &there, &reason);
        assert_int_equal(status, is_folder || is_missing ? STATUS_OK : STATUS_INPUT);
        assert_int_equal(status || there, status || is_folder);
    }
}

static void a_file_with_a_second_name_is_not_appended_to(void **state)
{
    (void)state;
    struct reason reason = {""};
    int file = 0;
    assert_int_equal(linkat(folder.file, "file", folder.file, "second", 0), 0);
    assert_int_equal(folder_open_file(&folder, "file", true, &file, &reason), STATUS_INPUT);
    assert_int_equal(file, -1);
    assert_int_equal(folder_remove(&folder, "second", &reason), STATUS_OK);
    assert_int_equal(folder_open_file(&folder, "file", true, &file, &reason), STATUS_OK);
    assert_int_equal(close(file), 0);
    for (size_t i = 3; i < ARRAY_COUNT(things); i++) {
        assert_int_equal(folder_open_file(&folder, things[i].name, true, &file, &reason),
                         STATUS_INPUT);
        assert_int_equal(file, -1);
    }
}

static enum status count_name(void *user, const char *name, struct reason *reason)
{
    size_t *left = user;
    assert_true(strcmp(name, ".") != 0 && strcmp(name, "..") != 0);
    return --*left ? STATUS_OK : (fail)(reason, STATUS_LIMIT, "enough");
}

static void names_are_listed_until_one_is_refused(void **state)
{
    (void)state;
    const size_t all = ARRAY_COUNT(things) - 1; /* one is missing */
    for (size_t stop = 1; stop <= all + 1; stop++) {
        struct reason reason = {""};
        size_t left = stop;
        enum status status = folder_list(&folder, count_name, &left, &reason);
        assert_int_equal(status, stop <= all ? STATUS_LIMIT : STATUS_OK);
        assert_int_equal(left, stop <= all ? 0 : 1);
    }
}

/* Files and empty folders are removed, and what is not there has been, whatever failed before. */
static void what_can_be_removed_is(void **state)
{
    (void)state;
    static const int before[] = {0, ENOENT, EISDIR, EINVAL, EACCES};
    for (size_t i = 0; i < ARRAY_COUNT(before); i++)
        for (int kind = 0; kind < 4; kind++) {
            struct reason reason = {""};
            struct stat info;
            if (kind == 0)
                write_file("gone", "x");
            else if (kind == 1)
                assert_int_equal(mkdir(path_in("gone"), 0700), 0);
            else if (kind == 2)
                assert_int_equal(symlink("file", path_in("gone")), 0);
            errno = before[i];
            assert_int_equal(folder_remove(&folder, "gone", &reason), STATUS_OK);
            assert_true(lstat(path_in("gone"), &info) != 0 && errno == ENOENT);
        }
    struct reason reason = {""};
    assert_int_equal(mkdir(path_in("full"), 0700), 0);
    write_file("full/one", "x");
    assert_true(folder_remove(&folder, "full", &reason) != STATUS_OK);
    assert_int_equal(unlink(path_in("full/one")) | rmdir(path_in("full")), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_alone_are_read),
        cmocka_unit_test(no_more_is_read_than_is_allowed),
        cmocka_unit_test(what_is_there_is_told_by_its_kind),
        cmocka_unit_test(a_file_with_a_second_name_is_not_appended_to),
        cmocka_unit_test(what_can_be_removed_is),
        cmocka_unit_test(names_are_listed_until_one_is_refused),
    };
    return cmocka_run_group_tests_name("folder", tests, make, drop);
}
