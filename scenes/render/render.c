#include "scenes/render/render.h"

#include "ref/engines/cpu_rays.h"
#include "scenes/render/shade.h"

#include <stdlib.h>
#include <string.h>

bool frame_make(size_t pixels, uint32_t bounces, struct frame *out)
{
    out->pixel = alloc_zeroed(pixels, sizeof *out->pixel);
    out->color = alloc_zeroed(pixels, 3 * sizeof *out->color);
    out->bound = alloc_zeroed(pixels, sizeof *out->bound);
    out->segment = alloc_zeroed(pixels, bounces * sizeof *out->segment);
    if (out->pixel && out->color && out->bound && out->segment)
        return true;
    frame_free(out);
    return false;
}

void frame_free(struct frame *frame)
{
    free(frame->pixel);
    free(frame->color);
    free(frame->bound);
    free(frame->segment);
    *frame = (struct frame){0};
}

/* Pixels traced together, in whole rows. A strip has at most this many and one row more. */
#define STRIP_PIXELS ((size_t)1 << 17)

struct renderer {
    const struct engine *engine;
    struct engine_options options;
    bool waves;
    unsigned threads;
    void *closest;
    void *any; /* opened by the first job with any-hit shadow rays; NULL before */
    struct frame_job job;
    bool ready; /* the last prepare succeeded */
    void (*step)(void *user, double share);
    void *user;
    size_t watched_rays;
};

/* The paths of a strip, and one wave of rays. Ray j belongs to path of[j]. */
struct strip {
    const struct frame_job *job;
    const struct view *view;
    size_t first, count; /* pixels */
    struct shade_path *path;
    uint32_t *live; /* paths that have not ended, in order */
    uint32_t *of;
    struct ray *ray;
    struct hit *hit;
    bool *keep; /* for the path at the same index of live */
    size_t live_count, ray_count;
    double done;       /* share of the picture before this wave */
    uint64_t bytes[2]; /* held by the instances for closest and any */
    unsigned threads;
};

static void strip_free(struct strip *strip)
{
    free(strip->path);
    free(strip->live);
    free(strip->of);
    free(strip->ray);
    free(strip->hit);
    free(strip->keep);
}

static enum status strip_make(const struct renderer *renderer, const struct view *view,
                              struct strip *out, struct reason *reason)
{
    const struct frame_job *job = &renderer->job;
    size_t rows = STRIP_PIXELS / job->width + 1;
    rows = rows < job->height ? rows : job->height;
    size_t most = rows * job->width;
    *out = (struct strip){.job = job, .view = view, .threads = renderer->threads};
    out->path = alloc_zeroed(most, sizeof *out->path);
    out->live = alloc_zeroed(most, sizeof *out->live);
    out->of = alloc_zeroed(most, sizeof *out->of);
    out->ray = alloc_zeroed(most, sizeof *out->ray);
    out->hit = alloc_zeroed(most, sizeof *out->hit);
    out->keep = alloc_zeroed(most, sizeof *out->keep);
    out->count = most;
    if (out->path && out->live && out->of && out->ray && out->hit && out->keep)
        return STATUS_OK;
    strip_free(out);
    return fail(reason, STATUS_MEMORY, "no memory for the rays of %zu pixels", most);
}

static void strip_begin(struct strip *strip, size_t first, bool bounded)
{
    size_t all = (size_t)strip->job->width * strip->job->height;
    strip->first = first;
    strip->live_count = strip->count < all - first ? strip->count : all - first;
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->live_count; j++) {
        size_t pixel = first + (size_t)j;
        strip->live[j] = (uint32_t)j;
        shade_begin(strip->job, strip->view, (uint32_t)(pixel % strip->job->width),
                    (uint32_t)(pixel / strip->job->width), &strip->path[j]);
        strip->path[j].bounded = bounded;
    }
}

/* Keeps the live paths with `keep`, in order whatever the number of threads. */
static void drop_ended(struct strip *strip)
{
    size_t kept = 0;
    for (size_t j = 0; j < strip->live_count; j++)
        if (strip->keep[j])
            strip->live[kept++] = strip->live[j];
    strip->live_count = kept;
}

/* Rays per engine call while renderer_watch is on; doubled after every call that took less than
 * WATCHED_NS. */
#define WATCHED_RAYS ((size_t)1 << 12)
#define WATCHED_NS   100000000u

/* Traces the wave's rays with an engine and adds the costs to *total. */
static enum status ask(struct renderer *renderer, void *self, struct strip *strip,
                       struct trace_report *total, struct reason *reason)
{
    for (size_t first = 0, count; first < strip->ray_count; first += count) {
        struct trace_report report = {0};
        count = strip->ray_count - first;
        if (renderer->step && count > renderer->watched_rays)
            count = renderer->watched_rays;
        enum status status = renderer->engine->trace(self, strip->ray + first, count,
                                                     strip->hit + first, &report, reason);
        total->ns += report.ns;
        total->device_clock = total->device_clock && report.device_clock;
        total->boxes += report.boxes;
        total->tris += report.tris;
        total->flags |= report.flags;
        uint64_t *bytes = &strip->bytes[self == renderer->any];
        *bytes = *bytes > report.memory_bytes ? *bytes : report.memory_bytes;
        total->memory_bytes = strip->bytes[0] + strip->bytes[1];
        if (status)
            return status;
        if (renderer->step)
            renderer->step(renderer->user, strip->done);
        if (report.ns < WATCHED_NS && renderer->watched_rays < STRIP_PIXELS)
            renderer->watched_rays *= 2;
    }
    return STATUS_OK;
}

/* Traces the next segment of every live path; clears `keep` of those that miss. */
static enum status wave_closest(struct renderer *renderer, struct strip *strip,
                                struct trace_report *report, struct reason *reason)
{
    strip->ray_count = strip->live_count;
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->live_count; j++)
        strip->ray[j] = shade_ray(strip->job, &strip->path[strip->live[j]]);
    enum status status = ask(renderer, renderer->closest, strip, report, reason);
    if (status)
        return status;
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->live_count; j++)
        strip->keep[j] = shade_hit(strip->job, &strip->hit[j], &strip->path[strip->live[j]]);
    return STATUS_OK;
}

/* Traces a shadow ray to the light from every path that needs one. */
static enum status wave_light(struct renderer *renderer, struct strip *strip, uint32_t light,
                              struct trace_report *report, struct reason *reason)
{
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->live_count; j++)
        strip->keep[j] =
            shade_ask(strip->job, strip->view, light, &strip->path[strip->live[j]], &strip->ray[j]);
    strip->ray_count = 0;
    for (size_t j = 0; j < strip->live_count; j++)
        if (strip->keep[j]) {
            strip->of[strip->ray_count] = strip->live[j];
            strip->ray[strip->ray_count++] = strip->ray[j];
        }
    bool any = strip->job->look.profile == PROFILE_REPAIRED;
    enum status status =
        ask(renderer, any ? renderer->any : renderer->closest, strip, report, reason);
    if (status)
        return status;
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->ray_count; j++)
        shade_answer(strip->job, light, &strip->hit[j], &strip->path[strip->of[j]]);
    return STATUS_OK;
}

/* Stores segments in row order. Those after a path's end stay ABI_NO_SEGMENT. */
static void store_segments(const struct strip *strip, uint32_t index, struct frame *out)
{
    uint32_t bounces = strip->job->look.bounces;
    for (size_t j = 0; j < strip->live_count && out->segment; j++)
        out->segment[(strip->first + strip->live[j]) * bounces + index] =
            strip->path[strip->live[j]].segment;
}

static enum status strip_segment(struct renderer *renderer, struct strip *strip, uint32_t index,
                                 struct frame *out, struct trace_report *report,
                                 struct reason *reason)
{
    enum status status = wave_closest(renderer, strip, report, reason);
    if (status)
        return status;
    store_segments(strip, index, out); /* of the paths that end here */
    drop_ended(strip);
    for (uint32_t light = 0; light < strip->job->light_count && !status; light++)
        status = wave_light(renderer, strip, light, report, reason);
    if (status)
        return status;
    store_segments(strip, index, out);
#pragma omp parallel for num_threads(strip->threads)
    for (long long j = 0; j < (long long)strip->live_count; j++)
        strip->keep[j] = shade_next(strip->job, index, &strip->path[strip->live[j]]);
    drop_ended(strip);
    return STATUS_OK;
}

void frame_store(struct frame *frame, size_t pixel, const struct shade_path *path)
{
    frame->pixel[pixel] = shade_pixel(path->total);
    if (frame->color)
        memcpy(frame->color + 3 * pixel, &path->total, 3 * sizeof(float));
    if (frame->bound)
        frame->bound[pixel] = shade_bound(path);
}

static enum status frame_by_waves(struct renderer *renderer, const struct view *view,
                                  struct frame *out, struct trace_report *report,
                                  struct reason *reason)
{
    const struct frame_job *job = &renderer->job;
    size_t all = (size_t)job->width * job->height;
    struct strip strip;
    enum status status = strip_make(renderer, view, &strip, reason);
    if (status)
        return status;
    for (size_t i = 0; out->segment && i < all * job->look.bounces; i++)
        out->segment[i] = (struct segment){.prim = ABI_NO_SEGMENT};
    report->device_clock = true;
    for (size_t first = 0; first < all && !status; first += strip.count) {
        strip_begin(&strip, first, out->bound != NULL);
        size_t count = strip.live_count;
        for (uint32_t i = 0; i < job->look.bounces && strip.live_count > 0 && !status; i++) {
            double done = (double)i / job->look.bounces;
            strip.done = ((double)first + done * (double)count) / (double)all;
            status = strip_segment(renderer, &strip, i, out, report, reason);
        }
        for (size_t j = 0; j < count; j++)
            frame_store(out, first + j, &strip.path[j]);
    }
    strip_free(&strip);
    return status;
}

enum status renderer_open(const struct engine *engine, const struct engine_options *options,
                          bool waves, struct renderer **out, struct reason *reason)
{
    *out = NULL;
    if (engine->recorded)
        return fail(reason, STATUS_UNSUPPORTED,
                    "%s: its answers are recorded: it cannot trace new rays", engine->name);
    struct renderer *made = alloc_zeroed(1, sizeof *made);
    if (!made)
        return fail(reason, STATUS_MEMORY, "no memory for a renderer");
    made->engine = engine;
    made->options = *options;
    made->waves = waves || !engine->renderer;
    made->threads = cpu_rays_threads(options);
    made->watched_rays = WATCHED_RAYS;
    enum status status = engine_open(engine, options, &made->closest, reason);
    if (status)
        free(made);
    else
        *out = made;
    return status;
}

static enum status check_job(const struct renderer *renderer, const struct frame_job *job,
                             struct reason *reason)
{
    const struct look *look = &job->look;
    if (job->width < 1 || job->width > FRAME_SIDE_MOST || job->height < 1 ||
        job->height > FRAME_SIDE_MOST)
        return fail(reason, STATUS_INPUT, "a picture of %u x %u pixels: 1 to %u each", job->width,
                    job->height, FRAME_SIDE_MOST);
    if (look->bounces > FRAME_BOUNCES_MOST)
        return fail(reason, STATUS_INPUT, "%u bounces: 0 to %u", look->bounces, FRAME_BOUNCES_MOST);
    if (!(look->ambience >= 0 && float_is_finite(look->ambience)) ||
        !(look->camera_light >= 0 && float_is_finite(look->camera_light)))
        return fail(reason, STATUS_INPUT, "ambience %g, light of the eye %g: 0 or more",
                    (double)look->ambience, (double)look->camera_light);
    if (job->light_count > ABI_LIGHTS_MOST || job->material_count < 1 ||
        job->tile > FRAME_TILE_MOST)
        return fail(reason, STATUS_INPUT,
                    "%u lights (0 to %u), %u materials (1 or more), tile of %u pixels (0 to %u)",
                    job->light_count, ABI_LIGHTS_MOST, job->material_count, job->tile,
                    FRAME_TILE_MOST);
    if (renderer->engine->needs_packed && !job->job.packed)
        return fail(reason, STATUS_INPUT, "engine %s needs a packed tree", renderer->engine->name);
    return STATUS_OK;
}

enum status renderer_prepare(struct renderer *renderer, const struct frame_job *job,
                             struct reason *reason)
{
    const struct engine *engine = renderer->engine;
    renderer->ready = false;
    enum status status = check_job(renderer, job, reason);
    if (status)
        return status;
    renderer->job = *job;
    if (!renderer->waves) {
        status = engine->renderer->prepare(renderer->closest, job, reason);
        renderer->ready = !status;
        return status;
    }
    struct job rays = job->job;
    rays.query = QUERY_CLOSEST;
    status = engine->prepare(renderer->closest, &rays, reason);
    bool any = job->look.profile == PROFILE_REPAIRED && job->light_count > 0;
    if (!status && any && !renderer->any)
        status = engine_open(engine, &renderer->options, &renderer->any, reason);
    rays.query = QUERY_ANY;
    if (!status && any)
        status = engine->prepare(renderer->any, &rays, reason);
    renderer->ready = !status;
    return status;
}

enum status renderer_frame(struct renderer *renderer, const struct view *view, struct frame *out,
                           struct trace_report *report, struct reason *reason)
{
    struct trace_report unread;
    report = report ? report : &unread;
    *report = (struct trace_report){0};
    if (!renderer->ready)
        return fail(reason, STATUS_INPUT, "engine %s: no picture was prepared",
                    renderer->engine->name);
    if (renderer->waves)
        return frame_by_waves(renderer, view, out, report, reason);
    return renderer->engine->renderer->draw(renderer->closest, view, out, report, reason);
}

bool renderer_by_waves(const struct renderer *renderer)
{
    return renderer->waves;
}

enum status renderer_ask(struct renderer *renderer, enum query query, const struct ray *ray,
                         size_t ray_count, struct hit *hit, struct reason *reason)
{
    struct trace_report report;
    void *self = query == QUERY_ANY ? renderer->any : renderer->closest;
    if (!renderer->ready || !renderer->waves || !self || query == QUERY_ALL)
        return fail(reason, STATUS_INPUT, "engine %s: not prepared for rays of query %s",
                    renderer->engine->name, query_name(query));
    return renderer->engine->trace(self, ray, ray_count, hit, &report, reason);
}

struct model renderer_model(struct renderer *renderer, const struct tri_test *tri)
{
    return engine_model(renderer->engine, renderer->closest, tri);
}

void renderer_watch(struct renderer *renderer, void (*step)(void *user, double share), void *user)
{
    renderer->step = step;
    renderer->user = user;
}

void renderer_close(struct renderer *renderer)
{
    if (!renderer)
        return;
    renderer->engine->close(renderer->closest);
    if (renderer->any)
        renderer->engine->close(renderer->any);
    free(renderer);
}
