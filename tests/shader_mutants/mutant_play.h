/* Plays mutants: each in a process of its own, for it may hang or end its driver. */
#ifndef MUTANT_PLAY_H
#define MUTANT_PLAY_H

#include "tests/shader_mutants/mutant_cases.h"
#include "tests/shader_mutants/spirv_mutant.h"

enum mutant_end {
    MUTANT_KILLED,
    MUTANT_SURVIVED,
    MUTANT_INVALID, /* spirv-val refuses it */
    MUTANT_ABSENT   /* no device can be opened */
};

/* How one ended. */
struct mutant_played {
    enum mutant_end end;
    char by[CASE_NAME + 16]; /* what killed it; "hangs" or "crashes" behind it */
    size_t played;           /* cases */
    double seconds;
};

/* What killed those before: of the same function it comes first. */
struct mutant_history {
    struct mutant_kills {
        char function[MUTANT_FUNCTION];
        uint32_t *of_case, *of_pipeline;
    } * function;
    size_t count, capacity;
    uint32_t *of_case, *of_pipeline; /* of all functions */
};

/* Plays the shader as built, and keeps what each case comes to. Cases that hang or crash it are
 * left out. Errors: STATUS_UNSUPPORTED no device; STATUS_MEMORY. */
enum status mutant_play_built(struct mutant_cases *cases, struct reason *reason) MUST_USE;

/* Plays one mutant on the cases whose pipeline can reach it, until one of them comes to another
 * end. `most`: so many pipelines at most; 0: all. Errors: STATUS_MEMORY. */
enum status mutant_play(struct mutant_cases *cases, const struct spirv_mutant *mutant, size_t most,
                        struct mutant_history *history, struct mutant_played *out,
                        struct reason *reason) MUST_USE;

#endif
