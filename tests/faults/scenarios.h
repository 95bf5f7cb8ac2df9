/* The commands whose system calls fail. */
#ifndef FAULTS_SCENARIOS_H
#define FAULTS_SCENARIOS_H

#include <stdbool.h>
#include <stddef.h>

/* A command, in a folder of its own. */
struct scenario {
    const char *name;
    const char *before[4]; /* commands that make what it starts from, with results of their own */
    const char *command;
    const char *goal;   /* what it writes; NULL: what it starts from is changed */
    bool page;          /* its goal is a file, which comes whole or not at all */
    int processes;      /* only calls of the first ones fail: what later ones do is the business of
                           drivers, and what they end of is a result; 0: of all */
    const char *sample; /* it is slow: of a sample only the faults of this pattern, each sixth */
    unsigned every;     /* each `every`-th occurrence of a call, and the first; 0: each */
};

extern const struct scenario scenarios[];
extern const size_t scenario_count;

#endif
