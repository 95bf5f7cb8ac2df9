/* Shared by the files of raydiff fuzz. Commands only. */
#ifndef FUZZ_CMD_FUZZ_H
#define FUZZ_CMD_FUZZ_H

#include "fuzz/findings/baseline.h"
#include "fuzz/campaign/campaign.h"
#include "cmd/common/cmd_compiler.h"
#include "cmd/fuzz/cmd_fuzz_screen.h"

/* Options that decide what is found. They are saved in the folder, so that a resumed campaign uses
 * the same ones. */
enum fuzz_key {
    KEY_SEED,
    KEY_SHARD,
    KEY_ENGINE,
    KEY_LAYOUT,
    KEY_BUILDER,
    KEY_FAITHFUL,
    KEY_RAYS,
    KEY_TRIANGLES,
    KEY_DRIVER,
    KEY_DEVICE,
    KEY_WORKGROUP,
    KEY_PAIRS,
    KEY_WORLDS,
    KEY_TURNS,
    KEY_STEPS,
    KEY_COUNT
};

#define FUZZ_ENGINES "cpu,vulkan,embree_robust" /* the default: those of them that can run here */
#define FUZZ_LAYOUTS "f32,rf16"

#define FUZZ_PATH_MOST  4096
#define FUZZ_VALUE_MOST 1024

struct fuzz_command {
    uint64_t seed;
    uint32_t shard, shards; /* shards 0: not sharded */
    struct list engine, layout, builder;
    bool faithful, worlds, turns, steps;
    uint32_t rays, triangles_least, triangles_most;
    char driver[FUZZ_VALUE_MOST]; /* "": any */
    struct engine_options engines;
    struct compiler_options compilers;
    uint64_t trials, seconds;
    uint64_t pairs; /* draw members until each pair met in so many trials; 0: do not draw */
    uint32_t jobs, until;
    float trial_s;
    uint64_t memory_mib;
    bool feedback, no_shrink;
    const char *folder, *corpus, *json, *junit, *tap, *jsonl;
    /* Derived from the above. */
    char identity[FINDINGS_STATE_MOST];
    struct feedback_list corpus_trials;
    struct pair_coverage *pair_coverage;
    struct baseline baseline;
    char today[BASELINE_DAY];
    struct findings *findings;
    struct campaign_options campaign;
    char left_out[FUZZ_VALUE_MOST]; /* default engines that cannot run here, and why */
    /* Display. */
    bool terminal;
    struct fuzz_screen screen;
    uint64_t shown_ns, stats_ns;
    volatile sig_atomic_t *signalled; /* the signal that ended the campaign; 0: none */
    struct reason failed;             /* error of writing a report */
    enum status failed_status;
    int code;
};

/* Name of a key's option, such as "seed", and its value as it is saved. */
const char *fuzz_key_name(enum fuzz_key key);
void fuzz_key_print(const struct fuzz_command *command, enum fuzz_key key,
                    char text[FUZZ_VALUE_MOST]);
/* True if all layouts are selected, which is saved as "every". */
bool fuzz_has_every_layout(const struct fuzz_command *command);
/* The options of struct fuzz_command. */
extern const struct option_set fuzz_set;

/* Takes over the options of the folder's campaign, or builds the identity of a new one. Errors:
 * STATUS_INPUT an option that differs, another version of the generators, or a folder of something
 * else. */
enum status fuzz_identify(struct fuzz_command *command, struct reason *reason) MUST_USE;

/* Drops the default engines that cannot run here; a child process tries them. Errors:
 * STATUS_UNSUPPORTED none can run; those of child_start. */
enum status fuzz_default_engines(struct fuzz_command *command, struct reason *reason) MUST_USE;

/* Builds the rules and the counters of pair coverage. Errors: STATUS_INPUT no engine takes part;
 * STATUS_LIMIT; STATUS_MEMORY. */
enum status fuzz_pairs_make(struct fuzz_command *command, struct reason *reason) MUST_USE;
/* Number of pairs that met in fewer trials than --pairs; 1 if no pair can meet; 0 without
 * --pairs. */
uint32_t fuzz_pairs_short(const struct fuzz_command *command);
void fuzz_pairs_print(const struct fuzz_command *command, const struct campaign_view *view);
struct json_t *fuzz_pairs_json(const struct fuzz_command *command,
                               const struct campaign_view *view);

/* Shows the status when it is due. This is campaign_options.tick; user: struct fuzz_command. */
void fuzz_show(void *user, const struct campaign_view *view);
/* Clears the lines on the screen. */
void fuzz_show_end(struct fuzz_command *command);

/* Prints the table to stdout, writes the result files and sets command->code. This is the `end` of
 * campaign_run. */
void fuzz_report(void *user, const struct campaign_view *view);
/* Writes DIR/stats.json. */
enum status fuzz_stats(const struct fuzz_command *command, const struct campaign_view *view,
                       struct reason *reason) MUST_USE;

#endif
