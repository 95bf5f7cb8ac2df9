/* What the files of a campaign share. */
#ifndef FUZZ_CAMPAIGN_INNER_H
#define FUZZ_CAMPAIGN_INNER_H

#include "fuzz/campaign/campaign.h"

/* How a worker died or was ended. */
struct death {
    bool hung;
    char text[WORK_OPINION_MOST];
    uint64_t trial; /* fuzz_mark */
    uint32_t contestant, phase;
};

/* Trials that are played together, and their results. */
struct campaign_block {
    enum work_stream stream;
    uint64_t first;
    uint32_t count;
    const struct fuzz_trial *base; /* of stream mut; owned by the feedback */
    struct work_draw draw;
    struct combination combination; /* the members drawn */
    uint32_t waiting;               /* contestants without a turn, 1u << contestant */
    bool done;
    struct work_trial trial[FUZZ_BATCH];
    struct work_finding *finding;
    size_t findings, finding_capacity;
    /* After a worker died: trial by trial. */
    bool alone;
    uint32_t at;       /* the trial being played alone */
    uint32_t left_out; /* contestants that died of that trial */
    bool unexplained;  /* the worker died while it explained a finding */
    bool died_alone;   /* a worker died of a single trial */
    struct death death;
    struct campaign_block *next; /* in the order of applying */
};

/* Blocks that wait for an earlier one to be applied, beyond those that workers have. */
#define CAMPAIGN_WAITING 64u
/* A block that far before the one being drawn is applied, and what it missed is counted. */
#define CAMPAIGN_BEHIND (CAMPAIGN_WAITING + CAMPAIGN_JOBS_MOST)

/* Trials of a block whose members were drawn but did not meet. */
struct missed {
    uint64_t block; /* its number and 1; 0: none */
    struct combination combination;
    uint32_t refused, rebuilt;
};

enum slot_task { SLOT_STARTING, SLOT_IDLE, SLOT_BLOCK, SLOT_SHRINK, SLOT_AGAIN };

struct slot {
    struct child child;
    struct work_watch *watch; /* shared */
    enum slot_task task;
    struct campaign_block *block;
    size_t entry;                  /* of SLOT_SHRINK and SLOT_AGAIN */
    uint32_t failures;             /* starts in a row that failed */
    uint32_t stops;                /* workers in a row that were stopped for too long */
    uint64_t stopped_ns;           /* for how long this one has been */
    bool warm;                     /* it has played something */
    uint64_t beat, mark, since_ns; /* since_ns: when its order was given */
    uint64_t busy_ns, looked_ns;   /* without progress, and when that was last looked at */
    uint64_t queued_ns, waited_ns; /* child_queued_ns() then, and of it what fell in busy_ns */
};

struct campaign {
    const struct campaign_options *options;
    struct reason *reason;   /* of the error that ends it */
    struct work_rules rules; /* the options', with what earlier runs kept */
    struct feedback_list kept;
    struct folder kept_folder; /* their folder, once there are some; of stream mut */
    struct findings *findings;
    struct campaign_view view;
    struct work_watch *watch; /* shared, one for each slot */
    struct slot slot[CAMPAIGN_JOBS_MOST];
    size_t slots;
    char versions[1024];
    /* Streams. */
    bool corpus_done;                      /* in an earlier run */
    uint64_t corpus_next;                  /* trial of the corpus to be ordered next */
    uint64_t kept_next;                    /* likewise of those kept */
    uint64_t next;                         /* trial of stream gen to be ordered next */
    uint64_t applied;                      /* the one behind the last that is applied */
    uint64_t trials_done;                  /* of stream gen, all runs */
    uint64_t mut_next;                     /* block of stream mut */
    uint64_t ordered, mutated;             /* blocks of this run */
    uint64_t mut_triangles, gen_triangles; /* of those blocks, those of gen about */
    struct campaign_block *first, **last;  /* corpus and gen, in order */
    size_t waiting;                        /* blocks in that list */
    struct feedback *feedback;
    struct rng rng; /* chooses the trials to mutate */
    struct missed missed[CAMPAIGN_BEHIND];
    /* Findings. */
    struct campaign_mark *mark;
    size_t marks, mark_capacity;
    bool dirty;     /* something was applied since the last checkpoint */
    bool found;     /* lines of findings among it */
    size_t offered; /* a shrunk finding that is being written, or SIZE_MAX */
    uint64_t offered_hash;
    uint64_t stopped_ns; /* when a signal was seen */
    uint64_t saved_ns, memory_ns, ticked_ns, start_ns, play_end_ns, shrink_ns;
    bool ending; /* no more blocks */
    bool no_more_jobs;
    char said[WORK_OPINION_MOST];
};

/* --- campaign_state.c --- */

/* Restores the state of the folder's last checkpoint; the caller has compared its identity. */
void campaign_state_read(struct campaign *c);
enum status campaign_state_write(struct campaign *c) MUST_USE;

/* --- campaign.c --- */

/* True if all that the campaign is to play was applied, and nothing interrupts it. */
bool campaign_is_played(const struct campaign *c);

/* --- campaign_blocks.c --- */

/* The next block to play; NULL: there is none now (or no memory: *status). */
struct campaign_block *campaign_block_next(struct campaign *c, enum status *status);
/* True if trials of options->trials have not been applied, for whatever reason. */
bool campaign_blocks_left(const struct campaign *c);
void campaign_block_free(struct campaign_block *block);
/* Takes a worker's report into the block and sets block->done. Errors: STATUS_MEMORY. */
enum status campaign_block_take(struct campaign *c, struct campaign_block *block,
                                const struct work_parts *parts) MUST_USE;
/* Takes a worker's death while it played the block. Errors: STATUS_MEMORY. */
enum status campaign_block_died(struct campaign *c, struct campaign_block *block,
                                const struct death *death) MUST_USE;
/* The order of what is left of a block. */
struct work_order campaign_block_order(const struct campaign_block *block);
/* Applies a block of stream mut, and frees it. */
enum status campaign_block_apply(struct campaign *c, struct campaign_block *block) MUST_USE;
/* Applies and frees the blocks at the head of the list that are done. */
enum status campaign_blocks_apply(struct campaign *c) MUST_USE;

/* --- campaign_pairs.c --- */

/* Draws the members of a block of a drawn field. */
void campaign_pairs_draw(struct campaign *c, struct campaign_block *block);
/* Counts the pairs that met in its trials. */
void campaign_pairs_count(struct campaign *c, const struct campaign_block *block);
/* The tally of a drawn field is in the folder: pairs.txt. */
enum status campaign_pairs_read(struct campaign *c) MUST_USE;
enum status campaign_pairs_write(const struct campaign *c) MUST_USE;

/* --- campaign_crew.c --- */

enum status campaign_crew_start(struct campaign *c) MUST_USE;
void campaign_crew_end(struct campaign *c, uint32_t ms);
/* Gives work to idle workers. */
enum status campaign_crew_order(struct campaign *c) MUST_USE;
/* Reads the workers' reports, and ends those that hang or hold too much memory. */
enum status campaign_crew_hear(struct campaign *c) MUST_USE;
size_t campaign_crew_count(const struct campaign *c, enum slot_task task);

/* --- campaign_jobs.c --- */

/* Makes the marks of findings that came since. Errors: STATUS_MEMORY. */
enum status campaign_marks_update(struct campaign *c) MUST_USE;
/* Gives the slot a finding to shrink or to play again; *given: there was one. */
enum status campaign_job_order(struct campaign *c, struct slot *slot, bool *given) MUST_USE;
/* Takes the report of such a job, or the death of its worker (parts NULL). */
enum status campaign_job_take(struct campaign *c, struct slot *slot,
                              const struct work_parts *parts) MUST_USE;
/* True if a job is left that is to be done before the end. */
bool campaign_jobs_left(const struct campaign *c);
/* True if a signature is still to be shrunk, by this run or another. */
bool campaign_shrinks_left(const struct campaign *c);

/* How many findings count for `until`. */
size_t campaign_counted(const struct campaign *c);

#endif
