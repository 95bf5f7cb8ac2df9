/* The campaign of truth, over scenes or over worlds. */
#ifndef TRUTH_H
#define TRUTH_H

#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_rows.h"
#include "ref/base/command.h"
#include "tests/truth/play.h"

struct truth_options {
    uint64_t rays, seed;
    const char *out;
    bool worlds;
    struct engine_options engines;
};

/* Contestants that share a line of the table. */
enum truth_group { GROUP_MT, GROUP_WOOP, GROUP_FAST, GROUP_OTHERS, GROUP_PUBLISHED, GROUP_COUNT };

struct truth_campaign {
    struct truth_options options;
    struct pool pool;
    struct tally tally;
    struct progress progress;
    struct play_result sum[GROUP_COUNT];
    size_t refused, unfinished, scenes, left_out;
    int code;
};

/* Rays are made, traced and judged in parts of so many. */
#define BATCH 250000u
/* Layouts as published, which are known to be wrong, get this part of the rays. */
#define PUBLISHED_SHARE 500u

/* Opens a scene or world and plays all contestants on it. */
typedef enum status truth_plays(struct truth_campaign *c, const char *spec, struct reason *reason);
truth_plays truth_play_scene, truth_play_world;

/* Plays the engine that the finding of a world in a file names, and prints what became of it. */
truth_plays truth_play_trial;

/* NULL-terminated. */
extern const char *const truth_scenes[], *const truth_worlds[];

/* The sets of rays, and how many there are. */
#define TRUTH_SETS 5
extern const char *const truth_rays[TRUTH_SETS];

/* Adds what became of a contestant, or the failure of its engine. `where` is spec and rays. */
void truth_count(struct truth_campaign *c, const char *where, const struct tally_contestant *who,
                 enum truth_group group, enum status status, const struct play_result *result,
                 const struct reason *reason);

/* Calls `one` for cpu and vulkan with both pairs of tests on all layouts; `share` is the part of
 * the rays that it gets, 1 or PUBLISHED_SHARE. */
void truth_own(void *self, void (*one)(void *self, const struct tally_contestant *who,
                                       enum truth_group group, uint32_t share));

#endif
