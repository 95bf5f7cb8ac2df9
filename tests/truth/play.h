/* One contestant on one scene and ray set: traced, judged, wrong answers decided again. */
#ifndef TRUTH_PLAY_H
#define TRUTH_PLAY_H

#include "ref/explain/judged.h"
#include "ref/match/match.h"
#include "tests/truth/tally.h"

/* A scene with rays and the truth about them. Owned by the campaign; hit and judgement have room
 * for all rays. */
struct ground {
    const char *spec, *rays;
    uint64_t seed;
    struct scene scene;
    struct oracle *oracle;
    struct bvh bvh;
    struct ray *ray;
    struct oracle_answer *truth;
    struct hit *hit;
    struct judgement *judgement;
    size_t count;
};

/* What became of it. */
struct play_result {
    size_t judged, hits, verdict[VERDICT_COUNT];
    double worst_over;
    bool refused; /* the layout cannot hold the scene, or the engine cannot run here: reason */
};

/* Counts the judgements of `count` answers. */
void play_count(struct play_result *out, const struct hit *hit, const struct judgement *judgement,
                size_t count);

/* Traces and judges all rays; every WRONG is decided again and added to the tally, with its cause
 * (of the first WRONG_EXPLAINED of each play; what is beyond keeps CAUSE_UNEXPLAINED) and its
 * smallest scene. Errors: STATUS_DEVICE the engine failed; STATUS_MEMORY. */
enum status play(const struct ground *ground, const struct tally_contestant *who, struct pool *pool,
                 struct tally *tally, struct play_result *out, struct reason *reason) MUST_USE;
#define WRONG_EXPLAINED 1000u

/* An engine on a packed scene, ready to be asked and judged. */
struct play_stand {
    const struct tally_contestant *who;
    const struct scene *scene;
    const struct bvh *bvh;
    const struct oracle *oracle;
    struct packed packed;
    struct job job;
    struct judged judged;
    bool has_judged;
};

/* Packs and prepares `who` (opened as `self`) on a scene with its tree and oracle, all borrowed;
 * false if it cannot. Freed by stand_free. */
bool stand_make(const struct tally_contestant *who, void *self, const struct scene *scene,
                const struct bvh *bvh, const struct oracle *oracle, struct play_stand *out,
                struct reason *reason);
void stand_free(struct play_stand *stand);

/* The tree that all contestants of a scene stand on. Errors: as the builder's. */
enum status stand_tree(const struct scene *scene, struct bvh *out, struct reason *reason) MUST_USE;

/* Cuts the scene of `wrong` down while the answer stays wrong in the same way (kind and cause):
 * halves, quarters, ... of the triangles are taken away in turn. *out is made anew if the result is
 * smaller than what it holds. Never fails: what cannot be tried is kept. */
void reduce(const struct wrong_answer *wrong, const struct scene *scene, void *self,
            struct smallest *out);

#endif
