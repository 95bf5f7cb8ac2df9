/* Findings as check and conform print them: the answer, what was expected, and the command that
 * explains it. For commands only. */
#ifndef CMD_FINDING_H
#define CMD_FINDING_H

#include "cmd/common/cmd_explain_line.h"
#include "cmd/common/cmd_screen.h"

/* What a row is of, as a user named it. */
struct finding_of {
    const char *spec;       /* the scene */
    uint64_t seed;          /* of generators and rays */
    const char *driver;     /* from --driver, or NULL */
    struct explain_set set; /* the rays */
};

/* Prints a finding of the row: a record with "WRONG" and its kind, or "BITS", then the ray, the
 * answer and what was expected. Of a world, lines with mask and flags of the ray and where both
 * triangles are. If raydiff explain can explain it, a last line has the command, which is long; a
 * terminal has only that of the `first` of a row, unless `screen` is wide. */
void finding_print(const struct screen *screen, const struct row *row,
                   const struct finding *finding, const struct finding_of *of, bool first);

/* Writes the ray, the answer and the expected answer on one line. */
void finding_line(const struct finding *finding, char *line, size_t line_bytes);

/* Writes only the command, "raydiff explain SCENE --ray '...' ...", at most EXPLAIN_COMMAND_MOST
 * bytes. Returns false if the command could not explain the finding. The answers of a tracer of
 * one's own may depend on the rays beside: its command names the set and the ray in it. Of a list
 * of all hits, the command is that of the list, or, where the walk of an engine can be shown, of
 * the closest hit of the same ray from just before the faulty hit on. */
bool finding_command(const struct row *row, const struct finding *finding,
                     const struct finding_of *of, char text[EXPLAIN_COMMAND_MOST]);

#endif
