/* A fuzzing campaign: worker processes play blocks of trials. Their parent keeps the findings in a
 * folder (fuzz/findings/findings.h), replaces workers that die or hang, and resumes after a kill.
 * The findings of the streams corpus and gen depend on the trials alone: not on the number of
 * workers, on shards, on kills, or on engines that crash. */
#ifndef FUZZ_CAMPAIGN_H
#define FUZZ_CAMPAIGN_H

#include "fuzz/feedback/feedback.h"
#include "fuzz/findings/findings.h"
#include "fuzz/feedback/pair_coverage.h"
#include "fuzz/campaign/worker.h"

#include <signal.h>

#define CAMPAIGN_JOBS_MOST   64u
#define CAMPAIGN_SHARDS_MOST 65536u
#define CAMPAIGN_AGAIN       5u /* times that what is not repeatable is played again, alone */
#define CAMPAIGN_TRIANGLES   1025u

enum campaign_shrinking {
    CAMPAIGN_SHRINK_NEVER,
    CAMPAIGN_SHRINK_SOON,  /* a new signature while trials are played, bounded in time */
    CAMPAIGN_SHRINK_AT_END /* every signature after all trials: the same on every machine, and
                              after any interruption. A run that ends before shrinks nothing */
};

struct campaign_view;

/* Everything borrowed. */
struct campaign_options {
    struct work_rules rules;
    const char *folder; /* of the findings */
    const char
        *identity;    /* begins the folder's state: the options that change trials or findings */
    uint64_t trials;  /* of the whole campaign, all shards together; 0: no end */
    uint64_t seconds; /* of this run; 0: no end */
    uint32_t shard, shards; /* 1 of 1: all */
    uint32_t jobs;          /* workers */
    bool mutate;            /* stream mut, too: half of the blocks */
    /* Counts which pairs of members met, or NULL. The members of a drawn field are drawn from it,
     * once a block; there is then stream gen alone, and one shard. */
    struct pair_coverage *pair_coverage;
    enum campaign_shrinking shrink;
    uint32_t until;        /* end after that many findings that are not known; 0: no end */
    uint32_t trial_ms;     /* the longest that an engine may take for a trial */
    uint64_t memory_bytes; /* the most that a worker may hold; 0: any */
    /* Whether a finding is known (NULL: none is). */
    bool (*is_known)(void *user, const struct findings_entry *entry);
    void (*tick)(void *user, const struct campaign_view *view); /* some times a second; or NULL */
    void *user;
    volatile sig_atomic_t *stop; /* set to 1: ends within a second; 2: at once. NULL: never */
};

/* State of a finding that is not in its folder. */
struct campaign_mark {
    bool known;
    bool shrunk;                 /* or nothing was to be gained, or it cannot be */
    uint8_t played_again, shown; /* cause not_repeatable, at the end: how often of how many */
};

enum campaign_phase { CAMPAIGN_STARTING, CAMPAIGN_PLAYING, CAMPAIGN_ENDING, CAMPAIGN_SHRINKING };

/* Trials of the whole campaign, all its runs, by the result of a contestant. */
struct campaign_turnout {
    uint64_t played;                      /* it answered */
    uint64_t declined;                    /* the engine refused, not its layout */
    uint64_t proved;                      /* it answered with a hit that is not WRONG */
    struct edges_lost edges[MATCH_EDGES]; /* unknown formula: hits beside edges, of all trials */
};

/* Progress of a campaign. */
struct campaign_view {
    const struct campaign_options *options;
    const struct findings *findings;
    const struct campaign_mark *mark; /* of each finding */
    enum campaign_phase phase;
    uint64_t ns, play_ns;             /* in all; of it until the last trial */
    uint64_t trials, corpus, mutants; /* played in this run; corpus and mutants are of them */
    uint64_t before;                  /* trials of stream gen of earlier runs */
    uint64_t rays, judged, wrong, count[VERDICT_COUNT];
    uint64_t refused[FUZZ_CONTESTANTS_MOST]; /* trials that a contestant's layout refused, or a
                                                rule, not its engine */
    uint64_t unasked[FUZZ_CONTESTANTS_MOST]; /* trials without its turn, or that drew another */
    struct campaign_turnout turnout[FUZZ_CONTESTANTS_MOST];
    bool turnout_unknown;                              /* an earlier run did not count it */
    uint64_t refitted, rebuilt;                        /* answers from trees that moved */
    uint64_t triangles, histogram[CAMPAIGN_TRIANGLES]; /* trials by triangles, the last: and more */
    struct fuzz_time time;
    uint64_t explain_ns;
    uint64_t coverage[COVERAGE_WORDS]; /* of the campaign */
    size_t kept;                       /* trials to mutate */
    uint32_t workers, restarts;
    uint32_t renewed;         /* workers that had grown to half of the memory that one may hold */
    bool unplayed;            /* trials of options.trials are left for another run */
    bool unshrunk;            /* with CAMPAIGN_SHRINK_AT_END, findings likewise */
    size_t to_shrink, shrunk; /* signatures */
    const char *versions;
    const char *said; /* on the last death of a worker, or "" */
};

/* Median number of triangles. */
uint32_t campaign_triangles_median(const struct campaign_view *view);

/* Share of the harness (making, building, truth, judging) in its and the engines' time, [0, 1]. */
double campaign_harness_share(const struct campaign_view *view, double *to_engines);

/* Findings that are neither known nor flaky; *flaky (may be NULL): how many never showed again. */
size_t campaign_news(const struct campaign_view *view, size_t *flaky);
/* True if a finding was played again and never shown again. */
bool campaign_is_flaky(const struct campaign_mark *mark);

/* Why contestant i tested next to nothing in all trials of the campaign: it never answered, or
 * never with a right hit, or refused nearly all. NULL: it tested something, or there was no trial
 * yet. */
const char *campaign_vacuous(const struct campaign_view *view, size_t i);

/* Why contestant i, whose formula is not known, fails although each answer may be rounding: in all
 * trials together it lost more hits beside edges than rounding does (ref/match/match_edges.c).
 * NULL: it did not. */
const char *campaign_loses(const struct campaign_view *view, size_t i);

/* Runs a campaign, or resumes the one of the folder's state; `findings` is open for writing. The
 * process must not have opened any engine. `end` (may be NULL) is called with the last view.
 * Errors: STATUS_INPUT cannot write; STATUS_UNSUPPORTED, _DEVICE an engine cannot be opened;
 * STATUS_MEMORY. */
enum status campaign_run(const struct campaign_options *options, struct findings *findings,
                         void (*end)(void *user, const struct campaign_view *view),
                         struct reason *reason) MUST_USE;

/* The folder's state: NAME=VALUE, '|' between them; bytes other than letters, digits and _-+:.,/
 * are written as % and two hexadecimal digits. */

/* Appends a value; false without room. */
bool campaign_state_put(char *state, size_t size, const char *name, const char *value) MUST_USE;
/* Reads a value; false if there is none of that name, or it is longer than `size` allows. */
bool campaign_state_get(const char *state, const char *name, char *value, size_t size);
/* True if no trial was played, for example since no engine could be opened. */
bool campaign_state_is_unplayed(const char *state);

#endif
