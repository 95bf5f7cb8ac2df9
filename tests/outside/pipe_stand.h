/* A scene and its rays for peers behind a pipe. Define RAYS before it; include after cmocka.h. */
#ifndef TESTS_PIPE_STAND_H
#define TESTS_PIPE_STAND_H

#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <errno.h>
#include <sys/wait.h>

static struct scene scene;
static struct ray rays[RAYS];

static inline struct job job_of(enum query query)
{
    return (struct job){.scene = &scene, .tri = tri_test_find("mt"), .query = query};
}

/* No child is left, dead or alive. */
static inline void must_have_no_children(void)
{
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static inline int make_scene(void **state)
{
    (void)state;
    struct reason reason;
    if (scene_open("sphere", 1, &scene, &reason))
        return -1;
    return ray_set_make(ray_sets[0], &scene, 1, RAYS, rays, &reason) ? -1 : 0;
}

static inline int free_scene(void **state)
{
    (void)state;
    scene_free(&scene);
    return 0;
}

#endif
