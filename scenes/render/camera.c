#include "scenes/render/camera.h"

#include "scenes/render/shade.h"

#include <math.h>

static void store(struct vec3 v, float out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/* Below this squared sine of the angle to the vertical, +y cannot define up. */
#define CAMERA_UPRIGHT 1e-12f

struct view camera_view(const struct camera *camera, enum profile profile, uint32_t width,
                        uint32_t height)
{
    struct view view = {.centre = profile == PROFILE_RTRS ? 0.0f : 0.5f};
    struct vec3 up = {0, 1, 0}, pos = vec3_of(camera->pos);
    struct vec3 forward = shade_unit(vec3_sub(vec3_of(camera->at), pos));
    if (vec3_dot(forward, forward) == 0)
        forward.z = -1;
    if (profile == PROFILE_REPAIRED &&
        forward.x * forward.x + forward.z * forward.z < CAMERA_UPRIGHT)
        up = (struct vec3){0, 0, 1};
    struct vec3 right = vec3_cross(forward, up);
    if (profile == PROFILE_REPAIRED) {
        right = shade_unit(right);
        up = vec3_cross(right, forward);
        right = vec3_scale(right, (float)width / (float)height);
    }
    store(pos, view.pos);
    store(right, view.right);
    store(up, view.up);
    store(forward, view.forward);
    return view;
}

struct camera camera_orbit(const struct camera *camera, double angle)
{
    struct camera turned = *camera;
    double x = (double)camera->pos[0] - (double)camera->at[0];
    double z = (double)camera->pos[2] - (double)camera->at[2];
    turned.pos[0] = (float)((double)camera->at[0] + (x * cos(angle) - z * sin(angle)));
    turned.pos[2] = (float)((double)camera->at[2] + (x * sin(angle) + z * cos(angle)));
    return turned;
}
