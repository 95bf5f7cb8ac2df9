/* raydiff conform --worlds: a covering array of worlds. Commands only. */
#ifndef CMD_CONFORM_WORLDS_H
#define CMD_CONFORM_WORLDS_H

#include "cmd/conform/cmd_conform_report.h"

/* Plays the trials that the pattern selects and prints them, or lists them. Returns the exit code.
 *   named  per table, members that must answer something */
int conform_worlds(const struct conform_options *options, const struct list named[TABLE_COUNT]);

#endif
