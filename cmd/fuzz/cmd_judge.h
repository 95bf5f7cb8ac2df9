/* Shared by raydiff judge and verify. For commands only. */
#ifndef CMD_JUDGE_H
#define CMD_JUDGE_H

#include "cmd/check/cmd_check.h"
#include "ref/outside/pipe_text.h"

struct judge_options {
    uint64_t seed, brute;
    struct match_demands demands;
    struct screen_options screen;
    const char *json;
};

/* A judgement. Owns everything except the names. */
struct judge_run {
    const char *command;
    const struct judge_options *options;
    const char *spec, *ray_name; /* names of scene and rays as given by the user */
    const char *modes;           /* of a world: what rays may meet */
    uint64_t seed;
    struct check_subject of;  /* its scene or world */
    struct pipe_text request; /* rays and query */
    struct pipe_text answer;
};

/* Judges and prints, or prints why the input could not be read. Returns the exit code. */
int judge_finish(struct judge_run *j, enum status status, const struct reason *reason);

#endif
