#include "scenes/render/diff_walk.h"

#include "scenes/render/render.h"

#include <stdlib.h>

/* One wave: a ray of each path that has one. */
struct wave {
    const struct frame_job *job;
    const struct view *view;
    walk_ask_fn *ask;
    void *user;
    struct shade_path *path; /* one per pixel */
    bool *live;
    size_t *of; /* ray j belongs to path of[j] */
    struct ray *ray;
    struct hit *hit;
    size_t count;
};

void walk_free(struct diff_walk *walk)
{
    free(walk->length);
    free(walk->step);
    free(walk->light);
    frame_free(&walk->frame);
    *walk = (struct diff_walk){0};
}

static void wave_free(struct wave *wave)
{
    free(wave->path);
    free(wave->live);
    free(wave->of);
    free(wave->ray);
    free(wave->hit);
}

size_t walk_bytes(const struct frame_job *job)
{
    size_t step = sizeof(struct walk_step) + job->light_count * sizeof(struct walk_light);
    return sizeof(struct shade_path) + sizeof(struct ray) + sizeof(struct hit) + 32 +
           job->look.bounces * step;
}

static enum status make_room(const struct frame_job *job, size_t count, struct diff_walk *walk,
                             struct wave *wave)
{
    size_t steps = count * job->look.bounces;
    walk->length = alloc_zeroed(count, sizeof *walk->length);
    walk->step = alloc_zeroed(steps, sizeof *walk->step);
    walk->light = alloc_zeroed(steps, job->light_count * sizeof *walk->light);
    wave->path = alloc_zeroed(count, sizeof *wave->path);
    wave->live = alloc_zeroed(count, sizeof *wave->live);
    wave->of = alloc_zeroed(count, sizeof *wave->of);
    wave->ray = alloc_zeroed(count, sizeof *wave->ray);
    wave->hit = alloc_zeroed(count, sizeof *wave->hit);
    bool all = frame_make(count, 0, &walk->frame) && walk->length && walk->step && walk->light &&
               wave->path && wave->live && wave->of && wave->ray && wave->hit;
    return all ? STATUS_OK : STATUS_MEMORY;
}

static void add_ray(struct wave *wave, size_t path, const struct ray *ray)
{
    wave->of[wave->count] = path;
    wave->ray[wave->count++] = *ray;
}

static enum status ask(struct wave *wave, enum query query, struct reason *reason)
{
    if (wave->count == 0)
        return STATUS_OK;
    return wave->ask(wave->user, query, wave->ray, wave->count, wave->hit, reason);
}

/* Traces segment `index` of all live paths for closest hits. */
static enum status walk_hits(struct diff_walk *walk, struct wave *wave, uint32_t index,
                             struct reason *reason)
{
    wave->count = 0;
    for (size_t i = 0; i < walk->count; i++)
        if (wave->live[i]) {
            struct ray ray = shade_ray(wave->job, &wave->path[i]);
            add_ray(wave, i, &ray);
        }
    enum status status = ask(wave, QUERY_CLOSEST, reason);
    for (size_t j = 0; j < wave->count && !status; j++) {
        size_t i = wave->of[j];
        struct shade_path *path = &wave->path[i];
        struct walk_step *step = walk_step_of(walk, i, index);
        float weight = path->weight;
        walk->length[i] = index + 1;
        wave->live[i] = shade_hit(wave->job, &wave->hit[j], path);
        *step = (struct walk_step){.ray = wave->ray[j],
                                   .hit = wave->hit[j],
                                   .weight = weight,
                                   .total = path->total,
                                   .segment = path->segment};
        if (wave->live[i])
            step->p = path->p, step->n = path->n, step->g = path->g;
    }
    return status;
}

static enum status walk_shadows(struct diff_walk *walk, struct wave *wave, uint32_t index,
                                uint32_t light, struct reason *reason)
{
    wave->count = 0;
    for (size_t i = 0; i < walk->count; i++) {
        struct walk_light *at = walk_light_of(walk, i, index, light);
        if (!wave->live[i])
            continue;
        at->asked = shade_ask(wave->job, wave->view, light, &wave->path[i], &at->ray);
        at->nl = wave->path[i].nl;
        at->rv = wave->path[i].rv;
        at->far = wave->path[i].far;
        if (at->asked)
            add_ray(wave, i, &at->ray);
    }
    enum status status = ask(wave, walk->shadow_query, reason);
    for (size_t j = 0; j < wave->count && !status; j++) {
        size_t i = wave->of[j];
        struct walk_light *at = walk_light_of(walk, i, index, light);
        shade_answer(wave->job, light, &wave->hit[j], &wave->path[i]);
        at->hit = wave->hit[j];
        at->shadowed = wave->path[i].segment.shadowed >> light & 1u;
    }
    return status;
}

static enum status walk_segment(struct diff_walk *walk, struct wave *wave, uint32_t index,
                                struct reason *reason)
{
    enum status status = walk_hits(walk, wave, index, reason);
    for (uint32_t light = 0; light < walk->lights && !status; light++)
        status = walk_shadows(walk, wave, index, light, reason);
    for (size_t i = 0; i < walk->count && !status; i++) {
        struct shade_path *path = &wave->path[i];
        struct walk_step *step = walk_step_of(walk, i, index);
        if (!wave->live[i])
            continue;
        step->d = path->d;
        step->s = path->s;
        step->segment = path->segment;
        wave->live[i] = shade_next(wave->job, index, path);
        step->total = path->total;
    }
    return status;
}

static void begin(struct diff_walk *walk, struct wave *wave, const size_t *pixel)
{
    for (size_t i = 0; i < walk->count; i++) {
        shade_begin(wave->job, wave->view, (uint32_t)(pixel[i] % wave->job->width),
                    (uint32_t)(pixel[i] / wave->job->width), &wave->path[i]);
        wave->path[i].bounded = true;
        wave->live[i] = true;
    }
}

enum status walk_make(const struct frame_job *job, const struct view *view, const size_t *pixel,
                      size_t count, walk_ask_fn *ask_rays, void *user, struct diff_walk *out,
                      struct reason *reason)
{
    struct wave wave = {.job = job, .view = view, .ask = ask_rays, .user = user};
    *out = (struct diff_walk){.count = count,
                              .bounces = job->look.bounces,
                              .lights = job->light_count,
                              .shadow_query =
                                  job->look.profile == PROFILE_RTRS ? QUERY_CLOSEST : QUERY_ANY};
    enum status status = make_room(job, count, out, &wave);
    if (status)
        fail(reason, status, "no memory for the paths of %zu pixels", count);
    else
        begin(out, &wave, pixel);
    for (uint32_t index = 0; index < out->bounces && !status; index++)
        status = walk_segment(out, &wave, index, reason);
    for (size_t i = 0; i < count && !status; i++)
        frame_store(&out->frame, i, &wave.path[i]);
    wave_free(&wave);
    if (status)
        walk_free(out);
    return status;
}

void walk_segments(const struct diff_walk *walk, size_t path, struct segment *out)
{
    for (uint32_t i = 0; i < walk->bounces; i++) {
        out[i] = (struct segment){.prim = ABI_NO_SEGMENT};
        if (i < walk->length[path])
            out[i] = walk_step_of(walk, path, i)->segment;
    }
}
