/* The dispatches of a slab: whole paths, or their steps one after the other. */
#include "gpu/frame/framer_private.h"

#include <stdlib.h>

/* Submissions double while they are quick and halve when they are slow, so that neither the wait
 * nor a driver's watchdog ends a frame. */
#define QUICK_NS 100000000u
#define SLOW_NS  1000000000u

/* A series of dispatches. It is submitted when it is full or complete. */
struct series {
    struct framer *framer;
    struct vk_pipeline *pipeline;
    struct frame_push next; /* of the next dispatch */
    uint32_t groups, count;
    struct vk_time time; /* of the submissions so far */
    struct vk_step step[VK_SERIES_MAX];
    struct frame_push push[VK_SERIES_MAX];
    uint32_t head[ABI_STATE_HEAD][4]; /* of the state buffer: no path has a ray yet */
};

_Static_assert(sizeof(uint32_t[ABI_STATE_HEAD][4]) <= VK_UPDATE_MAX, "the head is written at once");
_Static_assert(FRAME_BOUNCES_MOST *(1 + ABI_LIGHTS_MOST) == ABI_RAYS_MOST, "rays of a path");

static enum status series_submit(struct series *s, struct reason *reason)
{
    struct vk_time time;
    enum status status =
        vk_dispatch_series(s->framer->vk, s->framer->buffer, s->step, s->count, &time, reason);
    s->count = 0;
    s->time.ns += time.ns;
    s->time.device_clock = s->time.device_clock && time.device_clock;
    return status;
}

static enum status series_add(struct series *s, struct reason *reason)
{
    s->push[s->count] = s->next;
    struct vk_step *step = &s->step[s->count];
    *step =
        (struct vk_step){.pipeline = s->pipeline, .push = &s->push[s->count], .groups = s->groups};
    if (s->framer->dispatch.plan == FRAME_STEPS && s->next.ray > 0) {
        step->groups_of = s->framer->buffer[ABI_BIND_STATE];
        step->groups_at = s->next.ray * sizeof s->head[0];
    } else if (s->framer->dispatch.plan == FRAME_STEPS && s->next.part_first == 0) {
        step->update = s->framer->buffer[ABI_BIND_STATE];
        step->bytes = s->head;
        step->byte_count = (s->framer->dispatch.rays + 1) * (uint32_t)sizeof s->head[0];
    }
    s->count++;
    return s->count == VK_SERIES_MAX ? series_submit(s, reason) : STATUS_OK;
}

/* Draws the tiles by whole paths, or by one ray of each path after the other; in both cases with
 * the triangles in parts. */
static enum status draw_tiles(struct series *s, struct reason *reason)
{
    const struct frame_dispatch *dispatch = &s->framer->dispatch;
    const bool whole = dispatch->plan == FRAME_WHOLE;
    const uint32_t tri_count = s->next.tri_count;
    const uint32_t part = whole ? UINT32_MAX : dispatch->part, rays = whole ? 1 : dispatch->rays;
    enum status status = STATUS_OK;
    for (s->next.ray = 0; s->next.ray < rays && !status; s->next.ray++) {
        s->next.part_last = 0;
        do {
            s->next.part_first = s->next.part_last;
            const uint32_t left = tri_count - s->next.part_first;
            s->next.part_last = left > part ? s->next.part_first + part : tri_count;
            status = series_add(s, reason);
        } while (!status && s->next.part_last < tri_count);
    }
    return status || s->count == 0 ? status : series_submit(s, reason);
}

enum status framer_slab(struct framer *framer, const struct frame_dispatch *dispatch,
                        const struct slab *slab, struct trace_report *report, struct reason *reason)
{
    const uint32_t most = vk_limits(framer->vk)->groups, tile = dispatch->tile;
    const uint32_t tiles = (framer->job.width + tile - 1) / tile * ((slab->rows + tile - 1) / tile);
    struct series *s = alloc_zeroed(1, sizeof *s);
    if (!s)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a series of dispatches");
    const struct vk_shader shader = frame_dispatch_shader(dispatch);
    s->framer = framer;
    for (uint32_t i = 0; i < ABI_STATE_HEAD; i++)
        s->head[i][1] = s->head[i][2] = 1;
    enum status status =
        pipelines_find(&framer->pipelines, framer->vk, &shader, &s->pipeline, reason);
    for (uint32_t done = 0; done < tiles && !status;) {
        const uint32_t batch = framer->batch < most ? framer->batch : most;
        const uint32_t left = tiles - done;
        s->next = dispatch->push;
        s->next.first_row = slab->first_row;
        s->next.first_tile = done;
        s->groups = left < batch ? left : batch;
        s->time = (struct vk_time){.device_clock = true};
        status = draw_tiles(s, reason);
        report->ns += s->time.ns;
        report->device_clock = report->device_clock && s->time.device_clock;
        if (s->groups == framer->batch && s->time.ns < QUICK_NS)
            framer->batch *= 2;
        else if (s->time.ns > SLOW_NS && framer->batch > 1)
            framer->batch /= 2;
        done += s->groups;
    }
    free(s);
    return status;
}
