/* What the suites ask of one shader: the trials of `raydiff conform` and the hard cases whose
 * pipelines are made of it. They are prepared once, with engine cpu or brute, so that trees, exact
 * answers and C's bits are there before a mutant's process begins. */
#ifndef MUTANT_CASES_H
#define MUTANT_CASES_H

#include "cmd/conform/cmd_conform_suite.h"
#include "gpu/trace/dispatch.h"
#include "tests/hard/members.h"

#define CASE_NAME 160

/* One pipeline of the shader. */
struct mutant_pipeline {
    uint32_t constant[DISPATCH_CONSTANTS]; /* but for the workgroup's size and the stack's */
    bool *live;                            /* of each instruction */
};

struct mutant_case {
    char name[CASE_NAME];         /* by which raydiff conform plays it */
    const struct hard_case *hard; /* NULL: a trial */
    struct hard_member member;    /* of a hard case */
    struct trial trial;
    size_t stage, pipeline;
    int passes; /* what the shader as built gives, see mutant_case_play */
};

struct mutant_cases {
    const struct shader *shader;
    const struct engine *engine;
    struct spirv_code *code; /* borrowed */
    struct mutant_case *one;
    size_t count, capacity;
    struct trial_stage **trial;
    size_t trial_count, trial_capacity;
    struct hard_stage **hard;
    size_t hard_count, hard_capacity;
    struct mutant_pipeline *pipeline;
    size_t pipeline_count, pipeline_capacity;
};

/* Collects and prepares them: of "trace_f32" all of engine vulkan on layouts with that shader, of
 * "stackless_f32" those of vulkan_stackless, of "trace_brute" those of vulkan_brute. `quick`: a
 * handful, for a test of the tests. Everything lives until the process ends. Errors: STATUS_INPUT
 * no such shader; those of conform. */
enum status mutant_cases_make(const char *shader, bool quick, struct spirv_code *code,
                              struct mutant_cases *out, struct reason *reason) MUST_USE;

/* Plays one with the engines of `pool`. Returns what it came to: equal numbers are equal ends. */
int mutant_case_play(struct mutant_cases *cases, size_t i, struct pool *pool);

#endif
