/* The passes that a level of spirv-opt stands for are the names under its head in what --help says,
 * up to the first line that is none: whatever stands before, between and behind. The spirv-opt is
 * one of the test's own. */
#define _DEFAULT_SOURCE /* setenv, mkdtemp */
#include "gpu/shaders/compiler.h"
#include "gpu/shaders/compiler_tools.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/raydiff-test-passes-XXXXXX", tool[80];

static void help_says(const char *text)
{
    FILE *file = fopen(tool, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n/bin/cat <<'END'\n%s\nEND\n", text);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(tool, 0755), 0);
}

/* NULL: it does not say. */
static void must_be(const char *level, const char *want)
{
    struct compiler compiler;
    struct reason reason = {""};
    char *text = NULL;
    assert_int_equal(compiler_parse(level, &compiler, &reason), STATUS_OK);
    const enum status status = compiler_level_passes(&compiler, &text, &reason);
    assert_int_equal(status, want ? STATUS_OK : STATUS_DEVICE);
    if (want)
        assert_string_equal(text, want);
    else
        assert_non_null(strstr(reason.text, "does not say what -O"));
    free(text);
}

static void passes_are_the_names_under_the_head(void **state)
{
    (void)state;
    static const struct {
        const char *help, *opt, *size;
    } says[] = {
        {"\n  -O\n\t\tx: for speed\n\t\t--a\n\t\t--b=1\n  -Os\n\t\t--c\n  --d\n",
         "x: for speed\n--a\n--b=1\n", "--c\n"},
        {"\n  --z\n\t\t--no\n  -O\n    words of\n    two lines\n\t\t--a\n\n\t\t--no\n  -Os\n  "
         "what\n\t\t--c\n\t\t--e\n"
         "    more\n\t\t--no",
         "--a\n", "--c\n--e\n"},
        {"\n  -Os\n\t\t--c\n    x\n  -O\n\t\t--a\n\t\t--b", "--a\n--b\n", "--c\n"},
        {"\n  -O3\n\t\t--a\n  -Osize\n\t\t--c\n", NULL, NULL},
        {"\n  -O\n\t\t--a\n", "--a\n", NULL},
    };
    for (size_t i = 0; i < sizeof says / sizeof *says; i++) {
        help_says(says[i].help);
        must_be("opt", says[i].opt);
        must_be("size", says[i].size);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(passes_are_the_names_under_the_head)};
    if (!mkdtemp(folder) || setenv("PATH", folder, 1))
        return 4;
    (void)snprintf(tool, sizeof tool, "%s/spirv-opt", folder);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(tool);
    rmdir(folder);
    return failed;
}
