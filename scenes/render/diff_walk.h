/* The paths of chosen pixels with every ray, hit, hit point and the light gathered there. The steps
 * are those of the renderer in C (scenes/render/shade.h). The caller supplies the function that
 * traces rays. */
#ifndef DIFF_WALK_H
#define DIFF_WALK_H

#include "scenes/render/shade.h"

/* Traces `count` rays. Errors: its own. */
typedef enum status walk_ask_fn(void *user, enum query query, const struct ray *ray, size_t count,
                                struct hit *hit, struct reason *reason);

/* One light at one hit point. */
struct walk_light {
    bool asked, shadowed;
    float nl, rv, far;
    struct ray ray; /* valid if `asked` */
    struct hit hit;
};

/* One segment of a path. */
struct walk_step {
    struct ray ray;
    struct hit hit;
    struct vec3 p, n, g; /* zero for a miss; g is always zero in PROFILE_RTRS */
    float d, s;          /* diffuse and specular light gathered */
    float weight;        /* weight of the segment's colour */
    struct vec3 total;   /* colour after the segment */
    struct segment segment;
};

/* Paths of `count` pixels. Owns its arrays (walk_free). */
struct diff_walk {
    size_t count;
    uint32_t bounces, lights; /* of the job */
    enum query shadow_query;  /* of shadow rays */
    uint32_t *length;         /* [count] segments walked */
    struct walk_step *step;   /* [count * bounces] */
    struct walk_light *light; /* [count * bounces * lights] */
    struct frame frame;       /* of `count` pixels, without segments */
};

/* Walks the paths of the pixels `pixel[0 .. count - 1]` (row * width + column) of a job.
 * Errors: STATUS_MEMORY; those of `ask`. On error *out is zero. */
enum status walk_make(const struct frame_job *job, const struct view *view, const size_t *pixel,
                      size_t count, walk_ask_fn *ask, void *user, struct diff_walk *out,
                      struct reason *reason) MUST_USE;

/* Bytes needed to walk one pixel of the job. */
size_t walk_bytes(const struct frame_job *job);

void walk_free(struct diff_walk *walk);

static inline struct walk_step *walk_step_of(const struct diff_walk *walk, size_t path,
                                             uint32_t step)
{
    return &walk->step[path * walk->bounces + step];
}

static inline struct walk_light *walk_light_of(const struct diff_walk *walk, size_t path,
                                               uint32_t step, uint32_t light)
{
    return &walk->light[(path * walk->bounces + step) * walk->lights + light];
}

/* Writes the `bounces` segments of path `path` as in a frame. */
void walk_segments(const struct diff_walk *walk, size_t path, struct segment *out);

#endif
