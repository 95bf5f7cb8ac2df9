/* Passes that change the whole scene: move, scale and mirror it, or make the ray plainer. */
#include "fuzz/shrink/shrink_inner.h"

#include <string.h>

/* A ray is aimed at the triangles of a trial that has at most so many. */
#define AIMED_MOST 16u

/* Scales vertices, origins and with `dirs` directions by 2^by along an axis, or all for axis 3; t
 * follows where directions do not. */
static void scale(struct fuzz_trial *trial, uint32_t axis, int by, bool places, bool dirs)
{
    uint32_t n = shrink_number_count(trial);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k;
        float *x = shrink_number(trial, i);
        enum shrink_role role = shrink_role(trial, i, &k);
        bool along = role <= SHRINK_DIR && (axis == 3 || axis == k);
        if (along && (role == SHRINK_DIR ? dirs : places))
            *x = shrink_scaled(*x, by);
        if ((role == SHRINK_TMIN || role == SHRINK_TMAX) && places != dirs)
            *x = shrink_scaled(*x, places ? by : -by);
    }
}

static void shift(struct fuzz_trial *trial, uint32_t axis, float by)
{
    uint32_t n = shrink_number_count(trial);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k;
        float *x = shrink_number(trial, i);
        if (shrink_role(trial, i, &k) <= SHRINK_ORG && k == axis)
            *x -= by;
    }
}

static void mirror(struct fuzz_trial *trial, uint32_t axis)
{
    uint32_t n = shrink_number_count(trial);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k;
        float *x = shrink_number(trial, i);
        if (shrink_role(trial, i, &k) <= SHRINK_DIR && k == axis && *x != 0)
            *x = -*x;
    }
}

/* Moves a ray's origin along it to where its coordinate is 0. */
static bool slide(struct fuzz_trial *trial, uint32_t i, uint32_t axis)
{
    struct ray *ray = &trial->ray[(i - 3 * trial->scene.vertex_count) / 8];
    float t = ray->org[axis] / ray->dir[axis];
    if (!(ray->dir[axis] != 0) || !float_is_finite(t))
        return false;
    for (int k = 0; k < 3; k++)
        ray->org[k] -= t * ray->dir[k];
    ray->org[axis] = 0;
    return true;
}

enum { SCALE, SCALE_PLACES, SCALE_AXIS, SCALE_DIRS, SHIFT, SLIDE, MIRROR, FRAME_COUNT };

/* Moves or scales so that number `first` becomes 0, or 1 to 2; or mirrors its axis. */
static bool change_frame(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t axis;
    enum shrink_role role = shrink_role(trial, first, &axis);
    float x = *shrink_number(trial, first);
    int by = -shrink_exponent(x);
    (void)count;
    if (role > SHRINK_DIR || !float_is_finite(x) || x == 0)
        return false;
    switch (variant) {
    case SCALE:
        scale(trial, 3, by, true, true);
        return true;
    case SCALE_PLACES:
        scale(trial, 3, by, true, false);
        return true;
    case SCALE_AXIS:
        scale(trial, axis, by, true, true);
        return true;
    case SCALE_DIRS:
        scale(trial, 3, by, false, true);
        return role == SHRINK_DIR;
    case SHIFT:
        shift(trial, axis, x);
        return role <= SHRINK_ORG;
    case SLIDE:
        return role == SHRINK_ORG && slide(trial, first, axis);
    default:
        mirror(trial, axis);
        return first == axis; /* once an axis */
    }
}

/* Of trials of one ray: triangles that it may be aimed at; of a world those of each instance,
 * whatever its mesh. */
static uint32_t aimed(const struct fuzz_trial *trial)
{
    uint64_t count = trial->scene.tri_count;
    if (trial->world.is)
        count *= trial->world.instance_count;
    return trial->ray_count == 1 && count <= AIMED_MOST ? (uint32_t)count : 0;
}

#define FEATURES 16 /* corners, middles of edges, points inside */
/* Ways to come: along an axis, with length 1 or that of before; as before; the same with powers of
 * two. */
enum { UNIT_WAYS = 6, OWN_WAY = 2 * UNIT_WAYS, ROUND_WAY, WAYS };

/* Weights of the corners: a feature has three, and one of them turned twice is the next. */
static void feature(uint32_t i, float w[3])
{
    /* On a corner, on an edge, and near a corner, where boxes end. */
    static const float kinds[][3] = {{1, 0, 0},
                                     {0.5f, 0.5f, 0},
                                     {0.875f, 0.0625f, 0.0625f},
                                     {0.984375f, 0.0078125f, 0.0078125f},
                                     {0.9990234375f, 0.00048828125f, 0.00048828125f},
                                     {0.5f, 0.25f, 0.25f}};
    for (uint32_t k = 0; k < 3; k++)
        w[(k + i) % 3] = kinds[i / 3][k];
}

/* The power of two below its largest component. */
static float length_of(const float dir[3])
{
    float most = 0;
    for (int k = 0; k < 3; k++) {
        float size = dir[k] < 0 ? -dir[k] : dir[k];
        most = size > most ? size : most;
    }
    return shrink_scaled(1.0f, shrink_exponent(most));
}

/* Sets the ray's direction, and in step[] how far in front it begins. */
static void turn(struct ray *ray, uint32_t way, float step[3])
{
    float sign = way % 2 ? -1.0f : 1.0f, length = way < UNIT_WAYS ? 1.0f : length_of(ray->dir);
    for (uint32_t k = 0; k < 3; k++) {
        bool along = k == way % UNIT_WAYS / 2;
        if (way == ROUND_WAY && ray->dir[k] != 0)
            ray->dir[k] = (ray->dir[k] < 0 ? -1.0f : 1.0f) *
                          shrink_scaled(1.0f, shrink_exponent(ray->dir[k]));
        else if (way < OWN_WAY)
            ray->dir[k] = along ? sign * length : 0.0f;
        step[k] = way >= OWN_WAY ? ray->dir[k] : along ? sign : 0.0f;
    }
}

/* A plainer ray that begins in front of a feature of the triangle and goes there. */
static bool change_aim(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    struct ray *ray = &trial->ray[0];
    float v[3][3], w[3], step[3];
    (void)count;
    feature(variant / WAYS, w);
    turn(ray, variant % WAYS, step);
    scene_tri(&trial->scene, first % trial->scene.tri_count, v);
    for (int c = 0; c < 3 && trial->world.is; c++) {
        const float p[3] = {v[c][0], v[c][1], v[c][2]};
        shrink_place(&trial->world.instance[first / trial->scene.tri_count], p, v[c]);
    }
    for (uint32_t k = 0; k < 3; k++)
        ray->org[k] = (w[0] * v[0][k] + w[1] * v[1][k]) + w[2] * v[2][k] - step[k];
    ray->tmin = 0;
    ray->tmax = float_from_bits(0x7F800000u);
    return true;
}

const struct shrink_pass shrink_frame = {"frame", SHRINK_SINGLY, shrink_few_numbers, FRAME_COUNT,
                                         change_frame};
const struct shrink_pass shrink_aim = {"aim", SHRINK_SINGLY, aimed, FEATURES *WAYS, change_aim};
