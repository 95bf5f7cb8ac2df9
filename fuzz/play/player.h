/* Plays trials: every trial on every contestant, each answer judged, many trials at a time. */
#ifndef FUZZ_PLAYER_H
#define FUZZ_PLAYER_H

#include "fuzz/play/coverage.h"
#include "fuzz/play/signature.h"
#include "fuzz/play/trial.h"
#include "ref/match/match.h"

#define FUZZ_CONTESTANTS_MOST 32u
#define FUZZ_FINDINGS_MOST    8u /* kept of one trial, the first of each contestant and kind */

#define FUZZ_BATCH 64u /* trials that are with an engine at a time, at most */

/* Engines that need a packed tree once per layout, the others once. */
struct fuzz_contestant {
    const struct engine *engine;
    const struct layout *layout; /* NULL: the engine needs none, or the field is drawn */
};

/* Of contestants that take turns (fuzz/play/fuzz_turns.h); all zeros where none do. */
struct fuzz_turn {
    uint8_t first; /* of those that share their turns: the one with the most */
    uint8_t of;    /* of the first: how many share; of another: which it is, from 1 */
};

struct fuzz_field {
    struct fuzz_contestant who[FUZZ_CONTESTANTS_MOST];
    struct fuzz_turn turn[FUZZ_CONTESTANTS_MOST];
    size_t count;
    bool drawn; /* each engine once, without a layout: fuzz_player_cast sets both */
    struct engine_options options;
};

/* Makes the field of all pairs. Errors: STATUS_LIMIT too many. */
enum status fuzz_field_make(const struct engine *const *engine, size_t engine_count,
                            const struct layout *const *layout, size_t layout_count,
                            const struct engine_options *options, struct fuzz_field *out,
                            struct reason *reason) MUST_USE;

/* Makes the drawn field of these engines. Errors: STATUS_LIMIT too many. */
enum status fuzz_field_draw(const struct engine *const *engine, size_t engine_count,
                            const struct engine_options *options, struct fuzz_field *out,
                            struct reason *reason) MUST_USE;

#define FUZZ_SAID_MOST 200

struct fuzz_finding {
    struct fuzz_signature signature; /* cause: CAUSE_UNEXPLAINED until fuzz_explain */
    size_t contestant;
    uint32_t step; /* of a trial with steps: after which of them, 0 is before the first */
    uint32_t ray;  /* index in the trial */
    struct hit answer;
    uint32_t tag; /* of a world: what was answered beside the hit */
    struct judgement judgement;
    char said[FUZZ_SAID_MOST]; /* of bytes that are no tree: which record, slot and bound, in the
                                  words of packed_check; else "" */
};

/* The result of a trial. Every answer is judged on its own, by the same judge as everywhere. A
 * triangle test as published is judged by the bounds of the repaired one, so that its faults are
 * findings. A contestant refuses if a layout or an engine returns STATUS_LIMIT. */
struct fuzz_result {
    size_t count[VERDICT_COUNT]; /* over all contestants */
    size_t wrong;                /* answers at fault: WRONG, other bits than cpu's, unfinished */
    size_t judged;               /* rays with a verdict for every contestant that played */
    size_t refused;              /* contestants whose layout cannot hold the trial */
    uint32_t refusers;           /* the same as a mask of 1u << contestant */
    uint32_t decliners;          /* of them those whose engine refused, not their layout */
    uint32_t players;            /* contestants that answered, likewise */
    uint32_t provers;            /* those with a hit that is not WRONG, likewise */
    uint32_t states; /* of a trial with steps: how many scenes were traced, the first included; else
                        0 */
    uint32_t refitted, rebuilt; /* contestants on a tree that was, since it moved, likewise; of
                                    steps: on one that was ever refitted, else was built again */
    struct edges_lost edges[FUZZ_CONTESTANTS_MOST][MATCH_EDGES]; /* of unknown formulas */
    struct fuzz_finding finding[FUZZ_FINDINGS_MOST];
    size_t finding_count;
    uint64_t coverage[COVERAGE_WORDS]; /* bits of states reached */
};

/* Where the time went, ns on the clock; added to. `generate` is the caller's. */
struct fuzz_time {
    uint64_t engine[FUZZ_CONTESTANTS_MOST];
    uint64_t generate, build, truth, judge;
};

/* What is being played, for the parent of a process that may die. If an engine takes many trials at
 * a time, all are at risk; playing them again one by one finds the one. */
struct fuzz_mark {
    _Atomic uint64_t trial;      /* index in the call of fuzz_play of the first at risk */
    _Atomic uint64_t count;      /* trials at risk */
    _Atomic uint32_t contestant; /* FUZZ_CONTESTANTS_MOST: none is running; after an error the one
                                    that was */
};

/* Writes judge_line of a finding on a ray; of a world also what the ray may meet, and where the
 * triangles answered and expected are: at most `size` bytes. */
void fuzz_finding_line(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                       char *text, size_t size);

struct fuzz_player;
struct judged_ray;

/* Opens the engines. Errors: STATUS_UNSUPPORTED one cannot run here; STATUS_DEVICE;
 * STATUS_MEMORY. */
enum status fuzz_player_open(const struct fuzz_field *field, struct fuzz_player **out,
                             struct reason *reason) MUST_USE;
void fuzz_player_close(struct fuzz_player *player); /* NULL is fine */

/* Leaves out the contestants of the mask (1u << contestant) from now on. The others keep their
 * numbers. */
void fuzz_player_leave_out(struct fuzz_player *player, uint32_t contestants);

/* From now on only this contestant of a drawn field plays, on this layout if it needs one. */
void fuzz_player_cast(struct fuzz_player *player, size_t contestant, const struct layout *layout);

/* Plays `count` trials, which must have passed fuzz_trial_check. Faults of engines are in the
 * results. Times are added to *time (may be NULL); `mark` may be NULL. An engine that lost its
 * device is opened again. The results do not depend on which trials are played together.
 * A trial with steps is played step by step, as trial_life_cut makes trials of it, up to the first
 * step with a finding; its result is the sum of theirs.
 * Errors: STATUS_MEMORY; STATUS_DEVICE, STATUS_UNSUPPORTED an engine that died cannot be opened
 * again; STATUS_INTERNAL. */
enum status fuzz_play(struct fuzz_player *player, const struct fuzz_trial *trial, size_t count,
                      struct fuzz_result *result, struct fuzz_time *time, struct fuzz_mark *mark,
                      struct reason *reason) MUST_USE;

/* Finds the cause of a finding and writes it into its signature (ref/explain). The engine traces
 * the ray again: if that answer is right, the cause is CAUSE_NOT_REPEATABLE. Errors:
 * STATUS_MEMORY. */
enum status fuzz_explain(struct fuzz_player *player, const struct fuzz_trial *trial,
                         struct fuzz_finding *finding, struct reason *reason) MUST_USE;

/* The same if the caller has explained an answer of the only contestant: a CAUSE_OUTSIDE in
 * answer->why becomes CAUSE_SCALE if the engine is right at another scale (fuzz/play/scaled.h).
 * Errors: STATUS_MEMORY. */
enum status fuzz_explain_scaled(struct fuzz_player *player, const struct fuzz_trial *trial,
                                uint32_t ray, struct judged_ray *answer,
                                struct reason *reason) MUST_USE;

#endif
