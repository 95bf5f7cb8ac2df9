/* The file of the scene that RTRS publishes, which is not part of this project. */
#ifndef TESTS_PUBLISHED_H
#define TESTS_PUBLISHED_H

#include <stdio.h>
#include <stdlib.h>

#define PUBLISHED_SCENE "RAYDIFF_PUBLISHED_SCENE"

/* What that variable names, or NULL, after a line that says so: then the test is skipped. A file
 * that is named and cannot be read fails the test. */
static inline const char *published_scene(void)
{
    const char *path = getenv(PUBLISHED_SCENE);
    if (path && *path)
        return path;
    printf("SKIP " PUBLISHED_SCENE " names no file: the scene that RTRS publishes\n");
    return NULL;
}

#endif
