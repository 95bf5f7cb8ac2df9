/* The parts of a report: which commands are run with which options. Commands only. */
#ifndef CMD_REPORT_PARTS_H
#define CMD_REPORT_PARTS_H

#include "cmd/common/cmd_rows.h"
#include "cmd/report/cmd_report.h"

struct baseline; /* fuzz/findings/baseline.h */

/* The scenes used if none is named and no results are given. */
#define REPORT_DEFAULT_SCENES      "cornell", "sphere:n=20", "soup:n=1000"
#define REPORT_DEFAULT_SCENES_TEXT "cornell sphere:n=20 soup:n=1000"

#define REPORT_SCENES  16 /* the limit of bench */
#define REPORT_PASSED  32
#define FINDINGS_SHOWN 24
#define PICTURES_GIVEN 64
#define PICTURE_SCENES 2
#define FILES_GIVEN    16
#define FOLDERS_GIVEN  16

/* An option passed on unchanged; `to` is the set of commands that take it. A shader is passed
 * together with its layout, also where only one of several layouts is passed. */
enum { TO_CHECK = 1, TO_ERROR = 2, TO_OTHERS = 4, TO_PICTURES = 8, TO_LAYOUTS = 16, TO_ALL = 31 };
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
    bool wanted[REPORT_KINDS]; /* from --parts */
    bool quick;
    uint64_t count, rounds; /* 0: the default */
    uint64_t seconds;       /* time limit of a part */
    const char *title, *out, *json;
    const char *findings[FOLDERS_GIVEN];
    size_t findings_count;
    const char *web; /* pages of raydiff web, beside the report; NULL: none */
    const char *check[FILES_GIVEN], *bench[FILES_GIVEN], *doctor; /* existing results */
    size_t check_count, bench_count;
    char *picture[PICTURES_GIVEN]; /* TITLE=FILE */
    size_t picture_count;
    struct baseline *baseline; /* for findings */
    struct list tried;         /* validates options that are passed on */
    struct engine_options engines;
};

/* Adds every requested part. A part that fails is shown as such in the report. Errors are only
 * those that end the report: STATUS_INPUT a given file cannot be read; STATUS_MEMORY,
 * STATUS_DEVICE. After a signal it returns early with STATUS_OK. */
enum status report_make(const struct report_options *options, struct runner *runner,
                        struct report *report, struct reason *reason) MUST_USE;

/* Opens the scenes in a child, so that a wrong name is reported before the work starts. Returns an
 * exit code, and the reason if it is not EXIT_AGREE. */
int report_try_scenes(const struct report_options *options, struct runner *runner,
                      struct reason *reason);

/* Adds the pictures, one part per scene. Errors: those of report_make. */
enum status report_make_pictures(const struct report_options *options, struct runner *runner,
                                 struct report *report, struct reason *reason) MUST_USE;

/* True if the command of a line, including the options passed on to it, uses the option. */
bool report_line_uses(const struct line *line, const struct report_options *options, unsigned to,
                      const char *flag);

/* Rejects options that no part uses. Returns -1 if there are none, else an exit code after printing
 * a line. */
int report_check_use(const struct report_options *options);

/* Adds the options that commands of `to` take and this line uses, as flag and value. */
void report_pass_on(struct line *line, const struct report_options *options, unsigned to);
void report_option(struct line *line, const char *flag, const char *value);

/* Adds --layout, and the shader of an external layout. */
void report_layout(struct line *line, const char *name);

/* The user's value of an option that is passed on to commands of `to`, or NULL. */
const char *report_passed(const struct report_options *options, unsigned to, const char *flag);

#endif
