/* What raydiff explain and its page share. For commands only. */
#ifndef CMD_EXPLAIN_H
#define CMD_EXPLAIN_H

#include "cmd/common/cmd_explain_line.h"
#include "ref/explain/judged.h"

struct explain_decode; /* cmd/explain/cmd_explain_inner.h */

/* One explained ray with everything a page needs; borrowed. */
struct explain_page {
    const struct explain_of *of;
    const struct scene *scene;
    const struct judged *judged;
    const struct judged_ray *ray;
    const char *rays; /* set it comes from, or NULL */
    size_t index, count;
    const char *again; /* command that shows the page again, NULL: raydiff explain */
    const struct explain_decode *decode; /* or NULL */
};

/* Prints the page for a person. */
void explain_print(const struct explain_page *page);

/* Writes it as JSON. Errors: STATUS_INPUT cannot write, STATUS_MEMORY. */
enum status explain_write_json(const char *path, const struct explain_page *page, int exit_code,
                               struct reason *reason) MUST_USE;

/* True if the answer is not what it should be: not allowed, or other bits than C's. */
static inline bool explain_is_wrong(const struct judged_ray *ray)
{
    return ray->why.cause != CAUSE_NONE;
}

#endif
