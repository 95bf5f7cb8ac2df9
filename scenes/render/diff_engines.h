/* Compares two engines' pictures of one job, and explains which pixels differ and why. */
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
    bool published;             /* tree or box test as published: wrong answers are expected */
    struct renderer *renderer;  /* draws */
    struct renderer *by_waves;  /* traces rays: equal to `renderer`, or opened on first use */
    struct frame frame;         /* owned */
    struct trace_report report; /* of the frame */
};

/* Opens an engine and prepares it for a job, which is borrowed with everything it points to.
 * `waves`: see renderer_open. The caller sets `published`. Errors: as renderer_open and
 * renderer_prepare. On error *out is closed. */
enum status side_open(const struct engine *engine, const struct engine_options *options,
                      const struct frame_job *job, bool waves, struct side *out,
                      struct reason *reason) MUST_USE;

/* Draws all pixels with their segments. Errors: STATUS_LIMIT a picture whose segments take more
 * than SIDE_BYTES_MOST; STATUS_MEMORY; as renderer_frame. */
enum status side_draw(struct side *side, const struct view *view, struct reason *reason) MUST_USE;

/* Walks the paths of some pixels. Errors: as walk_make; as renderer_open and renderer_prepare. */
enum status side_walk(struct side *side, const struct view *view, const size_t *pixel, size_t count,
                      struct diff_walk *out, struct reason *reason) MUST_USE;

/* What an engine's own renderer made of a path. */
struct side_drawn {
    bool follows;          /* why_walk_is_frame; true without a renderer of its own */
    enum path_field field; /* the first that differs from the walk */
    uint32_t segment;      /* where */
};

/* Walks the path of one pixel. If the engine has its own renderer, draws the picture, too, and
 * compares. Errors: as side_walk and side_draw. */
enum status side_walk_pixel(struct side *side, const struct view *view, size_t pixel,
                            struct diff_walk *walk, struct side_drawn *drawn,
                            struct reason *reason) MUST_USE;

void side_close(struct side *side);

/* Whether two sides must follow bit-identical paths: both promise the bits of C, and have the same
 * tree and tests. */
bool sides_same_bits(const struct side *a, const struct side *b);

/* A pixel that differs, and why. */
struct pixel_why {
    size_t pixel;
    unsigned apart;        /* difference of the values */
    enum path_field field; /* the first that differs in the pictures */
    uint32_t segment;      /* where */
    struct path_why why;
};

/* A pixel with equal paths whose values differ within rounding. */
struct pixel_border {
    size_t pixel;
    uint32_t value[2];
    float bound; /* of struct frame */
};

#define PAIR_KEPT 16 /* of each kind */

/* Result of comparing two sides. */
struct pair {
    bool same_bits; /* bit-identical paths are required */
    struct frame_diff diff;
    bool bounded;          /* the C renderer drew one of them; else only walks check colours */
    size_t asked;          /* pixels to be explained */
    size_t why[WHY_COUNT]; /* of those, by reason */
    size_t verdict[VERDICT_COUNT];                  /* kinds of why[WHY_ALLOWED] */
    double over;                                    /* largest err/E */
    struct pixel_why example[WHY_COUNT][PAIR_KEPT]; /* the first ones, at most PAIR_KEPT each */
    struct pixel_border border[PAIR_KEPT];
    size_t border_count; /* entries of border */
};

/* Compares the drawn frames of two sides of the same size. *pixel (the caller frees it) lists the
 * `count` pixels to explain: those whose paths differ in any bit, or whose values differ by more
 * than rounding allows.
 * Errors: STATUS_MEMORY. */
enum status pair_compare(const struct side *a, const struct side *b, struct pair *out,
                         size_t **pixel, size_t *count, struct reason *reason) MUST_USE;

/* The number of pixels to explain per call of pair_explain, limited by memory. */
size_t pair_batch(const struct frame_job *job);

/* Explains `count` pixels and adds the results to *pair. Errors: as side_walk; STATUS_MEMORY. */
enum status pair_explain(struct side *a, struct side *b, const struct view *view,
                         const struct oracle *oracle, const size_t *pixel, size_t count,
                         struct pair *pair, struct reason *reason) MUST_USE;

/* Whether the sides agree: every pixel asked for is explained without a fault, and none breaks
 * required bit-identity. */
bool pair_agrees(const struct pair *pair);

#endif
