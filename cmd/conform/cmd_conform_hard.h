/* raydiff conform --hard: the hard cases on every member. For commands only. */
#ifndef CMD_CONFORM_HARD_H
#define CMD_CONFORM_HARD_H

#include "cmd/common/cmd_tables.h"
#include "ref/engine.h"
#include "ref/match/match.h"

/* The options of raydiff conform. */
struct conform_options {
    const char *pattern, *junit, *waivers, *markdown, *html; /* each may be NULL */
    bool list_only, verbose, tap, hard, summary, quick;
    struct list list[TABLE_COUNT],
        require; /* of each table those to be played; none: the default */
    bool all;
    struct match_demands demands;
    uint64_t count, brute;
    struct engine_options engines;
};

/* Plays the hard cases that the pattern names and prints; returns the exit code.
 *   named  of each table those that must answer something */
int conform_hard(const struct conform_options *options, const struct list named[TABLE_COUNT]);

#endif
