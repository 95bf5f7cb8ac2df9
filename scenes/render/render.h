/* Pictures of a scene by any engine: by the engine's own renderer if it has one, else by the
 * reference renderer in C, which traces whole waves of rays: all primary rays, all shadow rays
 * of a light, all next segments. Beside the frame, the scene and the engine's own memory a
 * picture takes at most 32 MB (192 bytes for each of 131,072 pixels and a row, and the row),
 * whatever its size. */
#ifndef RENDER_H
#define RENDER_H

#include "ref/frame.h"
#include "ref/match/match.h"

/* What shading needs of a scene; owns its arrays. */
struct shading {
    struct shade_tri *tri;
    struct shade_material *material;
    struct shade_light *light;
    uint32_t material_count, light_count;
};

/* Prepares shading: normals (angle-weighted where the scene has none), planes, materials (the
 * default red one if it has none), lights of strength > 0 (the eye's first, if look->camera_light >
 * 0). Errors: STATUS_INPUT a triangle names a material that does not exist, a value that is not
 * finite or a strength or albedo below 0 (the place is named); STATUS_LIMIT more than
 * ABI_LIGHTS_MOST lights; STATUS_MEMORY. On error *out is zero. */
enum status shading_make(const struct scene *scene, const struct look *look, struct shading *out,
                         struct reason *reason) MUST_USE;
void shading_free(struct shading *shading);

/* Fills in of *job what follows from the scene and the look: shade, material, light, tmin, tmax,
 * offset. RTRS: the published constants. REPAIRED: tmin 0, tmax RAY_TMAX, offset 2^-17 of the
 * largest coordinate of scene and eye. job->job.scene and job->look are set. `shading` is borrowed.
 */
void frame_job_fill(const struct shading *shading, const struct camera *camera,
                    struct frame_job *job);

struct shade_path;

/* Allocates all arrays of a frame of so many pixels, `bounces` segments each. Returns false without
 * memory; *out is then zero. */
bool frame_make(size_t pixels, uint32_t bounces, struct frame *out) MUST_USE;
void frame_free(struct frame *frame);
/* Stores the colour of a path in the arrays that the frame has, but its segments. */
void frame_store(struct frame *frame, size_t pixel, const struct shade_path *path);

struct renderer;

/* Opens an engine for pictures (two instances where closest and any must both be prepared).
 * `waves`: through engine.trace even if the engine has a renderer. *out is NULL on error.
 * Errors: as engine.open; STATUS_UNSUPPORTED a recorded engine, which can be asked no new ray. */
enum status renderer_open(const struct engine *engine, const struct engine_options *options,
                          bool waves, struct renderer **out, struct reason *reason) MUST_USE;

/* Errors: STATUS_INPUT a member of the job out of its range; as engine.prepare. */
enum status renderer_prepare(struct renderer *renderer, const struct frame_job *job,
                             struct reason *reason) MUST_USE;

/* Draws the prepared job. `report` (may be NULL): ns is the engine's time alone (of waves: tracing,
 * not shading). Errors: as engine.frame and engine.trace. */
enum status renderer_frame(struct renderer *renderer, const struct view *view, struct frame *out,
                           struct trace_report *report, struct reason *reason) MUST_USE;

/* Whether it draws by waves: in C, through engine.trace. */
bool renderer_by_waves(const struct renderer *renderer);

/* Traces rays of the prepared job through the engine of a renderer by waves: QUERY_CLOSEST, or
 * QUERY_ANY where its shadow rays are any-hit. Errors: STATUS_INPUT it was not prepared for that
 * query; as engine.trace. */
enum status renderer_ask(struct renderer *renderer, enum query query, const struct ray *ray,
                         size_t ray_count, struct hit *hit, struct reason *reason) MUST_USE;

/* What the judge may assume of the engine's arithmetic, see engine.model. */
struct model renderer_model(struct renderer *renderer, const struct tri_test *tri);

/* Calls `step` during pictures by waves, with the share that is done. Slow engines then get parts
 * of a wave per call. NULL: no more calls. */
void renderer_watch(struct renderer *renderer, void (*step)(void *user, double share), void *user);

void renderer_close(struct renderer *renderer); /* NULL is fine */

#endif
