/* One path of a picture, step by step, in the order of operations of ref/frame.h. The caller traces
 * the rays. */
#ifndef SHADE_H
#define SHADE_H

#include "ref/frame.h"
#include "scenes/render/vec3.h"

/* A path. Starts with shade_begin; per segment shade_ray, shade_hit, for each light shade_ask and,
 * if it returned true, shade_answer, then shade_next. */
struct shade_path {
    struct vec3 org, dir; /* of the segment */
    struct vec3 total;
    float weight;
    /* From shade_hit on: where, the shading and the triangle's normal, light gathered. */
    struct vec3 p, n, g;
    float d, s;
    float nl, rv, far;      /* of the last light */
    bool bounded;           /* set after shade_begin if shade_bound is wanted: it costs time */
    double s_error, error;  /* of s and of any channel of total: see shade_bound */
    struct segment segment; /* what it became, complete after the last light */
};

/* v / |v|, or zero if the square of its length is not in (0, inf). */
struct vec3 shade_unit(struct vec3 v);

/* Begins the path of pixel (x, y) of the job, row 0 at the top. */
void shade_begin(const struct frame_job *job, const struct view *view, uint32_t x, uint32_t y,
                 struct shade_path *out);

/* The ray of the segment, for its closest hit. */
struct ray shade_ray(const struct frame_job *job, const struct shade_path *path);

/* Takes its answer. Returns false if the path ends here. */
bool shade_hit(const struct frame_job *job, const struct hit *hit, struct shade_path *path);

/* Whether light `light` needs a shadow ray, and which: for the closest hit in the published
 * profile, else for any. Call for lights in order. */
bool shade_ask(const struct frame_job *job, const struct view *view, uint32_t light,
               struct shade_path *path, struct ray *out);

/* Takes its answer. */
void shade_answer(const struct frame_job *job, uint32_t light, const struct hit *hit,
                  struct shade_path *path);

/* Adds segment `index` to the colour and turns to the next. Returns false if there is none. */
bool shade_next(const struct frame_job *job, uint32_t index, struct shade_path *path);

/* The pixel of a path's colour, as struct frame has them. */
uint32_t shade_pixel(struct vec3 total);

/* How far 255 times a channel of total, as rounded on the way to a pixel, can be from another
 * renderer's with the same path, whose operations are IEEE's and whose pow is within Vulkan's
 * precision (see shade.c). 0: the pixel is the same; infinite: nothing is known. The path was
 * `bounded` from its begin on. */
float shade_bound(const struct shade_path *path);

/* How far the pow of such a renderer can be from powf(x, y), for x > 0 and finite y. */
double shade_pow_error(float x, float y);

#endif
