/* JSON files as the commands write them: whole or not at all. For commands only. */
#ifndef CMD_JSON_H
#define CMD_JSON_H

#include "scenes/file.h"

#include <jansson.h>

/* Writes `root`, which is taken over and may be NULL (no memory for it), to `path`, reals with so
 * many digits. Errors: STATUS_MEMORY; STATUS_INPUT cannot write. */
enum status json_write(const char *path, json_t *root, unsigned digits,
                       struct reason *reason) MUST_USE;

/* The same to a file that is open already, or not yet (stream NULL); `path` is then opened. */
enum status json_write_to(struct file_out *out, const char *path, json_t *root, unsigned digits,
                          struct reason *reason) MUST_USE;

#endif
