#include "bench/frames/painter.h"

#include "scenes/render/diff_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status pack(struct painter *painter, struct reason *reason)
{
    const struct painter_plan *plan = &painter->plan;
    const struct scene *scene = plan->blank ? &painter->empty : painter->scene;
    struct bvh built = {0};
    if (!plan->layout)
        return STATUS_OK;
    enum status status = STATUS_OK;
    bool given = plan->tree && !plan->blank;
    if (!given)
        status = bvh_build(plan->builder, scene, &plan->build, &built, reason);
    const struct bvh *bvh = given ? plan->tree : &built;
    if (!status)
        status = packed_make(plan->layout, bvh, scene, &painter->packed, reason);
    if (!status)
        status = bvh_count(bvh, scene, &painter->tree, reason);
    bvh_free(&built);
    return status;
}

static enum status prepare(struct painter *painter, struct reason *reason)
{
    const struct painter_plan *plan = &painter->plan;
    const struct scene *scene = plan->blank ? &painter->empty : painter->scene;
    struct frame_job job = {.job = {.scene = scene,
                                    .packed = plan->layout ? &painter->packed : NULL,
                                    .box = plan->box,
                                    .tri = plan->tri},
                            .look = plan->look,
                            .width = plan->width,
                            .height = plan->height,
                            .plan = plan->plan,
                            .tile = plan->tile,
                            .general = plan->general};
    enum status status = shading_make(scene, &plan->look, &painter->shading, reason);
    if (status)
        return status;
    frame_job_fill(&painter->shading, &painter->camera, &job);
    return renderer_prepare(painter->renderer, &job, reason);
}

enum status painter_open(const struct painter_plan *plan, const struct scene *scene,
                         const struct engine_options *options, struct painter *out,
                         struct reason *reason)
{
    *out = (struct painter){.plan = *plan, .scene = scene, .camera = scene_camera(scene)};
    out->by_waves = plan->waves || !plan->engine->renderer;
    enum status status = STATUS_OK;
    if (plan->blank)
        status = scene_make(0, 0, &out->empty);
    if (!status)
        status = pack(out, reason);
    if (!status)
        status = renderer_open(plan->engine, options, plan->waves, &out->renderer, reason);
    if (!status)
        status = prepare(out, reason);
    if (!status) {
        out->pixel = alloc_zeroed((size_t)plan->width * plan->height, sizeof *out->pixel);
        status = out->pixel ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a picture");
    }
    if (status)
        painter_close(out);
    return status;
}

uint64_t painter_bytes(const struct painter *painter)
{
    return packed_node_bytes(&painter->packed) + packed_item_bytes(&painter->packed);
}

static enum status draw(struct painter *painter, double angle, struct frame *frame,
                        struct frames_sample *out, struct reason *reason)
{
    const struct painter_plan *plan = &painter->plan;
    struct camera camera = camera_orbit(&painter->camera, angle);
    struct view view = camera_view(&camera, plan->look.profile, plan->width, plan->height);
    struct trace_report report = {0};
    enum status status = renderer_frame(painter->renderer, &view, frame, &report, reason);
    *out =
        (struct frames_sample){.ms = 1e-6 * (double)report.ns, .device_clock = report.device_clock};
    return status;
}

enum status painter_draw(struct painter *painter, double angle, struct frames_sample *out,
                         struct reason *reason)
{
    struct frame frame = {.pixel = painter->pixel};
    return draw(painter, angle, &frame, out, reason);
}

enum status sheet_make(const struct painter_plan *plan, struct sheet *out, struct reason *reason)
{
    size_t pixels = (size_t)plan->width * plan->height;
    *out =
        (struct sheet){.width = plan->width, .height = plan->height, .bounces = plan->look.bounces};
    if (frame_make(pixels, out->bounces, &out->frame))
        return STATUS_OK;
    return fail(reason, STATUS_MEMORY, "no memory for a frame of %zu pixels", pixels);
}

void sheet_free(struct sheet *sheet)
{
    frame_free(&sheet->frame);
    *sheet = (struct sheet){0};
}

enum status painter_sheet(struct painter *painter, double angle, struct sheet *sheet,
                          struct frames_sample *out, struct reason *reason)
{
    for (size_t i = 0; i < (size_t)sheet->width * sheet->height; i++)
        sheet->frame.bound[i] = NAN;
    return draw(painter, angle, &sheet->frame, out, reason);
}

size_t sheet_pixels_apart(const struct sheet *a, const struct sheet *b)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)a->width * a->height; i++)
        count += a->frame.pixel[i] != b->frame.pixel[i];
    return count;
}

bool sheet_equal(const struct sheet *a, const struct sheet *b)
{
    size_t pixels = (size_t)a->width * a->height;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t segment;
        if (path_first(a->frame.segment + i * a->bounces, b->frame.segment + i * b->bounces,
                       a->bounces, &segment) != PATH_SAME)
            return false;
    }
    return memcmp(a->frame.pixel, b->frame.pixel, pixels * sizeof *a->frame.pixel) == 0 &&
           memcmp(a->frame.color, b->frame.color, 3 * pixels * sizeof *a->frame.color) == 0;
}

void painter_close(struct painter *painter)
{
    renderer_close(painter->renderer);
    shading_free(&painter->shading);
    packed_free(&painter->packed);
    scene_free(&painter->empty);
    free(painter->pixel);
    memset(painter, 0, sizeof *painter);
}
