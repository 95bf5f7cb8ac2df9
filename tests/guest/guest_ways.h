/* Both ways to run the guests of the tests: engine FILE.so, whose host is this program, and engine
 * inside:FILE.so. Includes cmocka.h. */
#ifndef TESTS_GUEST_WAYS_H
#define TESTS_GUEST_WAYS_H

#include "ref/guest/guest_engine.h"
#include "ref/guest/guest_host.h"
#include "ref/outside/pipe.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static char folder[GUEST_PATH_MOST]; /* of the objects, ends in '/' */

/* Objects lie in samples/, in a folder above that of this program. */
static inline void find_folder(const char *program)
{
    const char *slash = strrchr(program, '/');
    char up[16] = "../", file[GUEST_PATH_MOST + 24];
    for (int i = 0; i < 4; i++, strcat(up, "../")) {
        snprintf(folder, sizeof folder, "%.*s%ssamples/", slash ? (int)(slash + 1 - program) : 0,
                 program, up);
        snprintf(file, sizeof file, "%sguest_bad.so", folder);
        if (access(file, R_OK) == 0)
            return;
    }
}

static inline const char *object_path(const char *file, char path[GUEST_PATH_MOST])
{
    assert_true(strlen(folder) + strlen(file) < GUEST_PATH_MOST);
    strcpy(path, folder);
    strcat(path, file);
    return path;
}

static inline const struct engine *engine_way(const char *file, bool inside)
{
    char path[GUEST_PATH_MOST], name[GUEST_PATH_MOST + 16];
    const struct engine *engine;
    struct reason reason = {""};
    snprintf(name, sizeof name, "%s%s", inside ? "inside:" : "", object_path(file, path));
    enum status status =
        inside ? guest_engine(name, &engine, &reason) : pipe_engine(name, &engine, &reason);
    if (status)
        fail_msg("%s", reason.text);
    return engine;
}

/* What the guest "bad" does from now on. */
static inline void behave(const char *what)
{
    assert_int_equal(setenv("GUEST", what, 1), 0);
}

#endif
