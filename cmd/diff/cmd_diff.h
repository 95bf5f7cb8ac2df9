/* The two parts of raydiff diff: pictures, and engines on a scene. For commands only. */
#ifndef CMD_DIFF_H
#define CMD_DIFF_H

#include "cmd/common/cmd_explain_line.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_tables.h"
#include "cmd/render/cmd_render.h"
#include "scenes/render/diff_engines.h"

/* raydiff diff A.png B.png; argv[0] is "diff". Returns the exit code. */
int cmd_diff_images(int argc, char **argv);

/* Values of the options. */
struct diff_options {
    struct render_settings settings;
    struct list engine;
    bool has_pixel;
    uint32_t x, y;
    float angle;   /* degrees */
    uint64_t list; /* pixels listed per kind */
    const char *out, *json;
};

/* Results of one engine in a run. */
struct diff_member {
    const struct engine *engine;
    enum status status; /* STATUS_UNSUPPORTED: left out, see `reason` */
    struct reason reason;
    struct side side;
    struct pair pair;      /* with the first engine that runs; empty for that one */
    struct diff_walk walk; /* for --pixel, and what its own renderer made of it */
    struct side_drawn drawn;
};

/* One run. Do not move it: its parts point to each other. */
struct diff_run {
    const struct diff_options *options;
    struct render_stage stage;
    struct view view;
    struct oracle *oracle;
    struct diff_member member[LIST_MOST];
    size_t count;
    size_t reference;   /* the first member that runs */
    char command[1024]; /* the run's command line without its outputs */
};

/* Writes the "raydiff explain ..." command for a ray of a member. `shadow`: the ray goes to a
 * light. */
void diff_explain(const struct diff_run *run, const struct diff_member *member, bool shadow,
                  const struct ray *ray, char text[EXPLAIN_COMMAND_MOST]);

/* True if two pictures agree but neither has a hit, so that nothing was compared. */
bool diff_is_vacuous(const struct pair *pair);

/* Prints what differs between the reference and each other member, and why. */
void diff_print(const struct diff_run *run);

/* Prints the last line. */
void diff_print_conclusion(const struct diff_run *run);

/* Writes the same as JSON. Errors: as json_write. */
enum status diff_write_json(const struct diff_run *run, int exit_code,
                            struct reason *reason) MUST_USE;

/* Walks the path of the pixel on all members, judges every answer, prints the paths and writes the
 * JSON. *exit_code becomes EXIT_MISMATCH if an answer is wrong, or if bits differ that must be
 * equal. Errors: as side_walk; STATUS_MEMORY; as json_write. */
enum status diff_pixel(struct diff_run *run, int *exit_code, struct reason *reason) MUST_USE;

/* Prints the heading of a run: "rtrs: 12 triangles; 96 x 72 pixels, profile repaired, ...". */
void diff_print_subject(const struct diff_run *run);

/* The same as a JSON object. The caller adds more to it. */
json_t *diff_subject_json(const struct diff_run *run, int exit_code);

#endif
