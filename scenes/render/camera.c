#include "scenes/render/camera.h"

#include "scenes/render/shade.h"

#include <math.h>

static void store(struct vec3 v, float out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

#define PI               3.14159265358979323846
#define CYLINDER_CORNERS 64 /* of each end */

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

/* Inverts the matrix of columns right, up and forward. Returns false if it has no inverse. */
static bool invert(const struct view *view, double out[3][3])
{
    const float *column[3] = {view->right, view->up, view->forward};
    for (int i = 0; i < 3; i++) {
        const float *a = column[(i + 1) % 3], *b = column[(i + 2) % 3];
        double det = 0;
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            out[i][k] = (double)a[m] * (double)b[n] - (double)a[n] * (double)b[m];
            det += out[i][k] * (double)column[i][k];
        }
        if (!(fabs(det) > 0))
            return false;
        for (int k = 0; k < 3; k++)
            out[i][k] /= det;
    }
    return true;
}

/* Where a model of corners p lies in a view of the target: with p - at = right a + up b + forward c
 * and h = CAMERA_SHARE / 2, the largest a - hc, -a - hc, b - hc and -b - hc. A camera that stands d
 * behind the target and is moved by right x + up y sees p within the share if |a - x| <= h (d + c)
 * and |b - y| <= h (d + c): if d is at least half of the sum of either pair over h, and x and y are
 * half of their difference. */
struct reach {
    double inverse[3][3];
    const float *at;
    double most[4];
};

static void reach_add(struct reach *reach, const double p[3])
{
    double part[3] = {0, 0, 0};
    for (int m = 0; m < 3; m++)
        for (int k = 0; k < 3; k++)
            part[m] += reach->inverse[m][k] * (p[k] - (double)reach->at[k]);
    for (int m = 0; m < 4; m++) {
        double side = m % 2 ? -part[m / 2] : part[m / 2];
        reach->most[m] = fmax(reach->most[m], side - 0.5 * CAMERA_SHARE * part[2]);
    }
}

static void reach_model(struct reach *reach, const struct scene *scene)
{
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++) {
        const float *v = scene->vertex + 3 * (size_t)scene->index[i];
        reach_add(reach, (const double[3]){(double)v[0], (double)v[1], (double)v[2]});
    }
}

/* The upright cylinder around the target that holds the model: what a whole turn shows of it. */
static void reach_cylinder(struct reach *reach, const struct scene *scene)
{
    double radius = 0, end[2] = {INFINITY, -INFINITY};
    const double x = (double)reach->at[0], z = (double)reach->at[2];
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++) {
        const float *v = scene->vertex + 3 * (size_t)scene->index[i];
        radius = fmax(radius, hypot((double)v[0] - x, (double)v[2] - z));
        end[0] = fmin(end[0], (double)v[1]);
        end[1] = fmax(end[1], (double)v[1]);
    }
    for (int i = 0; i < 2 * CYLINDER_CORNERS; i++) {
        double angle = (i / 2) * (2 * PI / CYLINDER_CORNERS);
        reach_add(reach,
                  (const double[3]){x + radius * cos(angle), end[i % 2], z + radius * sin(angle)});
    }
}

struct camera camera_of_scene(const struct scene *scene, enum framing framing, enum profile profile,
                              uint32_t width, uint32_t height)
{
    const struct camera camera = scene_camera(scene);
    const struct view view = camera_view(&camera, profile, width, height);
    const double none = -INFINITY;
    struct reach reach = {.at = camera.at, .most = {none, none, none, none}};
    if (scene->has_camera || framing == FRAMING_OVERVIEW || scene->tri_count == 0 ||
        !invert(&view, reach.inverse))
        return camera;
    if (framing == FRAMING_TURN)
        reach_cylinder(&reach, scene);
    else
        reach_model(&reach, scene);
    double back = 0, aside[2] = {0, 0};
    for (int m = 0; m < 2; m++) {
        double left = reach.most[2 * m], right = reach.most[2 * m + 1];
        if (framing == FRAMING_MODEL)
            aside[m] = 0.5 * (left - right);
        back = fmax(back, fmax(left - aside[m], right + aside[m]) / (0.5 * CAMERA_SHARE));
    }
    struct camera framed = camera;
    for (int k = 0; k < 3 && back > 0; k++) {
        double at =
            (double)camera.at[k] + aside[0] * (double)view.right[k] + aside[1] * (double)view.up[k];
        framed.at[k] = (float)at;
        framed.pos[k] = (float)(at - back * (double)view.forward[k]);
    }
    return framed;
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
