/* A scene with its tree, ready for pictures. */
#include "cmd/render/cmd_render.h"

#include "scenes/scenes.h"
#include "scenes/worlds/placed_scene.h"

#include <stdio.h>
#include <string.h>

/* Opens the scene and checks its camera: a file can hold any. */
static enum status open_scene(const struct render_settings *settings, struct render_stage *stage,
                              struct reason *reason)
{
    uint64_t placed;
    enum status status =
        placed_scene_open(settings->scene, settings->seed, &stage->scene, &placed, reason);
    if (status)
        return status;
    if (placed > stage->scene.tri_count)
        fprintf(stderr, "raydiff: %s: %u of %llu placed triangles are drawn\n", settings->scene,
                stage->scene.tri_count, (unsigned long long)placed);
    stage->camera = camera_of_scene(&stage->scene, settings->framing, settings->look.profile,
                                    settings->width, settings->height);
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(stage->camera.pos[k]) || !float_is_finite(stage->camera.at[k]))
            return fail(reason, STATUS_INPUT, "%s: the camera's coordinate %c is not finite",
                        settings->scene, "xyz"[k]);
    if (settings->turn != RENDER_AS_SCENE)
        stage->camera.orbit = settings->turn == RENDER_ORBIT;
    stage->tri_count = stage->scene.tri_count;
    return STATUS_OK;
}

/* Returns whether a picture has any light. */
static bool is_lit(const struct look *look, const struct scene *scene)
{
    bool lit = look->camera_light > 0 || (look->ambience > 0 && look->profile == PROFILE_REPAIRED);
    for (uint32_t i = 0; i < scene->light_count; i++)
        lit = lit || scene->light[i].strength > 0;
    return lit;
}

/* Adds a light at the camera if the scene has none, unless the user set its strength. The published
 * profile stays black. */
static struct look look_with_light(const struct render_settings *settings,
                                   const struct scene *scene)
{
    struct look look = settings->look;
    if (!is_lit(&look, scene) && look.profile == PROFILE_REPAIRED &&
        !option_was_given("camera-light-strength"))
        look.camera_light = 1;
    return look;
}

static void say_light(const char *command, const struct render_settings *settings,
                      const struct render_stage *stage)
{
    if (!is_lit(&stage->job.look, &stage->scene))
        fprintf(stderr,
                "raydiff %s: warning: no light in the scene: the picture is black "
                "(--camera-light-strength 1)\n",
                command);
    else if (stage->job.look.camera_light != settings->look.camera_light)
        fprintf(stderr,
                "raydiff %s: no light in the scene: one of strength 1 stands at the eye "
                "(--camera-light-strength)\n",
                command);
}

static enum status pack_auto(struct render_stage *stage, struct reason *reason)
{
    char refused[1024] = "";
    if (tree_file_is_packed(&stage->file))
        return tree_file_pack(&stage->file, stage->file.packed.layout, &stage->scene,
                              &stage->packed, reason);
    return packed_make_auto(&stage->bvh, &stage->scene, &stage->packed, refused, sizeof refused,
                            reason);
}

enum status render_stage_pack(struct render_stage *stage, const struct layout *layout,
                              struct reason *reason)
{
    packed_free(&stage->packed);
    stage->job.job.packed = NULL;
    enum status status;
    if (tree_file_is_packed(&stage->file))
        status = tree_file_pack(&stage->file, layout, &stage->scene, &stage->packed, reason);
    else
        status = packed_make(layout, &stage->bvh, &stage->scene, &stage->packed, reason);
    if (!status)
        stage->job.job.packed = &stage->packed;
    return status;
}

/* Makes the tree if the engine needs one. A tree of --bvh is checked for all engines. */
static enum status make_tree(const char *command, const struct render_settings *settings,
                             struct render_stage *stage, struct reason *reason)
{
    if (!settings->bvh || stage->scene.tri_count != stage->tri_count)
        return settings->engine->needs_packed ? bvh_build(settings->builder, &stage->scene,
                                                          &settings->build, &stage->bvh, reason)
                                              : STATUS_OK;
    enum status status = tree_open(command, settings->bvh, &stage->scene, &stage->file, reason);
    if (status || tree_file_is_packed(&stage->file))
        return status;
    return tree_file_bvh(&stage->file, &stage->scene, &stage->bvh, reason);
}

static const struct layout *layout_of(const struct render_settings *settings,
                                      const struct render_stage *stage)
{
    if (settings->layout)
        return settings->layout;
    if (tree_file_is_packed(&stage->file))
        return stage->file.packed.layout;
    return layout_find(settings->handler->member[settings->look.profile].layout);
}

static enum status pack(const struct render_settings *settings, struct render_stage *stage,
                        struct reason *reason)
{
    enum status status;
    struct reason why;
    if (settings->layout_auto) {
        status = pack_auto(stage, reason);
        if (!status)
            stage->job.job.packed = &stage->packed;
        return status;
    }
    const struct layout *layout = layout_of(settings, stage);
    status = render_stage_pack(stage, layout, &why);
    if (status == STATUS_LIMIT)
        return fail(reason, status, "%s; --layout auto takes one that fits", why.text);
    return status ? fail(reason, status, "%s", why.text) : STATUS_OK;
}

static enum status make_job(const struct render_settings *settings, struct render_stage *stage,
                            struct reason *reason)
{
    struct look look = look_with_light(settings, &stage->scene);
    struct reason why;
    enum status status = shading_make(&stage->scene, &look, &stage->shading, &why);
    if (status)
        return fail(reason, status, "%s: %s", settings->scene, why.text);
    stage->job = (struct frame_job){
        .job = {.scene = &stage->scene, .box = settings->box, .tri = settings->tri},
        .look = look,
        .width = settings->width,
        .height = settings->height,
        .plan = settings->plan,
        .tile = settings->tile,
        .general = settings->general,
    };
    frame_job_fill(&stage->shading, &stage->camera, &stage->job);
    return STATUS_OK;
}

enum status render_stage_open(const char *command, const struct render_settings *settings,
                              struct render_stage *out, struct reason *reason)
{
    *out = (struct render_stage){.name = settings->scene};
    enum status status = open_scene(settings, out, reason);
    if (!status && strcmp(settings->handler->name, "blank") == 0)
        out->scene.tri_count = 0;
    if (!status)
        status = make_tree(command, settings, out, reason);
    if (!status)
        status = make_job(settings, out, reason);
    if (!status && settings->engine->needs_packed)
        status = pack(settings, out, reason);
    if (status)
        render_stage_close(out);
    else
        say_light(command, settings, out);
    return status;
}

struct view render_stage_view(const struct render_stage *stage, double angle)
{
    struct camera camera = camera_orbit(&stage->camera, angle);
    return camera_view(&camera, stage->job.look.profile, stage->job.width, stage->job.height);
}

void render_stage_close(struct render_stage *stage)
{
    shading_free(&stage->shading);
    packed_free(&stage->packed);
    bvh_free(&stage->bvh);
    tree_file_free(&stage->file);
    scene_free(&stage->scene);
    *stage = (struct render_stage){0};
}
