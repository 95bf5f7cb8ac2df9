/* The axes of compilers and of ways to read memory: --compiler, --decorate and --buffers put
 * engines with other shaders in the place of those with the build's (gpu/engines/compiled.h). For
 * commands only. */
#ifndef CMD_COMPILER_H
#define CMD_COMPILER_H

#include "cmd/common/cmd_screen.h"

/* Values of the options. */
struct compiler_options {
    const char *list;   /* NULL: none was named */
    const char *memory; /* likewise */
    size_t decorate;    /* enum decorate */
};

extern const struct option_row compiler_rows[];

/* Replaces each engine of the list that has shaders to compile by itself in each way and under
 * each compiler that is named, in their order; does nothing without --compiler and --buffers. An
 * empty list, or one of which none was `named` by the user, stands for all engines, of which those
 * with shaders alone are left. Call it before options_check. Returns -1 to continue, else the exit
 * code, after the reason was printed: EXIT_SKIPPED a tool is missing; EXIT_USAGE no such compiler
 * or way, one twice, no engine that has shaders, --decorate alone. */
int compilers_apply(const char *command, const struct compiler_options *options, bool named,
                    struct list *engines);

/* Prints a line for each engine with compiled shaders among the rows: NoContraction kept of
 * demanded, bits as the build's shaders have them, WRONG and the speed beside theirs. Nothing
 * without any. `title` is of the rows; `driver` that of --driver, or NULL. */
void compilers_print(const struct row *row, size_t count, const char *title, const char *driver,
                     const struct screen *screen);

#endif
