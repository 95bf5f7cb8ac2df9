/* Findings as check and conform print them: what was answered, what was expected, and the command
 * that explains it. For commands only. */
#ifndef CMD_FINDING_H
#define CMD_FINDING_H

#include "cmd/common/cmd_explain_line.h"

/* Prints a finding of the row: a line that begins with "WRONG" and its kind or with "BITS", the
 * ray, the answer and what was expected; then, where raydiff explain can say more, a line with its
 * command.
 *   spec, seed   the scene and the seed of generators, as a user named them
 *   driver       of --driver, or NULL */
void finding_print(const struct row *row, const struct finding *finding, const char *spec,
                   uint64_t seed, const char *driver);

/* Writes the ray, the answer and what was expected on one line. */
void finding_line(const struct finding *finding, char *line, size_t line_bytes);

/* Writes only the command, "raydiff explain SCENE --ray '...' ...", at most EXPLAIN_COMMAND_MOST
 * bytes; false if there is nothing that it could explain. Of a list of all hits: the closest hit of
 * the same ray from just before the place at fault on. */
bool finding_command(const struct row *row, const struct finding *finding, const char *spec,
                     uint64_t seed, const char *driver, char text[EXPLAIN_COMMAND_MOST]);

#endif
