/* Draws frames in a measured run: an engine with a tree, a layout and a look, prepared once. */
#ifndef PAINTER_H
#define PAINTER_H

#include "bench/frames/frames.h"
#include "scenes/render/camera.h"
#include "scenes/render/render.h"

/* Members are borrowed and must outlive the painter. */
struct painter_plan {
    const char *handler; /* name in files */
    const struct engine *engine;
    const struct layout *layout; /* NULL: the engine needs no tree */
    const struct builder *builder;
    struct build_options build;
    const struct bvh *tree; /* used instead of the builder's tree unless NULL */
    const struct box_test *box;
    const struct tri_test *tri;
    struct look look;
    uint32_t width, height;
    enum frame_plan plan;
    uint32_t tile;
    bool general; /* use the pipeline for every scene: see struct frame_job */
    bool waves;   /* trace ray by ray, even if the engine has a renderer */
    bool blank;   /* no triangles, to measure frames that hit nothing */
};

/* Borrows *scene. Do not move it: it points into itself. */
struct painter {
    struct painter_plan plan;
    const struct scene *scene;
    struct scene empty; /* drawn instead of the scene if plan.blank */
    struct packed packed;
    struct bvh_stats tree; /* of the packed tree; zero if none */
    struct shading shading;
    struct camera camera;
    struct renderer *renderer;
    uint32_t *pixel; /* the last frame */
    bool by_waves;   /* no renderer, or plan.waves: only the rays are timed */
};

/* Builds, packs, opens and prepares. Errors: STATUS_INPUT, _LIMIT, _UNSUPPORTED, _DEVICE, _MEMORY
 * as from builders, packed_make, shading_make, renderer_open and renderer_prepare; *out is then
 * zero. */
enum status painter_open(const struct painter_plan *plan, const struct scene *scene,
                         const struct engine_options *options, struct painter *out,
                         struct reason *reason) MUST_USE;

/* Bytes of the handler besides the triangles: nodes and items. */
uint64_t painter_bytes(const struct painter *painter);

/* Draws the frame after turning by `angle` into painter->pixel. Errors: those of renderer_frame. */
enum status painter_draw(struct painter *painter, double angle, struct frames_sample *out,
                         struct reason *reason) MUST_USE;

/* All data of a frame, for comparison with another painter's. Owns its arrays: free with
 * sheet_free. */
struct sheet {
    struct frame frame; /* pixel, color, bound and segment; bound is NaN until it is filled in */
    uint32_t width, height, bounces;
};

/* Errors: STATUS_MEMORY; *out is then zero. */
enum status sheet_make(const struct painter_plan *plan, struct sheet *out,
                       struct reason *reason) MUST_USE;
void sheet_free(struct sheet *sheet);

/* Like painter_draw, with all data of the frame. */
enum status painter_sheet(struct painter *painter, double angle, struct sheet *sheet,
                          struct frames_sample *out, struct reason *reason) MUST_USE;

/* Number of pixels with different values. */
size_t sheet_pixels_apart(const struct sheet *a, const struct sheet *b);

/* True if pixels, colours and segments are bitwise equal. */
bool sheet_equal(const struct sheet *a, const struct sheet *b);

void painter_close(struct painter *painter); /* a zeroed painter is fine */

#endif
