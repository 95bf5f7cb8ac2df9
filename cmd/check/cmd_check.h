/* Shared by raydiff check and its report. For commands only. */
#ifndef CMD_CHECK_H
#define CMD_CHECK_H

#include "cmd/common/cmd_compiler.h"
#include "cmd/common/cmd_finding.h"
#include "ref/match/match.h"
#include "ref/scene/quantise.h"
#include "ref/match/turnout.h"
#include "scenes/world_steps.h"

/* One scene and all its rows. */
struct check_scene {
    const char *spec;
    uint32_t tri_count, vertex_count; /* of a world: placed ones */
    uint32_t instance_count;          /* of a world; 0: a scene */
    const char *modes;                /* of a world: what rays may meet; else NULL */
    char scenes_only[256];            /* of a world: names of engines that trace none, as "a, b" */
    bool vacuous;                     /* a world in which no ray can hit anything: no rows */
    double move;                      /* --move: extents; 0: nothing moved */
    uint32_t step;              /* --steps: after which of them, from 1; 0: before them, or none */
    char after[STEP_TEXT_MOST]; /* that step; "": none */
    const char *rays;
    size_t ray_count;
    uint64_t seed;
    const char *driver;        /* from --driver, or NULL */
    const struct lossy *lossy; /* for rows with original.judged, as is the next */
    struct quantised quantised;
    uint32_t flat; /* triangles of the decoded scene without area */
    struct row *row;
    size_t row_count;
    char refused[1024]; /* why --layout auto passed over layouts, one per line */
};

/* The options; they fill a struct check_options. */
extern const struct option_set check_set;

/* What its findings are of. */
struct finding_of check_finding_of(const struct check_scene *scene);

/* Why a vacuous world is. */
#define CHECK_VACUOUS "vacuous: this world has nothing that a ray can hit"

/* Prints the table of a scene, its findings, what was refused or skipped and why, and a summary. */
void check_print(const struct check_scene *scene, const struct screen *screen);

/* True if the speeds of two rows can be told apart: their least-most ranges lie apart by a larger
 * factor than the wider of them spans. Runs of one row follow each other, so that a machine that
 * slows down meanwhile moves a whole range; and of a single run nothing is known. */
bool check_speeds_differ(const struct row *a, const struct row *b);

/* Prints the last line: how many rows agree, how many were refused, skipped, failed or are vacuous,
 * how many answers are WRONG, and the layout with the most of f32's speed among those that agree on
 * the same engine, builder, tests and query, if that can be told from f32's. `code`, the command's
 * exit code, decides the colour.
 * Prints nothing if there are no rows. */
void check_print_conclusion(const struct check_scene *scene, size_t count, int code,
                            const struct screen *screen);

/* Prints the table in columns that fit the screen: the verdict first. */
void check_print_table(const struct check_scene *scene, const struct screen *screen);

#define CHECK_NOTE_MOST 1024

/* Writes what a row that ran has besides its columns: kinds of WRONG, the displacement of an
 * unknown formula, hits lost beside edges, counters of lists. Begins with a blank unless empty. */
void check_row_note(const struct row *row, char text[CHECK_NOTE_MOST]);

/* Prints it with every counter, however long the lines. */
void check_print_wide(const struct check_scene *scene);

void check_print_modes(const struct check_scene *scene, const struct screen *screen);
/* "built", "refitted", "rebuilt", or "forced" where it was built again in place of a refit. */
const char *check_fate_name(enum life_fate fate);
/* Prints which trees were refitted or built again in the last step, and which engines updated what
 * they held. Prints nothing without --steps. */
void check_print_life(const struct check_scene *scene, const struct screen *screen);
/* Prints how --move affected trees and packed trees. Prints nothing without --move. */
void check_print_moved(const struct check_scene *scene, const struct screen *screen);

/* The exit code of the rows. A refusing layout or a skipped engine counts only if it was named. It
 * is a usage error if nothing ran at all, or nothing ran on a named storage other than the
 * default. */
int check_exit(const struct check_scene *scene, bool layout_named, bool engine_named);

/* Adds a copy of the row to the scene. Errors: STATUS_MEMORY. */
enum status check_add_row(struct check_scene *result, const struct row *row) MUST_USE;

/* Returns a usage error if --displacement was given but no row used it, since no formula is
 * unknown. `displacement` 0: not given. */
int check_unused(float displacement, const struct check_scene *scene, size_t count);

/* Writes all rows as JSON (docs/formats.md). Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status check_write_json(const char *path, const struct check_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code,
                             struct reason *reason) MUST_USE;

struct check_options;

/* A scene or a world, and rays into it. */
struct check_subject {
    struct scene scene, rest;               /* rest: before --move */
    struct scene past[LIFE_STEPS_MOST + 1]; /* --steps: as built, and after each step until now */
    struct world world;
    struct world before[LIFE_STEPS_MOST + 1]; /* in place of `past` */
    struct match_life life;                   /* of these */
    bool lives;                               /* false: there are no steps */
    bool is_world;                            /* else a scene */
    struct ray *ray;
    struct ray_mode *mode; /* of a world */
};

/* Opens what a text names, takes it through the first result->step steps, draws rays and fills in
 * the members of `result` that say what it is. Of a vacuous world there are no rays.
 * Errors: as world_open, world_bake and ray_set_new; STATUS_INPUT an option that is of worlds
 * alone, or of scenes alone. On error *out is to be freed, too. */
enum status check_open(const struct check_options *options, const char *spec,
                       struct check_scene *result, struct check_subject *out,
                       struct reason *reason) MUST_USE;
void check_close(struct check_subject *subject);

/* Opens a text as a world, and a plain one as the scene that it is. Errors: as world_open; then
 * *out, which was zero, is to be freed, too. */
enum status check_open_either(const char *spec, uint64_t seed, struct check_subject *out,
                              struct reason *reason) MUST_USE;

/* Fills in the numbers of a world, and whether it is vacuous. */
void check_describe(const struct world *world, struct check_scene *result);

/* Values of the options. */
struct check_options {
    struct list layout, store, engine, builder, box, tri, query;
    bool layout_auto, layout_named, engine_named; /* engine_named: not by "all" */
    struct build_options build;
    size_t rays, modes;
    uint32_t braid; /* of worlds */
    bool modes_named;
    uint64_t count, seed, repeats, brute, brute_rays, bits; /* bits 0: not given */
    struct engine_options engines;
    struct compiler_options compilers;
    float move;
    struct step step[LIFE_STEPS_MOST]; /* --steps */
    uint32_t step_count;
    struct match_demands demands;
    struct screen_options screen;
    const char *json;
    const char *bvh; /* from --bvh, or NULL */
};

#endif
