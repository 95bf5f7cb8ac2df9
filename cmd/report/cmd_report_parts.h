/* The parts of a report that raydiff report has made: what is run, with which options. For commands
 * only. */
#ifndef CMD_REPORT_PARTS_H
#define CMD_REPORT_PARTS_H

#include "cmd/common/cmd_rows.h"
#include "cmd/report/cmd_report.h"

struct baseline; /* fuzz/findings/baseline.h */

/* Played if no scene is named and no result given. */
#define REPORT_DEFAULT_SCENES      "cornell", "sphere:n=20", "soup:n=1000"
#define REPORT_DEFAULT_SCENES_TEXT "cornell sphere:n=20 soup:n=1000"

#define REPORT_SCENES  16 /* as many as bench takes */
#define REPORT_PASSED  32
#define FINDINGS_SHOWN 24
#define PICTURES_GIVEN 64
#define PICTURE_SCENES 2
#define FILES_GIVEN    16

/* An option that is handed on as it is; `to` are the commands that take it. Shaders go where their
 * layouts go: where one layout is picked of those named, its own does. */
enum { TO_CHECK = 1, TO_ERROR = 2, TO_OTHERS = 4, TO_PICTURES = 8, TO_ALL = 15 };
struct passed {
    unsigned to;
    const char *flag, *value;
};

/* The user's options. */
struct report_options {
    char *const *scene;
    size_t scene_count;
    struct passed passed[REPORT_PASSED];
    size_t passed_count;
    bool wanted[REPORT_KINDS]; /* by --parts */
    bool quick;
    uint64_t count, rounds; /* 0: the default */
    uint64_t seconds;       /* of a part */
    const char *title, *out, *json, *findings;
    const char *check[FILES_GIVEN], *bench[FILES_GIVEN], *doctor; /* results that are there */
    size_t check_count, bench_count;
    char *picture[PICTURES_GIVEN]; /* TITLE=FILE */
    size_t picture_count;
    struct baseline *baseline; /* of findings */
    struct list tried;         /* what is handed on was read into these, and is a name or number */
    struct engine_options engines;
};

/* Adds every part that was requested. A part that fails is a part of the report; errors are only
 * those that end it: STATUS_INPUT what was given cannot be read; STATUS_MEMORY, STATUS_DEVICE. Ends
 * early, with STATUS_OK, after a signal. */
enum status report_make(const struct report_options *options, struct runner *runner,
                        struct report *report, struct reason *reason) MUST_USE;

/* Opens the scenes in a child, so that a wrong name is reported before the work. Returns an
 * exit code, with the reason if it is not EXIT_AGREE. */
int report_try_scenes(const struct report_options *options, struct runner *runner,
                      struct reason *reason);

/* Adds the pictures, a part for each scene. Errors: as report_make. */
enum status report_make_pictures(const struct report_options *options, struct runner *runner,
                                 struct report *report, struct reason *reason) MUST_USE;

/* True if the command of a line, with what else is handed on to it, uses an option. */
bool report_line_uses(const struct line *line, const struct report_options *options, unsigned to,
                      const char *flag);

/* Refuses what was given that no part uses. -1: nothing; else an exit code, and a line was printed.
 */
int report_check_use(const struct report_options *options);

/* Adds the options that commands of `to` take and this line uses; a flag with its value. */
void report_pass_on(struct line *line, const struct report_options *options, unsigned to);
void report_option(struct line *line, const char *flag, const char *value);

/* Adds --layout, and the shader of one from outside. */
void report_layout(struct line *line, const char *name);

/* The user's value of an option that is handed on to commands of `to`, or NULL. */
const char *report_passed(const struct report_options *options, unsigned to, const char *flag);

#endif
