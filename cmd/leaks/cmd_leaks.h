/* Shared by raydiff leaks and its report. For commands only. */
#ifndef CMD_LEAKS_H
#define CMD_LEAKS_H

#include "cmd/common/cmd_screen.h"
#include "cmd/common/cmd_progress.h"
#include "ref/judge/leaks.h"
#include "ref/match/turnout.h"
#include "scenes/rays/rays_inside.h"

#define LEAKS_LEAST 1000 /* fewer rays prove nothing */

/* Values of the options. */
struct leaks_options {
    struct list layout, store, engine, builder, box, tri;
    bool layout_named, engine_named;
    struct build_options build;
    uint64_t count, seed;
    const struct leak_profile *profile;
    struct engine_options engines;
    struct screen_options screen;
    const char *json;
    const char *bvh; /* from --bvh, or NULL */
    uint32_t braid;  /* of worlds */
};

/* Results of an engine on a layout, or without one. */
struct leak_row {
    const struct engine *engine; /* NULL: no engine ran, since the layout refused */
    const struct layout *layout; /* NULL: the engine needs none */
    const struct tri_store *store;
    const struct builder *builder;
    const struct box_test *box;
    const struct tri_test *tri;
    enum status status; /* LIMIT: the layout or the engine refuses; REFUSED: the engine refuses;
                           UNSUPPORTED: cannot run here, or cannot do this; else failed */
    struct reason reason;
    bool absent; /* UNSUPPORTED: the engine cannot run here at all */
    struct leaks leaks;
    bool own_test; /* the engine has its own triangle test and does not run `tri` */
    bool promises; /* watertight triangle test, box test keeps it so, none as published */
    bool compared; /* bit for bit with engine cpu on the same tree */
    size_t bit_differences;
    char broken[160]; /* what breaks the profile or the engine's promise; "": nothing */
};

/* One scene and all its rows. */
struct leak_scene {
    const char *spec;
    const struct leak_profile *profile;
    uint32_t tri_count, point_count, edge_count; /* of a world placed triangles, 0, 0 */
    bool is_world;
    bool seams;         /* a world whose instances are closed only together: nothing is judged */
    uint32_t instances; /* of a world: that rays start in, or all */
    size_t ray_count;
    uint64_t seed;
    struct inside inside;
    char vacuous[120]; /* why the whole result proves nothing; "": it does */
    struct leak_row *row;
    size_t row_count;
};

/* Opens a scene, requires a closed mesh, aims the rays and runs every engine. *result is complete
 * only on success. The caller frees result->row. Errors: STATUS_INPUT no such scene, an open mesh,
 * no point inside; STATUS_MEMORY; those of builders. Errors of a row are recorded in the row. */
enum status leaks_play(const struct leaks_options *options, struct pool *pool,
                       struct progress *progress, const char *spec, struct leak_scene *result,
                       struct reason *reason) MUST_USE;

/* Adds a row. Errors: STATUS_MEMORY. */
enum status leaks_add_row(struct leak_scene *result, const struct leak_row *row,
                          struct reason *reason) MUST_USE;

/* Fills in row->broken from the row's counts. */
void leak_row_judge(struct leak_row *row, const struct leak_profile *profile);

/* Prints the last line: how many rows keep their promise and the profile, break one, or are only
 * counted; how many did not run. `code`, the command's exit code, decides the colour. Prints
 * nothing if there are no rows. */
void leaks_print_conclusion(const struct leak_scene *scene, size_t count, int code,
                            const struct screen *screen);

/* Prints the table of a scene, its findings and a summary. */
void leaks_print(const struct leak_scene *scene, const struct screen *screen);

/* Prints the table in columns that fit the screen: the verdict first. */
void leaks_print_table(const struct leak_scene *scene, const struct screen *screen);

/* Prints it with every counter, however long the lines. */
void leaks_print_wide(const struct leak_scene *scene);

/* The triangle test that a row ran, which may be the engine's whatever was named. */
const char *leak_row_tri(const struct leak_row *row);

/* How a row without results ended: refused, skipped or failed. */
const char *leak_row_ended(const struct leak_row *row);

/* The exit code of the rows. A refusing layout or an engine that cannot run counts only if it was
 * named, but it is an error if every layout refuses. */
int leaks_exit(const struct leak_scene *scene, bool layout_named, bool engine_named);

/* Counts all rows for the members in the turnout. */
void leaks_count_turnout(const struct leak_scene *scene, struct turnout *turnout);

/* Writes all rows as JSON (docs/formats.md). Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status leaks_write_json(const char *path, const struct leak_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code,
                             struct reason *reason) MUST_USE;

#endif
