/* raydiff conform --hard: the hard cases on every member. Commands only. */
#ifndef CMD_CONFORM_HARD_H
#define CMD_CONFORM_HARD_H

#include "cmd/conform/cmd_conform_report.h"
#include "ref/engine.h"

/* Plays the hard cases that the pattern selects and prints them. Returns the exit code.
 *   named  per table, members that must answer something */
int conform_hard(const struct conform_options *options, const struct list named[TABLE_COUNT]);

#endif
