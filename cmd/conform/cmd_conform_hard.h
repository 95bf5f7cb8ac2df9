/* raydiff conform --hard: the hard cases on every member. For commands only. */
#ifndef CMD_CONFORM_HARD_H
#define CMD_CONFORM_HARD_H

#include "cmd/common/cmd_tables.h"
#include "ref/engine.h"

struct conform_hard_options {
    const char *pattern, *junit, *waivers, *markdown, *html; /* each may be NULL */
    bool list, verbose, tap, summary, quick;
    struct list engine, require;
    const struct list *list_of; /* of each table those to be played; none: the default */
    const struct list *named;   /* of each table those that must answer something */
    struct engine_options engines;
};

/* Plays what the pattern names and prints; returns the exit code. */
int conform_hard(const struct conform_hard_options *options);

#endif
