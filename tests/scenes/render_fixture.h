/* What test_render.c and test_shading.c share; includes cmocka.h. */
#ifndef RENDER_FIXTURE_H
#define RENDER_FIXTURE_H

#include "scenes/read/normals.h"
#include "scenes/render/shade.h"
#include "ref/trace/trace.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */
#include "tests/support/pictures.h"

static const struct look looks[] = {
    {.profile = PROFILE_REPAIRED, .bounces = 4, .ambience = 0.1f, .camera_light = 0.25f},
    {.profile = PROFILE_RTRS, .bounces = 4},
};

typedef double vec[3];

#endif
