/* The engine of a peer that is the test's own program, run as `--peer WHAT`. Includes cmocka.h. */
#ifndef TESTS_PEER_ENGINE_H
#define TESTS_PEER_ENGINE_H

#include "ref/outside/pipe.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

static const char *program; /* this one */

/* Engines are listed for good, and only a few: one whose command has what it is from a variable. */
static inline const struct engine *peer_engine(const char *what)
{
    char name[PIPE_NAME_MOST];
    const struct engine *engine;
    struct reason reason;
    assert_int_equal(setenv("PEER", what, 1), 0);
    snprintf(name, sizeof name, "pipe:exec %.100s --peer \"$PEER\"", program);
    assert_int_equal(pipe_engine(name, &engine, &reason), STATUS_OK);
    return engine;
}

#endif
