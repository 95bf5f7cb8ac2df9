/* Shared by raydiff explain and its page. Commands only. */
#ifndef CMD_EXPLAIN_H
#define CMD_EXPLAIN_H

#include "cmd/common/cmd_explain_line.h"
#include "cmd/common/cmd_screen.h"
#include "ref/explain/judged.h"

struct explain_decode; /* cmd/explain/cmd_explain_inner.h */
struct finding_file;   /* fuzz/findings/finding_file.h */
struct html;           /* bench/report/report_html.h */

/* One explained ray with everything its page needs. All pointers are borrowed. */
struct explain_page {
    const struct explain_of *of;
    const struct scene *scene;
    const struct judged *judged;
    const struct judged_ray *ray;
    const char *rays; /* the ray set it comes from, or NULL */
    size_t index, count;
    const char *again; /* command that shows the page again; NULL: raydiff explain */
    const struct explain_decode *decode; /* or NULL */
    const char *built; /* how a device's tree differs from C's; NULL or "": it does not */
    struct screen screen;
    /* Only for explain_show_fn: all `count` rays, and their file; NULL: those of a scene. */
    const struct ray *all;
    const struct finding_file *file;
};

/* Prints the page as text. Commands are in one line. */
void explain_print(const struct explain_page *page);

/* Writes the page as JSON. Errors: STATUS_INPUT cannot write, STATUS_MEMORY. */
enum status explain_write_json(const char *path, const struct explain_page *page, int exit_code,
                               struct reason *reason) MUST_USE;

/* Writes the page as HTML: one file that fetches nothing. Errors: STATUS_INPUT cannot write,
 * STATUS_MEMORY. */
enum status explain_write_html(const char *path, const struct explain_page *page,
                               struct reason *reason) MUST_USE;

/* The parts of that page, for another one: its style, the verdict on the answer (a heading and two
 * lines), and the numbers: the node, the ray, the path, what was tried, the command. */
extern const char explain_html_style[];
void explain_html_verdict(struct html *html, const struct explain_page *page);
void explain_html_numbers(struct html *html, const struct explain_page *page);

/* How a box test on the path ended, and what is wrong with a bound ("": nothing). Static. */
const char *explain_note_text(const struct replay_note *note);
const char *explain_fault_text(enum bound_fault fault);

/* What stands before an opinion's text: "wrong, ", "allowed, ", or nothing if it is right. */
const char *explain_opinion(const struct opinion *opinion);

/* True if the answer is wrong: not allowed, or with other bits than C's. */
static inline bool explain_is_wrong(const struct judged_ray *ray)
{
    return ray->why.cause != CAUSE_NONE;
}

#endif
