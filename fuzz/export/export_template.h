/* The programs that `raydiff export` writes, as text: the files of fuzz/templates/, embedded by the
 * build. They are C, but for three things that are resolved while writing:
 *   #include "NAME"        is replaced by the template of that name
 *   #include "finding.h"   is replaced by the finding's own data
 *   #if EXPORT_NAME ... #else ... #endif   only the lines of what is written */
#ifndef FUZZ_EXPORT_TEMPLATE_H
#define FUZZ_EXPORT_TEMPLATE_H

#include <stdbool.h>
#include <stdio.h>

struct export_template {
    const char *name, *text;
};

/* The last one has the name NULL. */
extern const struct export_template export_templates[];

/* Writes what replaces #include "finding.h". */
typedef void export_data_fn(const void *user, FILE *to);

/* Writes template `name`.
 *   defined   NULL-terminated: the EXPORT_NAMEs that are true, without "EXPORT_" */
void export_template_write(const char *name, const char *const *defined, export_data_fn *data,
                           const void *user, FILE *to);

#endif
