/* The oriented box of a node where a traversal ended, of layouts that have such boxes: as text,
 * JSON and HTML. */
#ifndef CMD_EXPLAIN_ORIENTED_H
#define CMD_EXPLAIN_ORIENTED_H

#include "bench/report/report_html.h"
#include "ref/explain/explain.h"

#include <jansson.h>
#include <stdio.h>

/* Prints its axes, bounds and slabs, if it is there; in 80 columns, unless `wide`. */
void explain_oriented_print(FILE *out, const struct explain_oriented *oriented, bool wide);

/* Null if it is not there. The caller owns it. */
json_t *explain_oriented_json(const struct explain_oriented *oriented);

/* Writes the bounds as a table, if it is there. */
void explain_oriented_html(struct html *html, const struct explain_oriented *oriented);

#endif
