/* Shrinks a trial while it still shows its finding: fewer instances, triangles, rays and vertices,
 * plainer transforms, then shorter numbers and plainer members. To "ask" is to play a candidate;
 * asks are counted. Deterministic: the result depends on the trial and the number of asks alone,
 * unless a time is given. */
#ifndef FUZZ_SHRINK_H
#define FUZZ_SHRINK_H

#include "fuzz/findings/finding_file.h"
#include "fuzz/play/player.h"

/* Enough asks for nearly all small trials to reach their fixpoint. */
#define SHRINK_ASKS 100000u

/* Most candidates in one call of a shrink_ask_fn. */
#define SHRINK_BATCH FUZZ_BATCH

/* Plays candidates, all valid trials (fuzz_trial_check): *first is the index of the first that
 * still shows the finding, or `count`. Errors end the shrinking. */
typedef enum status shrink_ask_fn(void *user, const struct fuzz_trial *candidate, size_t count,
                                  size_t *first, struct reason *reason);

enum shrink_end {
    SHRINK_FIXPOINT,    /* nothing smaller was found: shrinking again changes nothing */
    SHRINK_OUT_OF_ASKS, /* all are spent; or the rest costs too many, and then the same number of
                           asks again changes nothing */
    SHRINK_OUT_OF_TIME,
    SHRINK_NOT_SHOWN, /* the trial does not show the finding: nothing was done */
};

/* "fixpoint", "asks", "time", "not shown" */
const char *shrink_end_name(enum shrink_end end);

struct shrink_stats {
    struct fuzz_trial_size before, after;
    uint64_t asks; /* spent; a candidate is one, and one more per 64 triangles, rays or instances */
    uint64_t tried;    /* candidates played */
    uint64_t accepted; /* of them; each was smaller than the one before it */
    uint32_t rounds;
    enum shrink_end end;
    struct fuzz_finding finding; /* fuzz_shrink_finding: what the smallest trial shows, and on which
                                    ray */
};

struct shrink_options {
    uint64_t asks; /* the most that is spent, after the first; 0: SHRINK_ASKS */
    uint64_t ns;   /* the longest that it may take; 0: no end. Then the result is not the same on
                      every machine */
    /* Called now and then, NULL: never; `best` is the smallest so far. */
    void (*progress)(void *user, const struct shrink_stats *stats, const struct fuzz_trial *best);
    void *user; /* of progress */
};

/* Shrinks `from`. If it shows no finding, *out is a copy of it (SHRINK_NOT_SHOWN); the caller frees
 * *out. Its origin and recipe stay. Errors: STATUS_MEMORY; what `ask` fails with. On
 * error *out is zero. */
enum status fuzz_shrink_trial(const struct fuzz_trial *from, shrink_ask_fn *ask, void *user,
                              const struct shrink_options *options, struct fuzz_trial *out,
                              struct shrink_stats *stats, struct reason *reason) MUST_USE;

/* Shrinks a finding by playing it: what the trial shows is a finding of the same signature after
 * fuzz_explain, on whichever ray. `alone` is a player of one contestant, the signature's (an engine
 * of kind crash or hang must be one that survives that, such as a pipe: it is played in this
 * process). *out is `file` with the smaller trial, its signature and versions kept.
 * Errors: STATUS_INPUT the file has no signature, or not the player's engine and layout; those of
 * fuzz_play and fuzz_explain. On error *out is zero. */
enum status fuzz_shrink_finding(struct fuzz_player *alone, const struct finding_file *file,
                                const struct shrink_options *options, struct finding_file *out,
                                struct shrink_stats *stats, struct reason *reason) MUST_USE;

/* Where an engine is played that may crash or hang: in a child process. */
struct shrink_apart {
    struct fuzz_contestant who; /* the signature's engine and layout */
    struct engine_options engines;
    uint32_t ms;     /* the longest that a candidate may take; longer is FUZZ_KIND_HANG */
    uint64_t memory; /* bytes that the child may hold; more is FUZZ_KIND_CRASH; 0: any number */
};

/* As fuzz_shrink_finding, for every kind: a child that dies or hangs shows a finding of kind crash
 * or hang; a finding of another kind it does not show, and the shrinking continues. out->versions
 * are those of the engine as it is here. The caller has no threads that an engine would need
 * (ref/outside/child.h). Errors: as fuzz_shrink_finding; STATUS_UNSUPPORTED the engine cannot run
 * here; STATUS_DEVICE it cannot be opened, or no process to be had. */
enum status fuzz_shrink_apart(const struct shrink_apart *how, const struct finding_file *file,
                              const struct shrink_options *options, struct finding_file *out,
                              struct shrink_stats *stats, struct reason *reason) MUST_USE;

#endif
