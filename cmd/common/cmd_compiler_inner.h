/* What the files of the axis of compilers share. */
#ifndef CMD_COMPILER_INNER_H
#define CMD_COMPILER_INNER_H

#include "cmd/common/cmd_compiler.h"

/* The rows of compiled engines that ran, and all rows. */
struct compiled_rows {
    const struct row *all;
    size_t all_count;
    const struct row **row; /* of them `count` */
    size_t count;
};

/* The speed of row i beside the shaders as built; 0: they were not played. */
double compiled_speed(const struct compiled_rows *rows, size_t i);

/* True if its answers have the bits of the shaders as built, each of them. */
bool compiled_equal(const struct row *row);

/* Prints a line for each compiler and engine that has several rows, with their sums. Nothing if
 * there is none. Errors: STATUS_MEMORY. */
enum status compiled_sums_print(const struct compiled_rows *rows,
                                const struct screen *screen) MUST_USE;

#endif
