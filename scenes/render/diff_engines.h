/* Two engines' pictures of one job, compared and explained: which pixels differ, and why. */
#ifndef DIFF_ENGINES_H
#define DIFF_ENGINES_H

#include "scenes/render/diff_frames.h"
#include "scenes/render/diff_why.h"
#include "scenes/render/render.h"

#define SIDE_BYTES_MOST ((size_t)2 << 30) /* for the frame of one engine */

/* One engine on one tree. Owns what it opened (side_close). */
struct side {
    const struct engine *engine;
    struct engine_options options;
    struct frame_job job;
    struct model model;
    bool published; /* its tree or box test is as published: wrong answers are expected */
    struct renderer *renderer;  /* draws */
    struct renderer *by_waves;  /* answers rays: the same as `renderer`, or opened on first use */
    struct frame frame;         /* owned */
    struct trace_report report; /* of the frame */
};

/* Opens an engine and prepares it for a job, which is borrowed with all it points at. `waves`: see
 * renderer_open. `published` is for the caller to set. Errors: as renderer_open and
 * renderer_prepare. On error *out is closed. */
enum status side_open(const struct engine *engine, const struct engine_options *options,
                      const struct frame_job *job, bool waves, struct side *out,
                      struct reason *reason) MUST_USE;

/* Draws all pixels with their segments. Errors: STATUS_LIMIT a picture whose segments take more
 * than SIDE_BYTES_MOST; STATUS_MEMORY; as renderer_frame. */
enum status side_draw(struct side *side, const struct view *view, struct reason *reason) MUST_USE;

/* Walks the paths of some pixels. Errors: as walk_make; those of opening and preparing the engine.
 */
enum status side_walk(struct side *side, const struct view *view, const size_t *pixel, size_t count,
                      struct diff_walk *out, struct reason *reason) MUST_USE;

void side_close(struct side *side);

/* Whether a pair must follow the same paths to the bit: both promise C's bits, and have the same
 * tree and tests. */
bool sides_same_bits(const struct side *a, const struct side *b);

/* One pixel that differs, and why. */
struct pixel_why {
    size_t pixel;
    unsigned apart;        /* of the values */
    enum path_field field; /* that differs first, in the pictures */
    uint32_t segment;      /* where */
    struct path_why why;
};

/* One pixel on the same path whose value differs as rounding allows. */
struct pixel_border {
    size_t pixel;
    uint32_t value[2];
    float bound; /* of struct frame */
};

#define PAIR_KEPT 16 /* of each kind */

/* What was found about a pair. */
struct pair {
    bool same_bits; /* demanded */
    struct frame_diff diff;
    bool bounded;          /* the C renderer drew one of them; else colours are left to the walks */
    size_t asked;          /* pixels to be explained */
    size_t why[WHY_COUNT]; /* of them */
    size_t verdict[VERDICT_COUNT];                  /* kinds of why[WHY_ALLOWED] */
    double over;                                    /* largest err/E */
    struct pixel_why example[WHY_COUNT][PAIR_KEPT]; /* the first why[i] of them, if so many */
    struct pixel_border border[PAIR_KEPT];
    size_t border_count; /* kept */
};

/* Compares the drawn frames of two sides of the same size. *pixel (caller frees) are the `count`
 * pixels to be explained: those whose path differs in any bit, or whose value differs by more than
 * rounding allows.
 * Errors: STATUS_MEMORY. */
enum status pair_compare(const struct side *a, const struct side *b, struct pair *out,
                         size_t **pixel, size_t *count, struct reason *reason) MUST_USE;

/* How many pixels are best explained at once. */
size_t pair_batch(const struct frame_job *job);

/* Explains some of the pixels and adds them to *pair. Errors: as side_walk; STATUS_MEMORY. */
enum status pair_explain(struct side *a, struct side *b, const struct view *view,
                         const struct oracle *oracle, const size_t *pixel, size_t count,
                         struct pair *pair, struct reason *reason) MUST_USE;

/* Whether the pair is in order: nothing that the same bits forbid, and everything explained. */
bool pair_agrees(const struct pair *pair);

#endif
