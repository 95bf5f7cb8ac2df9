/* What the parts of raydiff replay share. For commands only. */
#ifndef FUZZ_CMD_REPLAY_H
#define FUZZ_CMD_REPLAY_H

#include "cmd/common/cmd_tables.h"
#include "ref/outside/child.h"
#include "fuzz/findings/finding_file.h"
#include "fuzz/findings/findings.h"
#include "fuzz/play/player.h"
#include "ref/match/turnout.h"

#define REPLAY_REASON 200

/* How a contestant fared on a file. */
enum replay_fate {
    REPLAYED,
    REPLAY_SKIPPED, /* the engine cannot run here */
    REPLAY_REFUSED, /* the layout or the engine cannot hold the trial */
    REPLAY_CRASHED,
    REPLAY_HUNG,
    REPLAY_FAILED, /* the harness did: no memory, a contradiction */
};

struct replay_played {
    struct fuzz_contestant who;
    enum replay_fate fate;
    char reason[REPLAY_REASON]; /* unless REPLAYED */
    struct fuzz_finding finding[FUZZ_FINDINGS_MOST];
    size_t finding_count;
    size_t expected;          /* index of the finding that the file expects, else finding_count */
    bool crashed_as_expected; /* likewise of a crash or hang */
};

/* A file, and what came of it. */
struct replay_file {
    const char *path;
    struct finding_file file;
    struct replay_played played[FUZZ_CONTESTANTS_MOST];
    size_t played_count;
    bool refused; /* the signature's engine or layout refused: nothing was played */
    bool fails;   /* its signature is still there; of a clean one: anything */
    int code;
    char now[1024]; /* versions */
};

struct replay_options {
    struct list engine, layout; /* no layout: the file's */
    bool any_engine;            /* --engine was given: the signature's engine does not matter */
    struct engine_options engines;
    unsigned seconds;
    bool brief, as_expected;
    const char *json;
};

/* The engine of the file's signature. Errors: STATUS_INPUT it is not here, and *out is NULL. */
enum status replay_engine(const struct finding_file *file, const struct engine **out,
                          struct reason *reason) MUST_USE;

/* True if the finding is what the file expects, with another engine or layout where one was
 * named. */
bool replay_is_expected(const struct replay_options *options, const struct finding_file *file,
                        const struct fuzz_signature *found);

/* The line of the judge on a finding of the trial, or "" if its answer was not judged wrong. */
void replay_finding_line(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                         char *text, size_t size);

/* Writes the command that plays a file again; one that needs an engine named, as a pipe: peer, has
 * it. `engine` may be NULL. */
void replay_command(const char *path, const struct engine *engine, const struct layout *layout,
                    char *text, size_t text_bytes);

/* Appends the layouts from outside that findings of the folder are on, with their shaders:
 * raydiff cannot read the findings without them. */
void replay_plugins(const struct findings *findings, char *text, size_t text_bytes);

/* A child process that plays: an engine that crashes or hangs takes only it along. */
struct replay_worker {
    const struct replay_options *options;
    struct replay_file *files; /* read before the child is made, so that it has them too */
    struct child child;
};

/* Plays a contestant on file `i`: sets fate, reason and findings of *played. */
void replay_play(struct replay_worker *worker, size_t i, struct replay_played *played);

/* The child prints the page of a finding; false if there is none. */
bool replay_page(struct replay_worker *worker, size_t i, const struct fuzz_contestant *who,
                 uint32_t ray);

/* Sets `now` of a file; the child describes the engines. */
void replay_versions(struct replay_worker *worker, size_t i);

/* Ends the child, if there is one. */
void replay_end(struct replay_worker *worker);

/* Prints one file's results, but pages. */
void replay_print(const struct replay_options *options, const struct replay_file *file);

/* Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status replay_write_json(const char *path, const struct replay_file *file, size_t count,
                              const struct turnout *turnout, int code,
                              struct reason *reason) MUST_USE;

#endif
