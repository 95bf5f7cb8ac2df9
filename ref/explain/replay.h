/* The reference traversal (ref/trace/trace.c) with switches: repairs that correct one thing, a
 * planted defect that breaks one thing, and notes of what happened. */
#ifndef EXPLAIN_REPLAY_H
#define EXPLAIN_REPLAY_H

#include "ref/explain/slabs.h"
#include "ref/explain/tree.h"

/* Decides a triangle exactly: true if the ray hits `prim` in its range; t, u and v to float
 * precision. */
typedef bool exact_fn(const void *user, const struct ray *ray, uint32_t prim, struct hit *out);

/* What is replayed. */
struct explain_replay {
    const struct scene *scene;
    const struct explain_tree *tree; /* NULL: every triangle in index order, as engine brute */
    uint32_t box_id, tri_id;
    enum query query;
    exact_fn *exact; /* for REPAIR_TRIANGLE; may be NULL: then that repairs nothing */
    const void *exact_user;
};

/* How one run differs from the plain one. */
struct replay_change {
    uint32_t repairs; /* mask of 1u << enum repair */
    enum defect defect;
    uint32_t parameter; /* of the defect */
};

enum replay_end {
    REPLAY_DONE,
    REPLAY_STACK,  /* the stack was full */
    REPLAY_VISITS, /* more visits than nodes */
};

/* What happened to one node of the path to a triangle. */
struct replay_note {
    uint32_t node;                      /* tree node; set by the caller */
    bool tested, hit, visited, skipped; /* box tested; hit; entered; popped and skipped by best */
    float entry, tbest;                 /* of the box test */
    bool oriented, missed;              /* its oriented box was tested, and turned the ray away */
    uint32_t above, below;              /* references: if `oriented` of its parent; of itself */
};

/* Called for every test and push of one run. */
struct replay_watch {
    void *user;
    void (*box)(void *user, uint32_t ref);    /* the box of a record is tested */
    void (*tri)(void *user, uint32_t prim);   /* a triangle is tested */
    void (*push)(void *user, uint32_t depth); /* `depth` entries are on the stack now */
};

/* Notes about a path, root first, and about the triangle at its end. */
struct replay_notes {
    struct replay_note *step;
    uint32_t count;
    uint32_t prim;
    /* The last reference above the triangle that is no node of the tree, as where a leaf is packed
     * in parts; `node` is not set. */
    struct replay_note part;
    const struct replay_watch *watch; /* or NULL */
    bool prim_tested, prim_accepted;  /* the triangle test ran; it accepted */
    struct hit prim_hit;              /* if accepted */
    bool prim_kept;                   /* it was nearer than the best so far */
};

/* Answers one ray. *out is a miss unless REPLAY_DONE. `notes` may be NULL.
 * With no change it gives the bits of trace_ray, or of trace_brute without a tree. */
enum replay_end replay_run(const struct explain_replay *replay, const struct replay_change *change,
                           const struct ray *ray, struct hit *out, struct replay_notes *notes);

#endif
