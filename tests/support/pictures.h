/* What the tests of pictures share: a scene with its tree, shading and job. Include after
 * cmocka.h. */
#ifndef TESTS_PICTURES_H
#define TESTS_PICTURES_H

#include "scenes/render/camera.h"
#include "scenes/render/render.h"
#include "scenes/scenes.h"

#include <stdlib.h>

/* A picture to be taken; owns everything. */
struct picture {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct shading shading;
    struct frame_job job;
    struct view view;
    struct frame frame;
    struct trace_report report;
};

/* `rtrs`: RTRS's tree, layout and tests, which lose triangles. */
static inline struct picture picture_of(struct scene scene, struct look look, bool rtrs,
                                        uint32_t width, uint32_t height)
{
    struct reason reason = {""};
    struct picture p = {.scene = scene};
    const struct build_options build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    const struct builder *builder = builder_find(rtrs ? "rtrs" : "median");
    if (builder->build(&p.scene, &build, &p.bvh, &reason) ||
        packed_make(layout_find(rtrs ? "rtrs_direct" : "f32"), &p.bvh, &p.scene, &p.packed,
                    &reason) ||
        shading_make(&p.scene, &look, &p.shading, &reason))
        fail_msg("%s", reason.text);
    p.job = (struct frame_job){
        .job = {.packed = &p.packed,
                .box = box_test_find(rtrs ? "rtrs" : "robust"),
                .tri = tri_test_find(rtrs ? "mt_rtrs" : "mt")},
        .look = look,
        .width = width,
        .height = height,
    };
    struct camera camera = scene_camera(&p.scene);
    p.job.job.scene = &p.scene;
    frame_job_fill(&p.shading, &camera, &p.job);
    p.view = camera_view(&camera, look.profile, width, height);
    if (!frame_make((size_t)width * height, look.bounces, &p.frame))
        fail_msg("no memory");
    return p;
}

/* A camera of the scene's own goes to a share of its distance. */
static inline void picture_nearer(struct scene *scene, float share)
{
    struct camera *camera = &scene->camera;
    *camera = scene_camera(scene);
    scene->has_camera = true;
    for (int k = 0; k < 3; k++)
        camera->pos[k] = camera->at[k] + share * (camera->pos[k] - camera->at[k]);
}

/* With the members of the look's profile. */
static inline struct picture picture_make(const char *spec, struct look look, uint32_t width,
                                          uint32_t height)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return picture_of(scene, look, look.profile == PROFILE_RTRS, width, height);
}

/* The struct moved: its job points into it. */
static inline void picture_settle(struct picture *p)
{
    p->job.job.scene = &p->scene;
    p->job.job.packed = &p->packed;
}

/* False: the engine cannot run here. */
static inline bool picture_draw(struct picture *p, const char *engine, uint32_t threads, bool waves,
                                struct frame *frame)
{
    struct renderer *renderer;
    struct reason reason = {""};
    const struct engine_options options = {.threads = threads, .device = -1};
    picture_settle(p);
    enum status status = renderer_open(engine_find(engine), &options, waves, &renderer, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        return false;
    }
    if (status || (status = renderer_prepare(renderer, &p->job, &reason)) ||
        (status = renderer_frame(renderer, &p->view, frame, &p->report, &reason)))
        fail_msg("%s: %s", engine, reason.text);
    renderer_close(renderer);
    return true;
}

static inline void picture_free(struct picture *p)
{
    frame_free(&p->frame);
    shading_free(&p->shading);
    packed_free(&p->packed);
    bvh_free(&p->bvh);
    scene_free(&p->scene);
}

/* A scene from arrays: `tri_count` triangles of three corners each, every material its own. */
static inline struct scene picture_scene(const float (*corner)[3], uint32_t tri_count,
                                         const struct material *material, const struct light *light,
                                         uint32_t light_count, struct camera camera)
{
    struct scene scene;
    if (scene_make(3 * tri_count, tri_count, &scene))
        fail_msg("no memory");
    memcpy(scene.vertex, corner, 9 * sizeof(float) * (size_t)tri_count);
    scene.material = alloc_zeroed(tri_count, sizeof *scene.material);
    scene.material_of = alloc_zeroed(tri_count, sizeof *scene.material_of);
    scene.light = alloc_zeroed(light_count, sizeof *scene.light);
    if (!scene.material || !scene.material_of || !scene.light)
        fail_msg("no memory");
    memcpy(scene.material, material, tri_count * sizeof *material);
    memcpy(scene.light, light, light_count * sizeof *light);
    for (uint32_t i = 0; i < 3 * tri_count; i++)
        scene.index[i] = i;
    for (uint32_t i = 0; i < tri_count; i++)
        scene.material_of[i] = (int32_t)i;
    scene.material_count = tri_count;
    scene.light_count = light_count;
    scene.camera = camera;
    scene.has_camera = true;
    return scene;
}

#endif
