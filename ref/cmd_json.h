/* JSON files as the commands write them: whole or not at all. For commands only. */
#ifndef CMD_JSON_H
#define CMD_JSON_H

#include "ref/base.h"

#include <jansson.h>

/* Writes `root`, which is taken over and may be NULL (no memory for it), to `path` (options_out),
 * reals with so many digits. Errors: STATUS_MEMORY; STATUS_INPUT cannot write. */
enum status json_write(const char *path, json_t *root, unsigned digits,
                       struct reason *reason) MUST_USE;

#endif
