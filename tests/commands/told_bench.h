/* A bench whose rows are looked at. */
#ifndef TESTS_TOLD_BENCH_H
#define TESTS_TOLD_BENCH_H

#include "cmd/bench/cmd_bench.h"

#include "tests/commands/told.h"

/* A bench that keeps its rows. */
static inline struct bench bench_made(bool wide)
{
    return (struct bench){
        .rounds = 3, .seed = 5, .screen_is = {.width = 4000, .wide = wide}, .rows = json_array()};
}

#endif
