/* A temporary folder for a group of tests, set up and torn down by cmocka. Define _GNU_SOURCE
 * before the first include, for mkdtemp. */
#ifndef TESTS_ROOT_H
#define TESTS_ROOT_H

#include <stdio.h>
#include <stdlib.h>

static char root[] = "/tmp/raydiff-test-XXXXXX";

static inline int make_root(void **state)
{
    (void)state;
    return mkdtemp(root) ? 0 : 1;
}

/* With all that is in it. */
static inline int remove_tree(const char *path)
{
    char command[512];
    snprintf(command, sizeof command, "rm -rf '%s'", path);
    return system(command);
}

static inline int remove_root(void **state)
{
    (void)state;
    return remove_tree(root);
}

#endif
