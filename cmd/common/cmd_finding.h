/* Findings as check and conform print them: the answer, what was expected, and the command that
 * explains it. For commands only. */
#ifndef CMD_FINDING_H
#define CMD_FINDING_H

#include "cmd/common/cmd_explain_line.h"
#include "cmd/common/cmd_screen.h"

/* Prints a finding of the row: a record with "WRONG" and its kind, or "BITS", then the ray, the
 * answer and what was expected. Of a world, lines with mask and flags of the ray and where both
 * triangles are. If raydiff explain can explain it, a last line has the command, which is long; a
 * terminal has only that of the `first` of a row, unless `screen` is wide.
 *   spec, seed   the scene and the seed of generators, as a user named them
 *   driver       from --driver, or NULL */
void finding_print(const struct screen *screen, const struct row *row,
                   const struct finding *finding, const char *spec, uint64_t seed,
                   const char *driver, bool first);

/* Writes the ray, the answer and the expected answer on one line. */
void finding_line(const struct finding *finding, char *line, size_t line_bytes);

/* Writes only the command, "raydiff explain SCENE --ray '...' ...", at most EXPLAIN_COMMAND_MOST
 * bytes. Returns false if the command could not explain the finding. For a list of all hits, it
 * explains the closest hit of the same ray from just before the faulty hit on. */
bool finding_command(const struct row *row, const struct finding *finding, const char *spec,
                     uint64_t seed, const char *driver, char text[EXPLAIN_COMMAND_MOST]);

#endif
