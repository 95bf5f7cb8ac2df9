/* What is no shared object is refused at once. */
#define _GNU_SOURCE /* mkdtemp */
#include "ref/outside/plugin_guard.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void must_refuse(const char *path)
{
    const struct layout *layout;
    struct reason reason = {""};
    assert_int_equal(plugin_open(path, &layout, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "is no regular file"));
    assert_null(layout);
}

static void only_regular_files_are_opened(void **state)
{
    (void)state;
    char folder[] = "/tmp/test_plugin_guard_XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    plugin_limits(2000, 0);
    snprintf(path, sizeof path, "%s/fifo.so", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    must_refuse(path);
    unlink(path);
    snprintf(path, sizeof path, "%s/link.so", folder);
    assert_int_equal(symlink("/dev/zero", path), 0);
    must_refuse(path);
    unlink(path);
    must_refuse(folder);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(only_regular_files_are_opened)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
