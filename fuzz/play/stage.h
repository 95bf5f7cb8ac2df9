/* One trial being played: its tree, its packed forms, the truth, and the answers to it. What the
 * player's files share. */
#ifndef FUZZ_STAGE_H
#define FUZZ_STAGE_H

#include "fuzz/play/player.h"
#include "fuzz/play/trial_world_life.h"
#include "fuzz/play/trial_tree.h"
#include "ref/oracle/oracle.h"
#include "ref/packed/packed_check.h"
#include "ref/two_level/packed_world.h"

/* Contestants, and engine cpu on each layout, which bits are compared with. */
#define SEATS_MOST   (2 * FUZZ_CONTESTANTS_MOST)
#define LAYOUTS_MOST FUZZ_CONTESTANTS_MOST

/* An opened engine on a layout. */
struct seat {
    const struct engine *engine;
    const struct layout *layout; /* NULL: none */
    size_t layout_index;         /* in player.layout, if layout */
    void *self;                  /* shared by all seats of the engine */
    size_t reference;            /* seat of engine cpu on the same layout, or SEATS_MOST */
};

struct fuzz_player {
    struct engine_options options;
    const struct layout *layout[LAYOUTS_MOST];
    size_t layout_count;
    struct seat seat[SEATS_MOST];
    size_t seat_count, contestants; /* seats beyond the contestants are references */
    uint32_t left_out;              /* contestants that do not play */
    struct fuzz_mark *mark;         /* of the call of fuzz_play, or NULL */
    size_t mark_first;              /* the batch's first trial in that call */
    struct play_stage *stage;       /* FUZZ_BATCH of them */
    struct engine_task *task;       /* FUZZ_BATCH */
};

/* How a seat fared on a trial. */
enum fared {
    FARED_NOT,     /* not traced */
    FARED_PLAYED,  /* answered the rays with ABI_FLAG_DONE */
    FARED_REFUSED, /* a documented limit */
    FARED_FAULTY,  /* no answers; answers.kind is the fault */
};

struct answers {
    struct hit *hit;
    uint32_t *tag; /* of a world: what is answered beside the hits */
    uint32_t *flag;
    uint32_t *work; /* struct engine_task */
    bool has_work;
    enum fared fared;
    bool declined;       /* FARED_REFUSED: by the engine, not by its layout or a rule */
    enum fuzz_kind kind; /* of FARED_FAULTY */
    uint32_t ray;        /* at which */
};

/* A world, its trees and its packed forms, by layout; zero of a scene. */
struct stage_world {
    struct trial_meshes meshes;
    struct world_trees trees;
    struct packed_world packed[LAYOUTS_MOST];
    struct trial_world_life life;           /* of a trial with steps */
    struct world_life *lived[LAYOUTS_MOST]; /* likewise; packed is a share in the last of them */
    bool beyond; /* the inverse of a transform is beyond float32: no engine is asked */
};

/* Arrays are kept from trial to trial. */
struct play_stage {
    const struct fuzz_trial *trial;
    struct fuzz_trial in_c; /* of a trial whose builder on a device is at fault: with its twin, and
                               borrowed arrays */
    struct bvh bvh;         /* of a trial that moves: of its scene at rest */
    bool has_tree;
    struct bvh moved[LAYOUTS_MOST]; /* of a trial that moves: what is packed */
    enum trial_motion motion[LAYOUTS_MOST];
    struct packed packed[LAYOUTS_MOST];
    struct trial_life life;               /* of a trial with steps */
    struct life_tree *tree[LAYOUTS_MOST]; /* likewise its trees; moved and packed are shares in the
                                             last of them */
    struct stage_world world;             /* in place of bvh, moved and packed */
    bool has_packed[LAYOUTS_MOST];        /* else the layout refused */
    /* FUZZ_KIND_TREE: packed_check found faults that the tree had not; a layout from outside did
     * not survive packing; a device built another tree than C; FUZZ_KIND_COUNT: nothing. */
    enum fuzz_kind fault[LAYOUTS_MOST];
    enum packed_rule rule[LAYOUTS_MOST];     /* of FUZZ_KIND_TREE, where one is known */
    char said[LAYOUTS_MOST][FUZZ_SAID_MOST]; /* what is at fault with it, or "" */
    struct oracle *oracle;
    struct oracle_answer *truth;
    struct answers answers[SEATS_MOST];
    void *room; /* holds truth, hits, tags, flags and work */
    size_t room_bytes;
};

/* Builds and packs. Times go to *time (may be NULL). Errors: STATUS_MEMORY; STATUS_INTERNAL. */
enum status stage_set(struct play_stage *stage, const struct fuzz_player *player,
                      const struct fuzz_trial *trial, struct fuzz_time *time,
                      struct reason *reason) MUST_USE;

/* Frees what belongs to the trial; arrays are kept. */
void stage_clear(struct play_stage *stage);

/* Frees everything. */
void stage_close(struct play_stage *stage);

/* The tree that packed[layout] was made of. */
static inline const struct bvh *stage_tree(const struct play_stage *stage, size_t layout)
{
    const struct fuzz_trial *trial = stage->trial;
    return trial->move > 0 || trial->step_count > 0 ? &stage->moved[layout] : &stage->bvh;
}

/* The job of a seat on a stage. */
struct job stage_job(const struct play_stage *stage, const struct seat *seat);

/* Judges all answers of a stage. Errors: STATUS_MEMORY. */
enum status stage_judge(const struct play_stage *stage, const struct fuzz_player *player,
                        struct fuzz_result *out, struct reason *reason) MUST_USE;

/* Has the seat trace `count` stages: in one call if the engine can, else one by one. Errors:
 * STATUS_MEMORY; a dead engine that cannot be opened again. Other faults are results. */
enum status seat_ask(struct fuzz_player *player, size_t seat, size_t count,
                     struct reason *reason) MUST_USE;

/* The model by which the seat's engine is judged on a trial; see struct fuzz_result. */
struct model seat_model(const struct seat *seat, const struct fuzz_trial *trial, bool split);

#endif
