/* The campaign of truth, over scenes or over worlds. */
#ifndef TRUTH_H
#define TRUTH_H

#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_rows.h"
#include "ref/base/command.h"
#include "scenes/rays/rays.h"
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

/* A scene or world that contestants play on, with one set of rays. */
struct truth_seat {
    struct truth_campaign *campaign;
    const char *spec, *rays;
    void *ground;
    size_t *count; /* of the ground's rays */
    enum status (*play)(const void *ground, const struct tally_contestant *who, struct pool *pool,
                        struct tally *tally, struct play_result *out, struct reason *reason);
};

/* Adds what became of a contestant, or the failure of its engine. `where`: spec and rays. */
void truth_count(struct truth_campaign *c, const char *where, const struct tally_contestant *who,
                 enum truth_group group, enum status status, const struct play_result *result,
                 const struct reason *reason);

/* Has a contestant play one ray in `share`, and adds what became of it, or the failure of its
 * engine. */
void truth_play(const struct truth_seat *seat, const struct tally_contestant *who,
                enum truth_group group, uint32_t share);

/* Has cpu and vulkan play with both pairs of tests on all layouts; layouts as published get one
 * ray in PUBLISHED_SHARE. */
void truth_play_own(const struct truth_seat *seat);

/* Calls `one` with each set of rays, in parts of at most BATCH. Errors: those of `one`. */
enum status truth_each_set(struct truth_campaign *c, void *ground,
                           enum status (*one)(struct truth_campaign *c, void *ground,
                                              const struct ray_set *set, size_t count,
                                              uint64_t seed, struct reason *reason),
                           struct reason *reason) MUST_USE;

#endif
