/* Who draws frames in a measured run: an engine with a tree, a layout and a look, prepared once. */
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
    const struct bvh *tree; /* NULL, or in place of the builder's */
    const struct box_test *box;
    const struct tri_test *tri;
    struct look look;
    uint32_t width, height;
    enum frame_plan plan;
    uint32_t tile;
    bool general; /* the pipeline for every scene: see struct frame_job */
    bool waves;   /* ray by ray, also where the engine has a renderer */
    bool blank;   /* no triangle: what a frame costs that hits nothing */
};

/* A painter; *scene is borrowed. Points into itself: it must not be moved. */
struct painter {
    struct painter_plan plan;
    const struct scene *scene;
    struct scene empty; /* drawn in its place if plan.blank */
    struct packed packed;
    struct bvh_stats tree; /* of the tree that was packed, zero if none */
    struct shading shading;
    struct camera camera;
    struct renderer *renderer;
    uint32_t *pixel; /* of the frame drawn last */
    bool by_waves;   /* the engine has no renderer, or plan.waves: only its rays are timed */
};

/* Builds, packs, opens and prepares. Errors: STATUS_INPUT, _LIMIT, _UNSUPPORTED, _DEVICE, _MEMORY
 * as builders, packed_make, shading_make, renderer_open and renderer_prepare have them. On error
 * *out is zero. */
enum status painter_open(const struct painter_plan *plan, const struct scene *scene,
                         const struct engine_options *options, struct painter *out,
                         struct reason *reason) MUST_USE;

/* Bytes that the handler needs beside the triangles: nodes and items. */
uint64_t painter_bytes(const struct painter *painter);

/* Draws the frame after turning by `angle` into painter->pixel. Errors: as renderer_frame. */
enum status painter_draw(struct painter *painter, double angle, struct frames_sample *out,
                         struct reason *reason) MUST_USE;

/* All of a frame, to be compared with another painter's; owns its arrays (see sheet_free). */
struct sheet {
    struct frame frame; /* pixel, color, bound and segment; bound is NaN until somebody fills it */
    uint32_t width, height, bounces;
};

/* Errors: STATUS_MEMORY. On error *out is zero. */
enum status sheet_make(const struct painter_plan *plan, struct sheet *out,
                       struct reason *reason) MUST_USE;
void sheet_free(struct sheet *sheet);

/* As painter_draw, with all of the frame. */
enum status painter_sheet(struct painter *painter, double angle, struct sheet *sheet,
                          struct frames_sample *out, struct reason *reason) MUST_USE;

/* Pixels whose values differ. */
size_t sheet_pixels_apart(const struct sheet *a, const struct sheet *b);

/* True if pixels, colours and segments are equal to the bit. */
bool sheet_equal(const struct sheet *a, const struct sheet *b);

void painter_close(struct painter *painter); /* a zero painter is fine */

#endif
