/* Pictures of a scene by any engine: with its own renderer if it has one, else with the reference
 * renderer in C. That one traces whole waves of rays: all primary rays, all shadow rays of a light,
 * all next segments. Besides the frame, the scene and the engine's own memory a picture takes at
 * most 32 MB (192 bytes for each of 131,072 pixels and one row), whatever its size. */
#ifndef RENDER_H
#define RENDER_H

#include "ref/frame.h"
#include "ref/match/match.h"

/* Shading data of a scene. Owns its arrays (shading_free). */
struct shading {
    struct shade_tri *tri;
    struct shade_material *material;
    struct shade_light *light;
    uint32_t material_count, light_count;
};

/* Prepares shading: normals (angle-weighted if the scene has none), planes, materials (the default
 * red if it has none), lights of strength > 0 (first that at the eye, if look->camera_light > 0).
 * Errors: STATUS_INPUT a triangle's material does not exist, a value is not finite, a strength,
 * colour or albedo is below 0 (the place is named); STATUS_LIMIT more than ABI_LIGHTS_MOST lights;
 * STATUS_MEMORY. On error *out is zero. */
enum status shading_make(const struct scene *scene, const struct look *look, struct shading *out,
                         struct reason *reason) MUST_USE;
void shading_free(struct shading *shading);

/* Sets the members of *job that follow from scene and look: shade, material, light, tmin, tmax,
 * offset. job->job.scene and job->look must be set. PROFILE_RTRS: the published constants.
 * PROFILE_REPAIRED: tmin 0, tmax RAY_TMAX, offset 2^-17 of the largest coordinate of scene and eye.
 * `shading` is borrowed. */
void frame_job_fill(const struct shading *shading, const struct camera *camera,
                    struct frame_job *job);

struct shade_path;

/* Allocates all arrays of a frame of `pixels` pixels with `bounces` segments each. Returns false if
 * out of memory; *out is then zero. */
bool frame_make(size_t pixels, uint32_t bounces, struct frame *out) MUST_USE;
void frame_free(struct frame *frame);
/* Stores the colour of a path in all arrays that the frame has, except segments. */
void frame_store(struct frame *frame, size_t pixel, const struct shade_path *path);

struct renderer;

/* Opens an engine for pictures (with two instances if closest and any must both be prepared).
 * `waves`: use engine.trace even if the engine has a renderer. *out is NULL on error.
 * Errors: as engine.open; STATUS_UNSUPPORTED a recorded engine, which cannot trace new rays. */
enum status renderer_open(const struct engine *engine, const struct engine_options *options,
                          bool waves, struct renderer **out, struct reason *reason) MUST_USE;

/* Prepares for a job. Errors: STATUS_INPUT a member of the job out of range; as engine.prepare. */
enum status renderer_prepare(struct renderer *renderer, const struct frame_job *job,
                             struct reason *reason) MUST_USE;

/* Draws the prepared job. `report` may be NULL; its ns is the engine's time only (by waves: tracing
 * without shading). Errors: as engine.frame and engine.trace. */
enum status renderer_frame(struct renderer *renderer, const struct view *view, struct frame *out,
                           struct trace_report *report, struct reason *reason) MUST_USE;

/* Whether pictures are drawn by waves: in C, through engine.trace. */
bool renderer_by_waves(const struct renderer *renderer);

/* Traces rays of the prepared job through the engine of a renderer by waves: QUERY_CLOSEST, or
 * QUERY_ANY if its shadow rays are any-hit. Errors: STATUS_INPUT not prepared for that query; as
 * engine.trace. */
enum status renderer_ask(struct renderer *renderer, enum query query, const struct ray *ray,
                         size_t ray_count, struct hit *hit, struct reason *reason) MUST_USE;

/* The model of the engine's arithmetic for the judge, see engine.model. */
struct model renderer_model(struct renderer *renderer, const struct tri_test *tri);

/* Calls `step` during pictures by waves, with the share of the picture that is done. Waves are then
 * split into several engine calls if the engine is slow. NULL ends the calls. */
void renderer_watch(struct renderer *renderer, void (*step)(void *user, double share), void *user);

void renderer_close(struct renderer *renderer); /* NULL is allowed */

#endif
