/* What raydiff check and its report share. For commands only. */
#ifndef CMD_CHECK_H
#define CMD_CHECK_H

#include "cmd/common/cmd_rows.h"
#include "ref/match/match.h"
#include "ref/scene/quantise.h"
#include "ref/match/turnout.h"

/* One scene and all its rows. */
struct check_scene {
    const char *spec;
    uint32_t tri_count, vertex_count;
    double move; /* of --move: extents; 0: nothing moved */
    const char *rays;
    size_t ray_count;
    uint64_t seed;
    const char *driver;         /* of --driver, or NULL */
    struct quantised quantised; /* of the rows that have original.judged */
    struct row *row;
    size_t row_count;
    char refused[1024]; /* --layout auto: why smaller layouts could not, one per line */
};

/* The options, of struct check_options. */
extern const struct option_set check_set;

/* Prints the table of a scene, what was refused or skipped and why, and what it means. */
void check_print(const struct check_scene *scene);

/* What the motion of --move did to trees and packed trees; nothing without one. */
void check_print_moved(const struct check_scene *scene);

/* The exit code of the rows; a layout or engine counts only if it was named, or if
 * nothing else was played, or nothing else of a storage that is not the default. */
int check_exit(const struct check_scene *scene, bool layout_named, bool engine_named);

/* Adds a copy of the row to the scene. Errors: STATUS_MEMORY. */
enum status check_add_row(struct check_scene *result, const struct row *row) MUST_USE;

/* The exit code of a displacement that no row used, as no formula is unknown; 0: none was given. */
int check_unused(float displacement, const struct check_scene *scene, size_t count);

/* Writes all rows as JSON, see README "JSON". Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status check_write_json(const char *path, const struct check_scene *scene, size_t scene_count,
                             const struct turnout *turnout, int exit_code,
                             struct reason *reason) MUST_USE;

/* What the options set. */
struct check_options {
    struct list layout, store, engine, builder, box, tri, query;
    bool layout_auto, layout_named, engine_named; /* engine: and not as all */
    struct build_options build;
    size_t rays;
    uint64_t count, seed, repeats, brute, brute_rays, bits; /* bits 0: not named */
    struct engine_options engines;
    float move;
    struct match_demands demands;
    const char *json;
    const char *bvh; /* of --bvh, or NULL */
};

#endif
