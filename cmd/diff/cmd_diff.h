/* The two halves of raydiff diff: pictures, and engines on a scene. For commands only. */
#ifndef CMD_DIFF_H
#define CMD_DIFF_H

#include "cmd/common/cmd_explain_line.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_tables.h"
#include "cmd/render/cmd_render.h"
#include "scenes/render/diff_engines.h"

/* raydiff diff A.png B.png; argv[0] is "diff". Returns the exit code. */
int cmd_diff_images(int argc, char **argv);

/* What the options set. */
struct diff_options {
    struct render_settings settings;
    struct list engine;
    bool has_pixel;
    uint32_t x, y;
    float angle;   /* degrees */
    uint64_t list; /* pixels listed of each kind */
    const char *out, *json;
};

/* One engine's part in a run. */
struct diff_member {
    const struct engine *engine;
    enum status status; /* STATUS_UNSUPPORTED: it is left out, for `reason` */
    struct reason reason;
    struct side side;
    struct pair pair;      /* with the first engine that runs; of that one empty */
    struct diff_walk walk; /* of --pixel */
    enum path_field field; /* of --pixel: in which a renderer of its own leaves that walk */
    uint32_t segment;      /* there */
};

/* One run. Do not move it: parts point into others. */
struct diff_run {
    const struct diff_options *options;
    struct render_stage stage;
    struct view view;
    struct oracle *oracle;
    struct diff_member member[LIST_MOST];
    size_t count;
    size_t reference;   /* the first member that runs */
    char command[1024]; /* the run's own command line, without what it writes */
};

/* "raydiff explain ..." of a ray of a member: its own, or to a light. */
void diff_explain(const struct diff_run *run, const struct diff_member *member, bool shadow,
                  const struct ray *ray, char text[EXPLAIN_COMMAND_MOST]);

/* True if two pictures agree although neither has a hit: nothing was compared. */
bool diff_is_vacuous(const struct pair *pair);

/* Prints what differs between the reference and each other member, and why. */
void diff_print(const struct diff_run *run);

/* Writes it as JSON. Errors: as json_write. */
enum status diff_write_json(const struct diff_run *run, int exit_code,
                            struct reason *reason) MUST_USE;

/* The path of the pixel on all members: walks it, judges every answer, prints it and writes the
 * JSON. *exit_code becomes EXIT_MISMATCH if an answer is wrong, or bits differ that must not.
 * Errors: as side_walk; STATUS_MEMORY; as json_write. */
enum status diff_pixel(struct diff_run *run, int *exit_code, struct reason *reason) MUST_USE;

/* What the run is of, for the head of a page: "rtrs, 96 x 72, repaired, ...". */
void diff_print_subject(const struct diff_run *run);

/* The same as JSON, an object to which more is added. */
json_t *diff_subject_json(const struct diff_run *run, int exit_code);

#endif
