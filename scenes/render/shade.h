/* One path of a picture, step by step, in the order of operations of ref/frame.h. The caller traces
 * the rays. */
#ifndef SHADE_H
#define SHADE_H

#include "ref/frame.h"
#include "scenes/render/vec3.h"

/* A path. Call shade_begin; then per segment shade_ray, shade_hit, for each light shade_ask and, if
 * that returned true, shade_answer, then shade_next. */
struct shade_path {
    struct vec3 org, dir; /* of the segment */
    struct vec3 total;
    float weight;
    /* Set by shade_hit: hit point, shading normal, normal of the triangle; light gathered. */
    struct vec3 p, n, g;
    float d, s;
    float nl, rv, far;      /* of the last light */
    bool bounded;           /* set after shade_begin to use shade_bound, which costs time */
    double s_error, error;  /* errors of s and of any channel of total: see shade_bound */
    struct segment segment; /* result; complete after the last light */
};

/* v / |v|, or zero if the squared length is not in (0, inf). */
struct vec3 shade_unit(struct vec3 v);

/* Begins the path of pixel (x, y) of the job, row 0 at the top. */
void shade_begin(const struct frame_job *job, const struct view *view, uint32_t x, uint32_t y,
                 struct shade_path *out);

/* The closest-hit ray of the segment. */
struct ray shade_ray(const struct frame_job *job, const struct shade_path *path);

/* Processes its hit. Returns false if the path ends here. */
bool shade_hit(const struct frame_job *job, const struct hit *hit, struct shade_path *path);

/* Returns true and writes the shadow ray if light `light` needs one: closest-hit in PROFILE_RTRS,
 * else any-hit. Call for lights in order. */
bool shade_ask(const struct frame_job *job, const struct view *view, uint32_t light,
               struct shade_path *path, struct ray *out);

/* Processes its hit. */
void shade_answer(const struct frame_job *job, uint32_t light, const struct hit *hit,
                  struct shade_path *path);

/* Adds segment `index` to the colour and starts the next one. Returns false if there is none. */
bool shade_next(const struct frame_job *job, uint32_t index, struct shade_path *path);

/* The pixel of a colour, as in struct frame. */
uint32_t shade_pixel(struct vec3 total);

/* The largest difference between 255 times a channel of total, as rounded for the pixel, and that
 * of another renderer with the same path, IEEE operations and a pow within Vulkan's precision (see
 * shade.c). 0: the pixel is the same; infinite: no bound is known. The path must have been
 * `bounded` from the start. */
float shade_bound(const struct shade_path *path);

/* The largest difference between the pow of such a renderer and powf(x, y), for x > 0 and finite
 * y. */
double shade_pow_error(float x, float y);

#endif
