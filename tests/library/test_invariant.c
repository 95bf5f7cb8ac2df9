/* A broken invariant ends a program by SIGABRT, with a line that has file, line and text; one that
 * holds does nothing. In the shared object it is gone past: tests/library/abi.sh. */
#include "ref/base/invariant.h"
#include "ref/library/library.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

/* What a child writes to standard error; returns how it ended. */
static int child_says(int (*play)(void), char *said, size_t room)
{
    int end[2], status = 0;
    assert_int_equal(pipe(end), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        dup2(end[1], STDERR_FILENO);
        close(end[0]);
        _exit(play());
    }
    close(end[1]);
    size_t used = 0;
    for (ssize_t got = 1; got > 0 && used<room - 1; used += got> 0 ? (size_t)got : 0)
        got = read(end[0], said + used, room - 1 - used);
    said[used] = '\0';
    close(end[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static int evaluations;
enum { LINE_OF_BREACH = __LINE__ + 4 };

static int breaks(void)
{
    invariant(++evaluations == 2);
    return 7;
}

static int keeps(void)
{
    invariant(++evaluations == 1);
    return 40 + evaluations; /* looked at once */
}

static int goes_on(void)
{
    library_goes_on("1 == 2", "x.c", 1);
    return 9;
}

static void a_breach_ends_a_program_with_its_place(void **state)
{
    (void)state;
    char said[400], line[400];
    const int status = child_says(breaks, said, sizeof said);
    snprintf(line, sizeof line,
             "raydiff: %s:%d: '++evaluations == 2' does not hold: a bug of raydiff\n", __FILE__,
             LINE_OF_BREACH);
    assert_string_equal(said, line);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

static void what_holds_does_nothing(void **state)
{
    (void)state;
    char said[400];
    const int status = child_says(keeps, said, sizeof said);
    assert_string_equal(said, "");
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 41);
}

static void the_librarys_goes_on(void **state)
{
    (void)state;
    char said[400];
    const int status = child_says(goes_on, said, sizeof said);
    assert_string_equal(said, "");
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_breach_ends_a_program_with_its_place),
        cmocka_unit_test(what_holds_does_nothing),
        cmocka_unit_test(the_librarys_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
