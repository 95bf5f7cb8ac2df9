/* A guardian ends a command with all that it started, however those were started and whatever ends
 * us. */
#define _GNU_SOURCE
#include "ref/outside/child.h"
#include "ref/outside/guardian.h"

#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define KINDS    5
#define LIMIT_MS 20000

/* The fork that fails, by number from the next one on, in this process or one that it has made;
 * 0: none does. */
static int fork_that_fails;

pid_t fork(void)
{
    if (fork_that_fails && --fork_that_fails == 0) {
        errno = EAGAIN;
        return -1;
    }
    return _Fork();
}

/* In shared memory: who was started. */
struct family {
    _Atomic pid_t member[KINDS];
    _Atomic int count;
};

static void live(struct family *family)
{
    signal(SIGTERM, SIG_IGN);
    alarm(60); /* whatever becomes of the test */
    family->member[family->count++] = getpid();
    for (;;)
        pause();
}

/* As exec would. */
static void close_files(void)
{
    for (int file = 3; file < 1024; file++)
        close(file);
}

/* A child; one left by its parent; one in a session of its own; that left by its parent, too. */
static void start_family(const void *user)
{
    struct family *family = (struct family *)(uintptr_t)user;
    close_files();
    for (int kind = 0; kind < KINDS - 1; kind++) {
        if (fork() != 0)
            continue;
        if (kind & 2)
            setsid();
        if (kind & 1 && fork() != 0)
            _exit(0);
        live(family);
    }
    live(family);
}

static void wait_for(struct family *family)
{
    const uint64_t start = time_ns();
    while (family->count < KINDS && (time_ns() - start) / 1000000u < LIMIT_MS)
        poll(NULL, 0, 1);
    assert_int_equal(family->count, KINDS);
}

static void must_be_gone(const struct family *family)
{
    const uint64_t start = time_ns();
    for (int i = 0; i < KINDS; i++)
        while (kill(family->member[i], 0) == 0) {
            if ((time_ns() - start) / 1000000u > LIMIT_MS)
                fail_msg("process %ld, number %d, is still there", (long)family->member[i], i);
            poll(NULL, 0, 1);
        }
}

static void all_end_when_it_is_stopped(void **state)
{
    struct family *family = *state;
    struct guardian guardian;
    struct reason reason = {""};
    assert_int_equal(guardian_start(start_family, family, &guardian, &reason), STATUS_OK);
    wait_for(family);
    guardian_stop(&guardian);
    must_be_gone(family);
    assert_int_equal(guardian.pid, 0);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
    guardian_stop(&guardian);
}

static void end_at_once(const void *user)
{
    (void)user;
    _exit(0);
}

/* Neither the guardian nor the command can be made: both are told with the system's word, and
 * nothing is left; there is no third process. */
static void what_cannot_be_started_is_told(void **state)
{
    (void)state;
    for (int at = 1; at <= 3; at++) {
        struct guardian guardian = {.pid = 7, .line = 7};
        struct reason reason = {""};
        fork_that_fails = at;
        const enum status status = guardian_start(end_at_once, NULL, &guardian, &reason);
        fork_that_fails = 0;
        assert_int_equal(status, at < 3 ? STATUS_DEVICE : STATUS_OK);
        assert_string_equal(reason.text,
                            at < 3 ? "no process: Resource temporarily unavailable" : "");
        if (at < 3)
            assert_int_equal(guardian.pid, 0);
        guardian_stop(&guardian);
        assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
        assert_int_equal(errno, ECHILD);
    }
}

static void hold(struct child *parent, void *user)
{
    struct guardian first, second;
    (void)parent;
    /* Of two the one that is made later must not hold the line of the other. */
    if (guardian_start(start_family, user, &first, NULL) ||
        guardian_start(start_family, (struct family *)user + 1, &second, NULL))
        _exit(1);
    for (;;)
        pause();
}

static void all_end_when_we_are_killed(void **state)
{
    struct family *family = *state;
    struct child child;
    struct child_fate fate;
    struct reason reason = {""};
    assert_int_equal(child_start(hold, family, &child, &reason), STATUS_OK);
    wait_for(&family[0]);
    wait_for(&family[1]);
    child_end(&child, 0, &fate);
    assert_int_equal(fate.signal, SIGKILL);
    must_be_gone(&family[0]);
    must_be_gone(&family[1]);
}

static void leave_a_child(const void *user)
{
    struct family *family = (struct family *)(uintptr_t)user;
    close_files();
    if (fork() == 0)
        live(family);
    while (family->count == 0)
        poll(NULL, 0, 1);
    _exit(7);
}

static void the_commands_own_end_is_told(void **state)
{
    struct family *family = *state;
    struct guardian guardian;
    struct reason reason = {""};
    int status = 0;
    assert_int_equal(guardian_start(leave_a_child, family, &guardian, &reason), STATUS_OK);
    assert_true(guardian_ended(&guardian, LIMIT_MS, &status));
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 7);
    assert_int_equal(kill(family->member[0], 0), 0); /* it may still answer */
    guardian_stop(&guardian);
    assert_int_equal(kill(family->member[0], 0), -1);
}

/* Exit code: what of us a command has, 0 if nothing. */
static void look_at_signals(const void *user)
{
    sigset_t blocked;
    (void)user;
    sigprocmask(SIG_SETMASK, NULL, &blocked);
    for (int number = 1; number < NSIG; number++) {
        struct sigaction is;
        if (sigismember(&blocked, number) == 1)
            _exit(1);
        if (number < 32 && sigaction(number, NULL, &is) == 0 && is.sa_handler != SIG_DFL)
            _exit(2);
    }
    _exit(getpgrp() == getpid() ? 0 : 3);
}

static void handled(int number)
{
    (void)number;
}

/* Whatever we block, ignore or handle, a command begins as from a shell. */
static void a_command_begins_with_no_signal_blocked_or_taken(void **state)
{
    (void)state;
    static const int taken[] = {SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGUSR1, SIGCHLD, SIGSYS};
    void (*const how[])(int) = {SIG_DFL, SIG_IGN, handled};
    sigset_t all, before;
    sigfillset(&all);
    for (size_t i = 0; i < 6; i++) {
        struct guardian guardian;
        struct reason reason = {""};
        int status = 0;
        for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
            if (taken[k] != SIGCHLD || how[i / 2] != SIG_IGN) /* or none can be waited for */
                signal(taken[k], how[i / 2]);
        sigprocmask(i % 2 ? SIG_BLOCK : SIG_UNBLOCK, &all, &before);
        assert_int_equal(guardian_start(look_at_signals, NULL, &guardian, &reason), STATUS_OK);
        assert_true(guardian_ended(&guardian, LIMIT_MS, &status));
        guardian_stop(&guardian);
        sigprocmask(SIG_SETMASK, &before, NULL);
        for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
            signal(taken[k], SIG_DFL);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
    }
}

static void a_command_that_goes_on_is_not_said_to_have_ended(void **state)
{
    struct family *family = *state;
    struct guardian guardian;
    struct reason reason = {""};
    int status = 0;
    assert_int_equal(guardian_start(start_family, family, &guardian, &reason), STATUS_OK);
    assert_false(guardian_ended(&guardian, 10, &status));
    guardian_stop(&guardian);
}

static int set_up(void **state)
{
    *state = child_share(2 * sizeof(struct family));
    return *state ? 0 : -1;
}

static int tear_down(void **state)
{
    child_unshare(*state, 2 * sizeof(struct family));
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(all_end_when_it_is_stopped, set_up, tear_down),
        cmocka_unit_test_setup_teardown(all_end_when_we_are_killed, set_up, tear_down),
        cmocka_unit_test(a_command_begins_with_no_signal_blocked_or_taken),
        cmocka_unit_test(what_cannot_be_started_is_told),
        cmocka_unit_test_setup_teardown(the_commands_own_end_is_told, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_command_that_goes_on_is_not_said_to_have_ended, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
