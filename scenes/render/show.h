/* What a picture in false colours shows of each pixel: a number of the answer, of the way through
 * the tree, or of the judge. The same for two trees, subtracted. */
#ifndef SHOW_H
#define SHOW_H

#include "ref/frame.h"
#include "ref/look/numbers.h"
#include "ref/look/verdicts.h"
#include "ref/trace/trace.h"

enum show_from {
    SHOW_FROM_ANSWER, /* what any engine answered */
    SHOW_FROM_WALK,   /* struct ray_numbers: the traversal in C, whatever the engine */
    SHOW_FROM_JUDGE,  /* what any engine answered, judged against the exact truth */
};

enum show_id {
    SHOW_T,
    SHOW_PRIM,
    SHOW_NORMAL,
    SHOW_BOXES,
    SHOW_TRIANGLES,
    SHOW_DEPTH,
    SHOW_OVERLAP,
    SHOW_OVERLAP_ALL,
    SHOW_INFLATION,
    SHOW_ERROR,
    SHOW_CLASS,
};

struct show {
    const char *name;
    const char *summary;
    const char *label; /* of the scale bar */
    enum show_id id;
    enum show_from from;
    bool names;      /* values are names, not amounts: only the same or different */
    bool whole;      /* amounts are whole numbers */
    uint32_t planes; /* values of a pixel: 3 of a normal, else 1 */
};

/* Ends at the first without a name; index is enum show_id. */
extern const struct show shows[];

const struct show *show_find(const char *name); /* or NULL */

/* Whose pixels are shown; all borrowed. */
struct show_source {
    const struct show *show;
    const struct frame_job *job; /* width, height, range and shading; job->job is prepared by
                                    `self`; the rays are those of its first segments */
    const struct view *view;
    const struct engine *engine;
    void *self;                    /* of the engine; SHOW_FROM_WALK: one that counts its work */
    const struct numbers *numbers; /* SHOW_FROM_WALK, else NULL */
    const struct oracle *oracle;   /* SHOW_FROM_JUDGE, else NULL */
    const struct judge *judge;     /* likewise */
    bool unknown;                  /* the engine's formula is TWIN_UNKNOWN */
};

/* The values of pixels first .. first + count - 1, row by row from the top: show->planes of each
 * go to `value`, NAN where there is nothing to show.
 *   counts  may be NULL; added to: what the engine said that it did, if it counts
 * Errors: as engine.trace; STATUS_INTERNAL (SHOW_FROM_WALK) hits or work differ from what the
 * engine answered, or a ray was not finished; STATUS_MEMORY. */
enum status show_values(const struct show_source *source, size_t first, size_t count, double *value,
                        struct trace_counts *counts, struct reason *reason) MUST_USE;

/* A value of `show` as text: a number, or a verdict's name; "-" for NAN. */
void show_text(const struct show *show, double value, char *text, size_t text_bytes);

/* second - first, per pixel; of names 0 where both say the same and 1 where not, a hit and a miss
 * too; of normals the degrees between both. NAN where neither has a value, and of amounts where
 * only one has. *alone (may be NULL): pixels where only one has. `out` has one plane and may be one
 * of the inputs if these have one, too. */
void show_difference(const struct show *show, const double *first, const double *second,
                     size_t pixels, double *out, size_t *alone);

/* Of values of one plane, NANs left out. */
struct show_sum {
    size_t pixels;                 /* with a value */
    double sum, least, most, mean; /* 0 without a pixel */
    size_t most_at;                /* the first pixel that has the most */
};

struct show_sum show_sum_of(const double *value, size_t pixels);

#endif
