/* Laws of tests/readers/reader_entry.h: an entry that keeps its reader's promises plays on, one
 * that breaks them ends the program, for each way to break them. The entry is this file's. */
#define _GNU_SOURCE
#include "tests/readers/reader_entry.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#define FIXED 4096

static void *volatile kept;

/* What the first byte says; the others are room. Compilers must not see through the allocations. */
static bool play(const char *bytes, size_t size)
{
    struct reason reason = {"fine"};
    void *volatile block = NULL, *volatile more[64] = {NULL};
    switch (size ? bytes[0] : 0) {
    case 'm': /* as much as may be, but for what the allocator adds */
        block = malloc(READER_TIMES * size + FIXED - 64);
        break;
    case 'b': /* a block too large */
        block = malloc(READER_TIMES * size + FIXED + 64);
        break;
    case 'g': /* by growing */
        for (size_t n = 1; n < 1 << 20; n *= 2)
            block = realloc(block, n);
        break;
    case 's': /* many small ones */
        for (size_t i = 0; i < 64; i++)
            more[i] = calloc(1, READER_TIMES * size / 64 + FIXED / 32);
        for (size_t i = 0; i < 64; i++)
            free(more[i]);
        break;
    case 'h': /* more than there is */
        block = calloc((size_t)1 << 40, 1 << 10);
        break;
    case 'l': /* a leak */
        kept = malloc(10);
        break;
    case 'k': /* kept for the next time */
        if (!kept)
            kept = malloc(10);
        break;
    case 'n':
        reason.text[1] = '\n';
        break;
    case 'e':
        reason.text[0] = '\0';
        break;
    default:
        return false;
    }
    reader_must_be_reason(&reason);
    free(block);
    return true;
}

const struct reader_entry reader_entry = {"test", FIXED, play};

/* Plays one input in a child; true if it went on. */
static bool goes_on(const char *input)
{
    int status;
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        assert_non_null(freopen("/dev/null", "w", stderr));
        signal(SIGABRT, SIG_DFL); /* CMocka would turn it into a failure of the test */
        for (int i = 0; i < 3; i++)
            LLVMFuzzerTestOneInput((const uint8_t *)input, strlen(input));
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static void promises_kept_play_on(void **state)
{
    (void)state;
    assert_true(goes_on(""));
    assert_true(goes_on("anything"));
    assert_true(goes_on("m"));
    assert_true(goes_on("many bytes, so that many more may be held"));
    assert_true(goes_on("k"));
}

static void promises_broken_end_it(void **state)
{
    (void)state;
    assert_false(goes_on("n"));
    assert_false(goes_on("e"));
    if (!reader_counts()) {
        printf("SKIP: this build does not count memory\n");
        skip();
    }
    assert_false(goes_on("b"));
    assert_false(goes_on("big"));
    assert_false(goes_on("g"));
    assert_false(goes_on("s"));
    assert_false(goes_on("l"));
#ifndef __SANITIZE_ADDRESS__ /* which ends the program itself */
    assert_false(goes_on("h"));
#endif
}

static void what_was_seen_is_told(void **state)
{
    (void)state;
    uint8_t input[1500] = {'m'};
    LLVMFuzzerTestOneInput(input, sizeof input);
    LLVMFuzzerTestOneInput((const uint8_t *)"?", 1);
    const struct reader_tally *tally = reader_tally();
    assert_int_equal(tally->inputs, 2);
    assert_int_equal(tally->taken, 1);
    if (!reader_counts())
        return;
    assert_int_equal(tally->most_size, sizeof input);
    assert_in_range(tally->most, READER_TIMES * sizeof input + FIXED - 64,
                    READER_TIMES * sizeof input + FIXED);
    assert_true(tally->share > 0.99 && tally->share <= 1.0);
    assert_true(tally->times > READER_TIMES && tally->times < READER_TIMES + 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(promises_kept_play_on),
        cmocka_unit_test(promises_broken_end_it),
        cmocka_unit_test(what_was_seen_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
