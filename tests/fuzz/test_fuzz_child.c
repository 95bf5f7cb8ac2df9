/* Children of our own: what they send arrives whole, and however they end is told. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "ref/outside/child.h"

#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define MOST ((size_t)64 << 20)

static struct reason reason;

static struct child start(child_fn *run, void *user)
{
    struct child child;
    assert_int_equal(child_start(run, user, &child, &reason), STATUS_OK);
    assert_true(child.pid > 0);
    return child;
}

static struct child_fate end(struct child *child, uint32_t ms)
{
    struct child_fate fate;
    child_end(child, ms, &fate);
    assert_int_equal(child->pid, 0);
    return fate;
}

/* Sends every message back, each byte one more. */
static void echo(struct child *parent, void *user)
{
    const void *bytes;
    size_t size;
    (void)user;
    while (child_receive(parent, MOST, CHILD_FOREVER, &bytes, &size) == CHILD_GOT) {
        char *copy = malloc(size + 1);
        for (size_t i = 0; copy && i < size; i++)
            copy[i] = (char)(((const char *)bytes)[i] + 1);
        bool sent = copy && child_send(parent, copy, size, CHILD_FOREVER);
        free(copy);
        if (!sent)
            return;
    }
}

static void messages_arrive_whole_whatever_their_size(void **state)
{
    (void)state;
    static const size_t sizes[] = {0, 1, 7, 4096, 1000000, 20000000};
    struct child child = start(echo, NULL);
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
        char *text = malloc(sizes[i] + 1);
        const void *bytes;
        size_t size;
        assert_non_null(text);
        for (size_t k = 0; k < sizes[i]; k++)
            text[k] = (char)(k * 31 + i);
        assert_true(child_send(&child, text, sizes[i], 10000));
        assert_int_equal(child_receive(&child, MOST, 10000, &bytes, &size), CHILD_GOT);
        assert_int_equal(size, sizes[i]);
        for (size_t k = 0; k < size; k++)
            if (((const char *)bytes)[k] != (char)(text[k] + 1))
                fail_msg("byte %zu of %zu is another one", k, size);
        free(text);
    }
    struct child_fate fate = end(&child, 10000);
    assert_false(fate.forced);
    assert_int_equal(fate.signal, 0);
    assert_int_equal(fate.code, 0);
}

static void a_message_of_another_size_is_not_the_one_wanted(void **state)
{
    (void)state;
    char text[] = "abcdefgh", got[8] = "-------";
    struct child child = start(echo, NULL);
    for (size_t size = 0; size <= 9; size++) {
        assert_true(child_send(&child, text, size, 10000));
        assert_int_equal(child_receive_into(&child, got, 8, 10000), size == 8);
        if (size < 8)
            assert_string_equal(got, "-------");
    }
    assert_memory_equal(got, "bcdefghi", 8);
    assert_int_equal(end(&child, 10000).code, 0);
}

static void crash(struct child *parent, void *user)
{
    char byte;
    (void)user;
    if (child_receive_into(parent, &byte, 1, CHILD_FOREVER)) {
        signal(SIGSEGV, SIG_DFL); /* a sanitizer would make an exit code of it */
        raise(SIGSEGV);
    }
}

static void leave(struct child *parent, void *user)
{
    (void)parent;
    _exit(*(int *)user);
}

static void a_death_is_told(void **state)
{
    (void)state;
    const void *bytes;
    size_t size;
    int code = 3;
    struct child child = start(crash, NULL);
    assert_true(child_send(&child, "x", 1, 1000));
    assert_int_equal(child_receive(&child, MOST, 10000, &bytes, &size), CHILD_GONE);
    struct child_fate fate = end(&child, 10000);
    assert_int_equal(fate.signal, SIGSEGV);
    assert_false(fate.forced);
    assert_string_equal(fate.text, "killed by signal 11 (Segmentation fault)");
    child = start(leave, &code);
    assert_int_equal(child_receive(&child, MOST, 10000, &bytes, &size), CHILD_GONE);
    fate = end(&child, 10000);
    assert_int_equal(fate.signal, 0);
    assert_string_equal(fate.text, "ended itself with code 3");
}

/* Half of a message that says it has 100 bytes; then the end, or nothing more. */
static void say_half(struct child *parent, void *user)
{
    const uint64_t size = 100;
    char some[50] = {0};
    if (send(parent->file, &size, sizeof size, 0) < 0 || send(parent->file, some, 50, 0) < 0)
        _exit(9);
    if (*(bool *)user)
        for (;;)
            pause();
}

static void half_a_message_is_none(void **state)
{
    (void)state;
    const void *bytes;
    size_t size;
    bool stays = false;
    struct child child = start(say_half, &stays);
    assert_int_equal(child_receive(&child, MOST, 10000, &bytes, &size), CHILD_GONE);
    assert_null(bytes);
    assert_int_equal(end(&child, 10000).code, 0);
    stays = true;
    child = start(say_half, &stays);
    uint64_t begun = time_ns();
    assert_int_equal(child_receive(&child, MOST, 200, &bytes, &size), CHILD_LATE);
    uint64_t ms = (time_ns() - begun) / 1000000u;
    assert_true(ms >= 200 && ms < 5000);
    assert_int_equal(child_receive(&child, MOST, 0, &bytes, &size), CHILD_LATE);
    struct child_fate fate = end(&child, 50);
    assert_true(fate.forced);
    assert_int_equal(fate.signal, SIGKILL);
    assert_string_equal(fate.text, "did not end by itself");
    child = start(say_half, &stays);
    assert_int_equal(child_receive(&child, 99, 10000, &bytes, &size), CHILD_TOO_LONG);
    assert_true(end(&child, 0).forced);
}

static void sleep_on(struct child *parent, void *user)
{
    (void)parent;
    (void)user;
    for (;;)
        pause();
}

static void who_does_not_listen_is_not_waited_for(void **state)
{
    (void)state;
    struct child child = start(sleep_on, NULL);
    char *much = calloc(1, MOST);
    assert_non_null(much);
    uint64_t begun = time_ns();
    assert_false(child_send(&child, much, MOST, 200));
    assert_true(time_ns() - begun < 5000000000u);
    free(much);
    assert_true(end(&child, 0).forced);
}

/* Says how many files it has open beyond the standard ones, its own end left out. */
static void count_files(struct child *parent, void *user)
{
    int count = 0;
    (void)user;
    for (int file = 3; file < 1024; file++)
        count += file != parent->file && fcntl(file, F_GETFD) >= 0;
    if (!child_send(parent, &count, sizeof count, 1000))
        _exit(9);
}

static void siblings_hold_nothing_of_each_other(void **state)
{
    (void)state;
    struct child child[5];
    int opened = open("/dev/null", O_RDONLY), count = -1;
    assert_true(opened >= 0);
    for (size_t i = 0; i < ARRAY_COUNT(child); i++)
        child[i] = start(count_files, NULL);
    for (size_t i = 0; i < ARRAY_COUNT(child); i++) {
        assert_true(child_receive_into(&child[i], &count, sizeof count, 10000));
        assert_int_equal(count, 0);
        assert_int_equal(end(&child[i], 10000).code, 0);
    }
    close(opened);
}

static void wait_and_answer(struct child *parent, void *user)
{
    atomic_uint *turn = user;
    char byte;
    while (child_receive_into(parent, &byte, 1, CHILD_FOREVER)) {
        atomic_fetch_add(turn, 1);
        if (!child_send(parent, &byte, 1, 1000))
            return;
    }
}

static void the_one_that_answers_is_heard(void **state)
{
    (void)state;
    atomic_uint *turn = child_share(sizeof *turn);
    struct child child[3], *all[4];
    const void *bytes;
    size_t size;
    assert_non_null(turn);
    for (size_t i = 0; i < 3; i++) {
        child[i] = start(wait_and_answer, turn);
        all[i] = &child[i];
    }
    all[3] = NULL;
    for (size_t i = 0; i < 30; i++) {
        size_t k = i * 7 % 3;
        char byte = (char)i;
        assert_true(child_send(&child[k], &byte, 1, 1000));
        child_wait(all, 4, 10000);
        assert_int_equal(child_receive(&child[k], 1, 1000, &bytes, &size), CHILD_GOT);
        assert_int_equal(*(const char *)bytes, byte);
        assert_int_equal(child_receive(&child[(k + 1) % 3], 1, 0, &bytes, &size), CHILD_LATE);
    }
    assert_int_equal(atomic_load(turn), 30);
    for (size_t i = 0; i < 3; i++)
        assert_false(end(&child[i], 10000).forced);
    child_unshare(turn, sizeof *turn);
}

static void fill(struct child *parent, void *user)
{
    size_t bytes = *(size_t *)user;
    char *memory = malloc(bytes);
    if (memory)
        memset(memory, 1, bytes);
    char byte = memory ? memory[bytes / 2] : 0;
    if (child_send(parent, &byte, 1, 1000) && child_receive_into(parent, &byte, 1, CHILD_FOREVER))
        _exit(9);
    free(memory);
}

static void its_memory_is_seen(void **state)
{
    (void)state;
    size_t bytes = (size_t)200 << 20;
    char byte = 0;
    struct child child = start(fill, &bytes);
    assert_true(child_receive_into(&child, &byte, 1, 10000));
    assert_int_equal(byte, 1);
    uint64_t seen = child_memory(&child);
    assert_true(seen >= bytes && seen < 20 * (uint64_t)bytes);
    assert_false(end(&child, 10000).forced);
}

/* A parent that makes a child, tells who it is, and dies. */
static void die_first(struct child *parent, void *user)
{
    struct child grandchild;
    (void)user;
    if (child_start(sleep_on, NULL, &grandchild, NULL) ||
        !child_send(parent, &grandchild.pid, sizeof grandchild.pid, 1000))
        _exit(9);
    char byte;
    if (child_receive_into(parent, &byte, 1, CHILD_FOREVER))
        raise(SIGKILL);
}

static void no_child_outlives_its_parent(void **state)
{
    (void)state;
    struct child child = start(die_first, NULL);
    pid_t grandchild = 0;
    assert_true(child_receive_into(&child, &grandchild, sizeof grandchild, 10000));
    assert_int_equal(kill(grandchild, 0), 0);
    assert_true(child_send(&child, "x", 1, 1000));
    assert_int_equal(end(&child, 10000).signal, SIGKILL);
    /* Gone, or a zombie that whoever is process 1 here has not collected. */
    char path[64], name[64], what = 'R';
    snprintf(path, sizeof path, "/proc/%ld/stat", (long)grandchild);
    for (int i = 0; i < 500 && what != 'Z' && what != 'X'; i++) {
        FILE *file = fopen(path, "r");
        if (!file || fscanf(file, "%*d %63s %c", name, &what) != 2)
            what = 'X';
        if (file)
            fclose(file);
        usleep(10000);
    }
    assert_true(what == 'Z' || what == 'X');
}

static void pause_for_ever(struct child *parent, void *user)
{
    (void)parent, (void)user;
    for (;;)
        pause();
}

static bool becomes(const struct child *child, bool stopped)
{
    bool debugged;
    for (int tries = 0; tries < 2000 && child_is_stopped(child, &debugged) != stopped; tries++)
        usleep(10000);
    return child_is_stopped(child, &debugged) == stopped;
}

static void a_stopped_child_is_seen(void **state)
{
    (void)state;
    bool debugged;
    struct child child;
    assert_int_equal(child_start(pause_for_ever, NULL, &child, &reason), STATUS_OK);
    assert_false(child_is_stopped(&child, &debugged));
    kill(child.pid, SIGSTOP);
    assert_true(becomes(&child, true));
    kill(child.pid, SIGCONT);
    assert_true(becomes(&child, false));
    child_end(&child, 0, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(messages_arrive_whole_whatever_their_size),
        cmocka_unit_test(a_message_of_another_size_is_not_the_one_wanted),
        cmocka_unit_test(a_death_is_told),
        cmocka_unit_test(half_a_message_is_none),
        cmocka_unit_test(who_does_not_listen_is_not_waited_for),
        cmocka_unit_test(siblings_hold_nothing_of_each_other),
        cmocka_unit_test(the_one_that_answers_is_heard),
        cmocka_unit_test(its_memory_is_seen),
        cmocka_unit_test(a_stopped_child_is_seen),
        cmocka_unit_test(no_child_outlives_its_parent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
