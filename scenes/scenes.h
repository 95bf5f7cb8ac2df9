/* Scenes by name: generators and files of all formats. */
#ifndef SCENES_H
#define SCENES_H

#include "ref/scene/scene.h"

struct param {
    const char *name;
    const char *summary;
    double value; /* default */
    double least, most;
    bool whole; /* whole numbers only */
};

#define GENERATOR_PARAMS 6

struct pen; /* scenes/generators/pen.h */

/* A scene generator, run by generator_make. */
struct generator {
    const char *name;
    const char *summary;
    struct param param[GENERATOR_PARAMS]; /* ends at the first entry without a name */
    /* Draws the scene. `value` has one checked entry per param. */
    enum status (*make)(struct pen *pen, const double *value, struct reason *reason);
    bool seedless; /* the scene does not depend on the seed */
};

/* NULL-terminated. */
extern const struct generator *const generators[];

const struct generator *generator_find(const char *name); /* or NULL */

/* Makes a scene from one value per param, in order. The same arguments give the same bytes on every
 * machine. Errors: STATUS_LIMIT a value outside least..most or NaN, or too many triangles;
 * STATUS_INPUT a fraction for a param of whole numbers; STATUS_MEMORY. On error *out is zero. */
enum status generator_make(const struct generator *generator, const double *value, uint64_t seed,
                           struct scene *out, struct reason *reason) MUST_USE;

/* Makes or reads a scene from a user's text:
 *   "soup", "soup:n=1000,size=0.1,seed=7"   a generator with parameters (default seed: `seed`)
 *   "path/to/mesh.obj"                      a file, by its ending: .json .obj .ply, each also .gz
 * A name that is both a generator and an existing file means the generator; write ./name for the
 * file. The scene has passed scene_check. Files without a triangle are rejected.
 * Errors: STATUS_INPUT one line with file, line or byte, and rule (or the unknown name and the
 * known ones); STATUS_MEMORY. */
enum status scene_open(const char *spec, uint64_t seed, struct scene *out,
                       struct reason *reason) MUST_USE;

/* Reads a file by its ending. Errors: as scene_open. */
enum status scene_read(const char *path, struct scene *out, struct reason *reason) MUST_USE;

/* Writes a file by its ending (.json RTRS, .obj, .ply binary): to a temporary file in the same
 * folder, then renamed, so that `path` never holds an incomplete file.
 * Errors: STATUS_INPUT unknown ending, cannot write (reason); STATUS_MEMORY. */
enum status scene_write(const char *path, const struct scene *scene,
                        struct reason *reason) MUST_USE;

#endif
