/* Shared by the files of raydiff replay. Commands only. */
#ifndef FUZZ_CMD_REPLAY_H
#define FUZZ_CMD_REPLAY_H

#include "cmd/common/cmd_screen.h"
#include "cmd/common/cmd_tables.h"
#include "ref/outside/child.h"
#include "fuzz/findings/finding_file.h"
#include "fuzz/findings/findings.h"
#include "fuzz/play/player.h"
#include "ref/match/turnout.h"

#define REPLAY_REASON 200

/* The result of a contestant on a file. */
enum replay_fate {
    REPLAYED,
    REPLAY_SKIPPED, /* the engine cannot run here */
    REPLAY_REFUSED, /* the trial exceeds a limit of the layout or the engine */
    REPLAY_CRASHED,
    REPLAY_HUNG,
    REPLAY_FAILED, /* harness error: out of memory, a contradiction */
};

struct replay_played {
    struct fuzz_contestant who;
    enum replay_fate fate;
    char reason[REPLAY_REASON]; /* set unless REPLAYED */
    struct fuzz_finding finding[FUZZ_FINDINGS_MOST];
    size_t finding_count;
    size_t expected;          /* index of the finding that the file expects; finding_count: none */
    bool crashed_as_expected; /* a crash or hang that the file expects */
};

/* A file and its results. */
struct replay_file {
    const char *path;
    struct finding_file file;
    struct replay_played played[FUZZ_CONTESTANTS_MOST];
    size_t played_count;
    bool refused; /* the signature's engine or layout refused, so nothing was played */
    bool fails;   /* its signature still shows; for a clean file: any finding shows */
    int code;
    char now[1024]; /* current versions */
};

struct replay_options {
    struct list engine, layout; /* empty layout: the file's */
    bool any_engine;            /* --engine was given: ignore the signature's engine */
    struct engine_options engines;
    unsigned seconds;
    bool brief, as_expected;
    const char *json;
    struct screen_options screen;
};

/* Finds the engine of the file's signature. Errors: STATUS_INPUT it is not available; *out is
 * NULL. */
enum status replay_engine(const struct finding_file *file, const struct engine **out,
                          struct reason *reason) MUST_USE;

/* True if the finding is what the file expects. An engine or layout named by an option replaces the
 * signature's; of a named engine without a layout the kind alone is compared, if the signature has
 * one, since causes within a layout are none of it. */
bool replay_is_expected(const struct replay_options *options, const struct finding_file *file,
                        const struct fuzz_signature *found);

/* Writes the judge's line on a finding of the trial, or "" if its answer was not judged wrong. */
void replay_finding_line(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                         char *text, size_t size);

/* Writes the command that replays a file, with --engine if it is required, as for a pipe: peer.
 * `engine` may be NULL. */
void replay_command(const char *path, const struct engine *engine, const struct layout *layout,
                    char *text, size_t text_bytes);

/* Appends the external layouts used by findings of the folder, with their shaders: raydiff cannot
 * read the findings without them. */
void replay_plugins(const struct findings *findings, char *text, size_t text_bytes);

/* A child process that plays, so that an engine that crashes or hangs ends only the child. */
struct replay_worker {
    const struct replay_options *options;
    struct replay_file *files; /* read before the fork, so the child has them too */
    struct child child;
};

/* Plays a contestant on file `i`. Sets fate, reason and findings of *played. */
void replay_play(struct replay_worker *worker, size_t i, struct replay_played *played);

/* Prints the page of a finding from the child; false if there is no page. */
bool replay_page(struct replay_worker *worker, size_t i, const struct fuzz_contestant *who,
                 uint32_t ray);

/* Sets `now` of file `i`; the child describes the engines. */
void replay_versions(struct replay_worker *worker, size_t i);

/* Ends the child, if one was started. */
void replay_end(struct replay_worker *worker);

/* Prints one file's results without pages; briefly if `brief`. */
void replay_print(const struct screen *screen, bool brief, const struct replay_file *file);

/* Errors: STATUS_INPUT the file cannot be written; STATUS_MEMORY. */
enum status replay_write_json(const char *path, const struct replay_file *file, size_t count,
                              const struct turnout *turnout, int code,
                              struct reason *reason) MUST_USE;

#endif
