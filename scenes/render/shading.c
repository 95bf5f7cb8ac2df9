#include "ref/base/double3.h"
#include "scenes/read/formats.h"
#include "scenes/read/normals.h"
#include "scenes/rays/rays.h"
#include "scenes/render/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status check_finite(const char *kind, uint32_t i, const char *what, const float *value,
                                int count, bool negative, struct reason *reason)
{
    for (int k = 0; k < count; k++) {
        if (!float_is_finite(value[k]))
            return fail(reason, STATUS_INPUT, "%s %u: %s is not finite", kind, i, what);
        if (!negative && value[k] < 0)
            return fail(reason, STATUS_INPUT, "%s %u: %s is %g, below 0", kind, i, what,
                        (double)value[k]);
    }
    return STATUS_OK;
}

static enum status make_materials(const struct scene *scene, struct shading *out,
                                  struct reason *reason)
{
    out->material_count = scene->material_count ? scene->material_count : 1;
    out->material = alloc_zeroed(out->material_count, sizeof *out->material);
    if (!out->material)
        return fail(reason, STATUS_MEMORY, "no memory for %u materials", out->material_count);
    for (uint32_t i = 0; i < out->material_count; i++) {
        const struct material *from = scene->material_count ? &scene->material[i] : &rtrs_red;
        enum status status = check_finite("material", i, "color", from->color, 3, false, reason);
        if (!status)
            status = check_finite("material", i, "albedo", from->albedo, 3, false, reason);
        if (!status)
            status = check_finite("material", i, "spec", &from->spec, 1, true, reason);
        if (status)
            return status;
        struct shade_material *to = &out->material[i];
        memcpy(to->color, from->color, sizeof to->color);
        to->spec = from->spec;
        to->diffuse = from->albedo[0];
        to->specular = from->albedo[1];
        to->reflective = from->albedo[2];
    }
    return STATUS_OK;
}

static enum status make_lights(const struct scene *scene, const struct look *look,
                               struct shading *out, struct reason *reason)
{
    out->light = alloc_zeroed(ABI_LIGHTS_MOST, sizeof *out->light);
    if (!out->light)
        return fail(reason, STATUS_MEMORY, "no memory for lights");
    if (look->camera_light > 0)
        out->light[out->light_count++].strength = look->camera_light;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light *light = &scene->light[i];
        enum status status = check_finite("light", i, "position", light->pos, 3, true, reason);
        if (!status)
            status = check_finite("light", i, "strength", &light->strength, 1, false, reason);
        if (status)
            return status;
        if (light->strength == 0)
            continue;
        if (out->light_count == ABI_LIGHTS_MOST)
            return fail(reason, STATUS_LIMIT,
                        "the scene has more than %u lights of strength above 0, the eye's included",
                        ABI_LIGHTS_MOST);
        struct shade_light *to = &out->light[out->light_count++];
        memcpy(to->pos, light->pos, sizeof to->pos);
        to->strength = light->strength;
    }
    return STATUS_OK;
}

/* The unit normal of a triangle's plane, or zero. Computed in double, which no scene overflows. */
static void make_plane(const struct scene *scene, uint32_t prim, float out[3])
{
    float v[3][3];
    double e1[3], e2[3], n[3];
    scene_tri(scene, prim, v);
    double3_sub(v[1], v[0], e1);
    double3_sub(v[2], v[0], e2);
    double3_cross(e1, e2, n);
    bool area = double3_unit(n);
    for (int k = 0; k < 3; k++)
        out[k] = area ? (float)n[k] : 0.0f;
}

/* The normal of a corner: unchanged in PROFILE_RTRS, else normalised. */
static enum status make_normal(const float *normal, uint32_t vertex, enum profile profile,
                               float out[3], struct reason *reason)
{
    const float *n = normal + 3 * (size_t)vertex;
    enum status status = check_finite("vertex", vertex, "normal", n, 3, true, reason);
    if (status)
        return status;
    double length = 1;
    if (profile == PROFILE_REPAIRED)
        length = sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] +
                      (double)n[2] * (double)n[2]);
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? (float)((double)n[k] / length) : 0.0f;
    return STATUS_OK;
}

static enum status make_tri(const struct scene *scene, const float *normal, enum profile profile,
                            uint32_t prim, struct shading *out, struct reason *reason)
{
    struct shade_tri *tri = &out->tri[prim];
    const uint32_t *index = scene->index + 3 * (size_t)prim;
    int32_t material = scene->material_of ? scene->material_of[prim] : 0;
    if (material < 0 || (uint32_t)material >= out->material_count)
        return fail(reason, STATUS_INPUT, "triangle %u: material %d, but the scene has %u%s", prim,
                    (int)material, scene->material_count,
                    scene->material_count ? "" : " (and the default one, 0)");
    tri->material = (uint32_t)material;
    make_plane(scene, prim, tri->plane);
    enum status status = make_normal(normal, index[0], profile, tri->na, reason);
    if (!status)
        status = make_normal(normal, index[1], profile, tri->nb, reason);
    if (!status)
        status = make_normal(normal, index[2], profile, tri->nc, reason);
    return status;
}

static enum status make_tris(const struct scene *scene, enum profile profile, struct shading *out,
                             struct reason *reason)
{
    float *own = scene->normal ? NULL : scene_normals(scene);
    const float *normal = scene->normal ? scene->normal : own;
    out->tri = alloc_zeroed(scene->tri_count, sizeof *out->tri);
    enum status status = STATUS_OK;
    if (!normal || !out->tri)
        status =
            fail(reason, STATUS_MEMORY, "no memory for shading %u triangles", scene->tri_count);
    for (uint32_t i = 0; i < scene->tri_count && !status; i++)
        status = make_tri(scene, normal, profile, i, out, reason);
    free(own);
    return status;
}

enum status shading_make(const struct scene *scene, const struct look *look, struct shading *out,
                         struct reason *reason)
{
    *out = (struct shading){0};
    enum status status = make_materials(scene, out, reason);
    if (!status)
        status = make_tris(scene, look->profile, out, reason);
    if (!status)
        status = make_lights(scene, look, out, reason);
    if (status)
        shading_free(out);
    return status;
}

void shading_free(struct shading *shading)
{
    free(shading->tri);
    free(shading->material);
    free(shading->light);
    *shading = (struct shading){0};
}

/* Scale of the rounding errors of hit points. */
static float largest_coordinate(const struct scene *scene, const struct camera *camera)
{
    struct box box = scene_bounds(scene);
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        if (scene->tri_count > 0)
            largest = fmaxf(largest, fmaxf(fabsf(box.lo[k]), fabsf(box.hi[k])));
        largest = fmaxf(largest, fabsf(camera->pos[k]));
    }
    return largest;
}

void frame_job_fill(const struct shading *shading, const struct camera *camera,
                    struct frame_job *job)
{
    job->shade = shading->tri;
    job->material = shading->material;
    job->material_count = shading->material_count;
    job->light = shading->light;
    job->light_count = shading->light_count;
    if (job->look.profile == PROFILE_RTRS) {
        job->tmin = 0.01f;
        job->tmax = 1000;
        job->offset = 0.001f;
        return;
    }
    job->tmin = 0;
    job->tmax = RAY_TMAX;
    job->offset = 0x1p-17f * largest_coordinate(job->job.scene, camera);
}
