/* Shared by the sections of a report. */
#ifndef REPORT_INNER_H
#define REPORT_INNER_H

#include "bench/chart/json_value.h"
#include "bench/report/report.h"
#include "bench/report/report_html.h"

/* Write the sections, in the order of the page. */
void report_summary(struct html *html, const struct report *report);
void report_agreement(struct html *html, const struct report *report);
enum status report_speed(struct html *html, const struct report *report,
                         struct reason *reason) MUST_USE;
void report_pictures(struct html *html, const struct report *report);
void report_findings(struct html *html, const struct report *report);
void report_machine(struct html *html, const struct report *report);
void report_commands(struct html *html, const struct report *report);

/* The rows of check for one scene, shown as the matrix and the table below it. */
struct check_rows {
    const char *scene;
    const json_t *const *row;
    size_t count;
};
void report_matrix(struct html *html, const struct check_rows *rows);
void report_verdicts(struct html *html, const struct check_rows *rows);

/* The outcome of a row of check, and the CSS class of its cell. */
enum row_look { LOOK_GOOD, LOOK_PUBLISHED, LOOK_WRONG, LOOK_FAILED, LOOK_NONE };
enum row_look row_look(const json_t *row);
const char *look_class(enum row_look look);
size_t row_allowed(const json_t *row);

/* The id of the element that shows part `p`, a finding with a name. */
#define REPORT_ID 32
void report_finding_id(size_t p, char id[REPORT_ID]);

/* A list of the sections, and of the findings, as links. */
void report_contents(struct html *html, const struct report *report);

/* Begins a section with heading, number and anchor. */
void section_begin(struct html *html, const char *id, const char *title);
void section_end(struct html *html);

/* Prints a line with the reason for each part of a kind that has no result. If the section was not
 * requested, prints a line with `how` to get it. Returns whether there is anything to show. */
bool section_reasons(struct html *html, const struct report *report, enum report_kind kind,
                     const char *how);

void report_picture_free(struct report_picture *picture); /* frees its members */

/* Writes a cell with a number, empty if it is not finite. */
void report_number(struct html *html, const char *format, double value);

/* Runs of frames have "handlers" instead of rows. Errors: STATUS_MEMORY. */
bool report_is_frames(const json_t *json);
enum status report_frames(struct html *html, const json_t *json, struct reason *reason) MUST_USE;
size_t report_charts(const json_t *json); /* number of figures: 0 or 1 */

/* Number of figures in the page: plots (bench/chart/row_plot.h) and pictures. */
size_t report_figures(const struct report *report);

extern const char report_style[]; /* CSS */

#endif
