/* Camera rays, and rays that bounce from the points they hit. */
#include "ref/base/double3.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays_stage.h"

#include <math.h>
#include <stdlib.h>

extern const struct ray_set ray_set_random;

/* Numbers of camera rays traced to bounce from: enough for variety, few enough for a large mesh. */
#define PRIMARY_LEAST 4096
#define PRIMARY_MOST  65536

/* A pinhole camera: the ray through (nx, ny) of the picture, each in -0.5 .. 0.5, has the direction
 * right * nx + up * ny + forward. */
struct pinhole {
    float pos[3];
    double forward[3], right[3], up[3];
};

/* The published camera: up is +y, and right = forward x up is not normalised. If it looks straight
 * up or down, where the published picture degenerates to a line, up is +z. */
static struct pinhole pinhole_make(const struct camera *camera)
{
    struct pinhole p = {.up = {0, 1, 0}};
    for (int k = 0; k < 3; k++) {
        p.pos[k] = fminf(fmaxf(camera->pos[k], -0x1p39f), 0x1p39f);
        p.forward[k] = (double)camera->at[k] - (double)p.pos[k];
    }
    if (!double3_unit(p.forward))
        p.forward[2] = -1;
    if (p.forward[0] * p.forward[0] + p.forward[2] * p.forward[2] < 1e-12) {
        p.up[1] = 0;
        p.up[2] = 1;
    }
    double3_cross(p.forward, p.up, p.right);
    return p;
}

/* Smallest w with w * w >= count. */
static size_t side_of(size_t count)
{
    size_t side = (size_t)sqrt((double)count);
    while (side * side < count)
        side++;
    while (side > 1 && (side - 1) * (side - 1) >= count)
        side--;
    return side;
}

/* Makes `count` rays through pixel centres, row by row from the bottom. */
static void pinhole_rays(const struct pinhole *p, size_t count, struct ray *out)
{
    size_t width = side_of(count);
    size_t height = width ? (count + width - 1) / width : 0;
    for (size_t i = 0; i < count; i++) {
        double nx = ((double)(i % width) + 0.5) / (double)width - 0.5;
        double ny = ((double)(i / width) + 0.5) / (double)height - 0.5;
        double dir[3];
        for (int k = 0; k < 3; k++)
            dir[k] = p->right[k] * nx + p->up[k] * ny + p->forward[k];
        double3_unit(dir);
        stage_ray(p->pos, (const float[3]){(float)dir[0], (float)dir[1], (float)dir[2]}, &out[i]);
    }
}

/* Scene files may contain any camera. */
static enum status check_camera(const struct scene *scene, struct reason *reason)
{
    for (int k = 0; k < 3 && scene->has_camera; k++) {
        if (!float_is_finite(scene->camera.pos[k]) || !float_is_finite(scene->camera.at[k]))
            return fail(reason, STATUS_INPUT, "camera: coordinate %c is not finite", "xyz"[k]);
        if (fabsf(scene->camera.pos[k]) > 0x1p39f)
            return fail(reason, STATUS_INPUT, "camera: coordinate %c is %g, beyond 2^39", "xyz"[k],
                        (double)scene -> camera.pos[k]);
    }
    return STATUS_OK;
}

static enum status make_primary(const struct scene *scene, uint64_t seed, size_t count,
                                struct ray *out, struct reason *reason)
{
    (void)seed; /* no random numbers */
    enum status status = check_camera(scene, reason);
    if (status)
        return status;
    struct camera camera = scene_camera(scene);
    struct pinhole pinhole = pinhole_make(&camera);
    pinhole_rays(&pinhole, count, out);
    return STATUS_OK;
}

/* A point hit by a camera ray, and the face's unit normal on the camera's side. */
struct camera_spot {
    float p[3];
    double normal[3];
};

/* Returns false if the face has no normal. */
static bool spot_make(const struct scene *scene, const struct ray *ray, const struct hit *hit,
                      struct camera_spot *out)
{
    float v[3][3];
    double e1[3], e2[3], facing = 0;
    scene_tri(scene, hit->prim, v);
    for (int k = 0; k < 3; k++)
        out->p[k] = ray->org[k] + hit->t * ray->dir[k];
    double3_sub(v[1], v[0], e1);
    double3_sub(v[2], v[0], e2);
    double3_cross(e1, e2, out->normal);
    if (!double3_unit(out->normal))
        return false;
    for (int k = 0; k < 3; k++)
        facing += out->normal[k] * (double)ray->dir[k];
    for (int k = 0; k < 3 && facing > 0; k++)
        out->normal[k] = -out->normal[k];
    return true;
}

/* Traces `count` camera rays and keeps the points hit. */
static enum status find_spots(const struct packed *packed, const struct scene *scene,
                              const struct camera *camera, size_t count, struct ray *ray,
                              struct camera_spot *spot, size_t *spot_count, struct reason *reason)
{
    struct pinhole pinhole = pinhole_make(camera);
    const struct job job = {.scene = scene,
                            .packed = packed,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = QUERY_CLOSEST};
    *spot_count = 0;
    pinhole_rays(&pinhole, count, ray);
    for (size_t i = 0; i < count; i++) {
        struct hit hit;
        enum status status = trace_ray(&job, &ray[i], &hit, NULL);
        if (status)
            return fail(reason, status, "bounce: the traversal of a camera ray did not end");
        if (hit.prim != ABI_NO_PRIM && spot_make(scene, &ray[i], &hit, &spot[*spot_count]))
            ++*spot_count;
    }
    return STATUS_OK;
}

/* Builds the tree for the camera rays. */
static enum status make_tree(const struct scene *scene, struct packed *out, struct reason *reason)
{
    const struct build_options options = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh = {0};
    *out = (struct packed){0};
    enum status status = bvh_build(builder_find("median"), scene, &options, &bvh, reason);
    if (status)
        return status;
    status = packed_make(layout_find("f32"), &bvh, scene, out, reason);
    bvh_free(&bvh);
    return status;
}

/* Makes ray i from a spot: odd rays start exactly at the computed point, even ones lifted off the
 * face. The sum of the normal and a uniform unit vector is cosine-distributed. */
static void bounce_ray(const struct stage *stage, const struct camera_spot *spot, size_t i,
                       struct ray *out)
{
    struct rng rng = stage_rng(stage, i);
    float ball[3], org[3];
    double dir[3], lift = i & 1 ? 0.0 : 0x1p-10 * (double)stage->extent;
    stage_direction(&rng, ball);
    for (int k = 0; k < 3; k++) {
        dir[k] = spot->normal[k] + (double)ball[k];
        org[k] = (float)((double)spot->p[k] + lift * spot->normal[k]);
    }
    if (double3_dot(dir, dir) < 1e-6)
        for (int k = 0; k < 3; k++) /* the sum is rounding noise: use the normal */
            dir[k] = spot->normal[k];
    double3_unit(dir);
    stage_ray(org, (const float[3]){(float)dir[0], (float)dir[1], (float)dir[2]}, out);
}

/* Finds the spots of the scene's camera. If it sees nothing, uses the default camera, which sees
 * the whole scene. */
static enum status spots_of_scene(const struct scene *scene, size_t count, struct ray *ray,
                                  struct camera_spot *spot, size_t *spot_count,
                                  struct reason *reason)
{
    struct packed packed;
    enum status status = make_tree(scene, &packed, reason);
    if (status)
        return status;
    struct scene without = *scene; /* borrows the arrays */
    without.has_camera = false;
    struct camera own = scene_camera(scene), overview = scene_camera(&without);
    status = find_spots(&packed, scene, &own, count, ray, spot, spot_count, reason);
    if (!status && *spot_count == 0 && scene->has_camera)
        status = find_spots(&packed, scene, &overview, count, ray, spot, spot_count, reason);
    packed_free(&packed);
    if (!status && *spot_count == 0)
        return fail(reason, STATUS_INPUT,
                    "bounce: no camera ray hits the scene, so there is nothing to bounce from; "
                    "choose another ray set");
    return status;
}

static enum status make_bounce(const struct scene *scene, uint64_t seed, size_t count,
                               struct ray *out, struct reason *reason)
{
    if (count == 0)
        return STATUS_OK;
    if (scene->tri_count == 0)
        return ray_set_make(&ray_set_random, scene, ~seed, count, out, reason);
    enum status status = check_camera(scene, reason);
    if (status)
        return status;
    size_t primary_count = count < PRIMARY_LEAST ? PRIMARY_LEAST : count;
    primary_count = primary_count > PRIMARY_MOST ? PRIMARY_MOST : primary_count;
    size_t spot_count = 0;
    struct ray *ray = alloc_zeroed(primary_count, sizeof *ray);
    struct camera_spot *spot = alloc_zeroed(primary_count, sizeof *spot);
    if (ray && spot)
        status = spots_of_scene(scene, primary_count, ray, spot, &spot_count, reason);
    else
        status =
            fail(reason, STATUS_MEMORY, "bounce: no memory for %zu camera rays", primary_count);
    struct stage stage = stage_make(scene, seed, STAGE_BOUNCE);
    for (size_t i = 0; i < count && !status; i++) {
        /* Few rays are spread over all spots; many reuse the spots in turn. */
        size_t s = count < spot_count ? i * spot_count / count : i % spot_count;
        bounce_ray(&stage, &spot[s], i, &out[i]);
    }
    free(ray);
    free(spot);
    return status;
}

const struct ray_set ray_set_primary = {
    .name = "primary",
    .summary = "through the pixels of a square picture of the scene's camera; no seed",
    .all = make_primary,
    .seedless = true,
};
const struct ray_set ray_set_bounce = {
    .name = "bounce",
    .summary = "cosine-distributed from where camera rays hit, half of them lifted off the face",
    .all = make_bounce,
};
