/* The value that a picture in false colours shows of each pixel: from the answer, the traversal or
 * the judge; or the difference of two trees. */
#ifndef SHOW_H
#define SHOW_H

#include "ref/frame.h"
#include "ref/look/numbers.h"
#include "ref/look/verdicts.h"
#include "ref/trace/trace.h"

enum show_from {
    SHOW_FROM_ANSWER, /* what any engine answered */
    SHOW_FROM_WALK,   /* struct ray_numbers of the traversal in C, whatever the engine */
    SHOW_FROM_JUDGE,  /* any engine's answer, judged against the exact truth */
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
    const char *label; /* unit of the scale bar */
    enum show_id id;
    enum show_from from;
    bool names;      /* values are names: only equal or different */
    bool whole;      /* amounts are integers */
    uint32_t planes; /* values per pixel: 3 for normals, else 1 */
};

/* Indexed by enum show_id; ends at the first entry without a name. */
extern const struct show shows[];

const struct show *show_find(const char *name); /* or NULL */

/* Source of the values. All pointers are borrowed. */
struct show_source {
    const struct show *show;
    const struct frame_job *job; /* width, height, range and shading. `self` has prepared job->job.
                                  * The rays are those of the first segments. */
    const struct view *view;
    const struct engine *engine;
    void *self;                    /* engine instance; SHOW_FROM_WALK: one that counts its work */
    const struct numbers *numbers; /* SHOW_FROM_WALK, else NULL */
    const struct oracle *oracle;   /* SHOW_FROM_JUDGE, else NULL */
    const struct judge *judge;     /* likewise */
    bool unknown;                  /* the engine's formula is TWIN_UNKNOWN */
};

/* Writes the values of pixels first .. first + count - 1 (row by row from the top) to `value`:
 * show->planes per pixel, NAN if there is nothing to show.
 *   counts  may be NULL; the engine's counts are added, if it counts
 * Errors: as engine.trace; STATUS_INTERNAL (SHOW_FROM_WALK) hits or counts differ from the
 * engine's, or the walk of a ray did not end; STATUS_MEMORY. */
enum status show_values(const struct show_source *source, size_t first, size_t count, double *value,
                        struct trace_counts *counts, struct reason *reason) MUST_USE;

/* Writes a value of `show` as text: a number or a verdict's name; "-" for NAN. */
void show_text(const struct show *show, double value, char *text, size_t text_bytes);

/* Writes second - first per pixel. Names: 0 if equal, 1 if different or if only one is a hit.
 * Normals: the angle between both in degrees. NAN if neither has a value and, except for names, if
 * only one has. *alone (may be NULL): number of pixels for which only one has a value. `out` has
 * one plane, and may be one of the inputs if they have one, too. */
void show_difference(const struct show *show, const double *first, const double *second,
                     size_t pixels, double *out, size_t *alone);

/* Statistics of values of one plane, without NANs. */
struct show_sum {
    size_t pixels;                 /* with a value */
    double sum, least, most, mean; /* 0 if there are no pixels */
    size_t most_at;                /* first pixel with the largest value */
};

struct show_sum show_sum_of(const double *value, size_t pixels);

#endif
