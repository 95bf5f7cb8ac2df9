/* The scene and the rays that tests of guests share: a group's setup makes them. */
#ifndef GUEST_SCENE_H
#define GUEST_SCENE_H

#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/guest/guest_ways.h"

#define RAYS 200

static struct scene scene;
static struct ray rays[RAYS];

static int make_scene(void **state)
{
    (void)state;
    struct reason reason = {""};
    if (scene_open("sphere:n=4", 1, &scene, &reason) ||
        ray_set_make(ray_sets[0], &scene, 1, RAYS, rays, &reason)) {
        print_error("%s\n", reason.text);
        return -1;
    }
    return 0;
}

static int free_scene(void **state)
{
    (void)state;
    scene_free(&scene);
    return 0;
}

#endif
