/* Passes that make transforms plainer: the identity, a translation, powers of two; or move the
 * world as a whole. */
#include "fuzz/shrink/shrink_inner.h"

#include "ref/world/object_ray.h"

#include <string.h>

static void set_linear(struct instance *one, const float diagonal[3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            one->m[i][j] = i == j ? diagonal[i] : 0.0f;
}

static void set_identity(struct instance *one)
{
    static const float ones[3] = {1, 1, 1};
    set_linear(one, ones);
    one->m[0][3] = one->m[1][3] = one->m[2][3] = 0;
}

void shrink_place(const struct instance *one, const float p[3], float out[3])
{
    for (int k = 0; k < 3; k++) {
        const float *m = one->m[k];
        out[k] = ((m[0] * p[0] + m[1] * p[1]) + m[2] * p[2]) + m[3];
    }
}

/* Takes all rays into the space of a mesh as it was placed, and from there to where it is now;
 * false if the inverse is beyond float32. */
static bool carry_rays(struct fuzz_trial *trial, const struct instance *was,
                       const struct instance *is)
{
    struct instance_record record = {.t = {was->m[0][3], was->m[1][3], was->m[2][3]}};
    if (transform_inverse(was->m, record.w, NULL))
        return false;
    for (uint32_t i = 0; i < trial->ray_count; i++) {
        struct ray *ray = &trial->ray[i];
        const struct ray inside = transform_ray(&record, ray);
        shrink_place(is, inside.org, ray->org);
        for (int k = 0; k < 3; k++)
            ray->dir[k] = (is->m[k][0] * inside.dir[0] + is->m[k][1] * inside.dir[1]) +
                          is->m[k][2] * inside.dir[2];
    }
    return true;
}

/* Places the vertices of its mesh where the instance does. */
static bool bake(struct fuzz_trial *trial, const struct instance *one)
{
    struct scene *scene = &trial->scene;
    uint32_t first, count;
    if (one->mesh == WORLD_NO_MESH)
        return false;
    trial_world_mesh(&trial->world, one->mesh, &first, &count);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        bool used = false;
        for (size_t i = 3 * (size_t)first; i < 3 * ((size_t)first + count) && !used; i++)
            used = scene->index[i] == v;
        float placed[3];
        shrink_place(one, scene->vertex + 3 * (size_t)v, placed);
        if (used)
            memcpy(scene->vertex + 3 * (size_t)v, placed, sizeof placed);
    }
    return true;
}

static float power_below(float x)
{
    return float_from_bits(float_bits(x) & 0xFF800000u);
}

/* The simplest first. */
enum {
    IDENTITY,
    ALL_IDENTITY,
    BAKED,
    TRANSLATED,
    UNMOVED,
    POWERS,
    DIAGONAL,
    POSITIVE,
    AS_FIRST,
    AS_BEFORE,
    SWAPPED,  /* with the one before it */
    MOVED_ON, /* translated by 1 along an axis, or by more than the vertices reach: 6 changes */
    DOUBLED = MOVED_ON + 6,
    MIRRORED, /* along an axis: 3 changes */
    PLACES = MIRRORED + 3
};

static bool change_diagonal(struct instance *one, uint32_t variant)
{
    float diagonal[3];
    for (int k = 0; k < 3; k++) {
        float x = one->m[k][k];
        diagonal[k] = variant == POWERS ? power_below(x) : x;
        if (variant == POSITIVE)
            diagonal[k] = float_from_bits(float_bits(x) & 0x7FFFFFFFu);
    }
    set_linear(one, diagonal);
    return true;
}

static bool copy_place(struct instance *to, const struct instance *from)
{
    memcpy(to->m, from->m, sizeof to->m);
    return to != from;
}

/* The power of two over all coordinates of vertices. */
static float reach_of(const struct scene *scene)
{
    float most = 0;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        float x = float_from_bits(float_bits(scene->vertex[i]) & 0x7FFFFFFFu);
        most = x > most ? x : most;
    }
    return shrink_scaled(1.0f, 1 + shrink_exponent(most));
}

/* What only has to be another place: a plain one. */
static bool change_plainly(const struct scene *scene, struct instance *one, uint32_t variant)
{
    const float size = variant == DOUBLED ? 2.0f : 1.0f;
    float diagonal[3] = {size, size, size};
    if (variant >= MIRRORED)
        diagonal[variant - MIRRORED] = -1.0f;
    set_identity(one);
    set_linear(one, diagonal);
    if (variant < DOUBLED)
        one->m[(variant - MOVED_ON) % 3][3] = variant < MOVED_ON + 3 ? 1.0f : reach_of(scene);
    return true;
}

/* Changes the place of an instance, and what must change with it. */
static bool place_anew(struct fuzz_trial *trial, uint32_t at, uint32_t how)
{
    static const float ones[3] = {1, 1, 1};
    struct trial_world *world = &trial->world;
    struct instance *one = &world->instance[at], *before = at ? one - 1 : NULL;
    const struct instance old = *one;
    switch (how) {
    case IDENTITY:
        set_identity(one);
        return true;
    case ALL_IDENTITY:
        for (uint32_t i = 0; i < world->instance_count; i++)
            set_identity(&world->instance[i]);
        return true;
    case BAKED:
        set_identity(one);
        return bake(trial, &old);
    case TRANSLATED:
        set_linear(one, ones);
        return true;
    case UNMOVED:
        one->m[0][3] = one->m[1][3] = one->m[2][3] = 0;
        return true;
    case AS_FIRST:
        return copy_place(one, &world->instance[0]);
    case AS_BEFORE:
        return before && copy_place(one, before);
    case SWAPPED:
        if (!before)
            return false;
        *one = *before;
        *before = old;
        return true;
    default:
        return how < MOVED_ON ? change_diagonal(one, how) : change_plainly(&trial->scene, one, how);
    }
}

/* Every change as it is, and with the rays going along with the instance. */
static bool change_place(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    const struct instance old = trial->world.instance[first];
    (void)count;
    if (!place_anew(trial, first, variant % PLACES))
        return false;
    return variant < PLACES || carry_rays(trial, &old, &trial->world.instance[first]);
}

static uint32_t axes_of(const struct fuzz_trial *trial)
{
    return 3 * trial->world.instance_count;
}

enum { SHIFT, SHIFT_RAYS_TOO, SCALE, FRAMES };

/* Moves all instances along an axis so that one of them is not moved along it, or scales the world
 * so that a number of a transform is 1 to 2. */
static bool change_world(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    struct trial_world *world = &trial->world;
    const uint32_t axis = first % 3;
    const struct instance *one = &world->instance[first / 3];
    const float by = one->m[axis][3];
    const int power = -shrink_exponent(one->m[axis][axis]);
    (void)count;
    if (variant == SCALE ? power == 0 : by == 0)
        return false;
    for (uint32_t i = 0; i < world->instance_count; i++)
        for (int k = 0; k < 12; k++) {
            float *x = &world->instance[i].m[k / 4][k % 4];
            if (variant == SCALE)
                *x = shrink_scaled(*x, power);
            else if (k == 4 * (int)axis + 3)
                *x -= by;
        }
    for (uint32_t i = 0; i < trial->ray_count; i++)
        for (uint32_t k = 0; k < 3; k++)
            if (variant == SCALE) {
                trial->ray[i].org[k] = shrink_scaled(trial->ray[i].org[k], power);
                trial->ray[i].dir[k] = shrink_scaled(trial->ray[i].dir[k], power);
            } else if (k == axis && variant == SHIFT_RAYS_TOO) {
                trial->ray[i].org[k] -= by;
            }
    return true;
}

const struct shrink_pass shrink_places = {"places", SHRINK_SINGLY, shrink_instances_of, 2 * PLACES,
                                          change_place};
const struct shrink_pass shrink_world_frame = {"world", SHRINK_SINGLY, axes_of, FRAMES,
                                               change_world};
