/* The hard cases: scenes and rays that broke ray tracers, each with the property that every engine,
 * layout, builder, box test and triangle test must keep on it. Answers are checked here;
 * tests/hard/run.h plays a case on a member. */
#ifndef HARD_H
#define HARD_H

#include "ref/abi.h"
#include "ref/explain/repair.h"
#include "ref/twin/model.h"
#include "ref/scene/scene.h"
#include "ref/world/world.h"

#define HARD_PARTS_MOST   72
#define HARD_LABEL_MOST   24
#define HARD_DEFECTS_MOST 6

struct engine;
struct engine_options;
struct hard_result;
struct layout;

/* Which engines an expectation applies to. */
enum hard_scope {
    HARD_ALL,   /* every engine */
    HARD_OWN,   /* engines that compute one of raydiff's own triangle tests */
    HARD_LEAN,  /* of these, tests whose products are of differences alone: sums of products, as in
                  pluecker, overflow earlier */
    HARD_TIGHT, /* engines that promise to be watertight */
    HARD_FANS,  /* these, ray queries (Vulkan: "should") and Embree's robust mode */
};

/* What the answer to a ray must be; bits. Every answer is judged as well. */
#define WANT_HIT  1u /* some hit */
#define WANT_MISS 2u /* a miss */
#define WANT_ID   4u /* a hit names one of a set of triangles; ignored for any-hit */
#define WANT_T    8u /* a hit has exactly this t, if quotients are exact; ignored for any-hit */
#define WANT_ENDS                                                                                  \
    16u               /* its exact t is an end of the range: a hit where ends count, else a miss   \
                       */
#define WANT_LIKE 32u /* the same as another ray's answer, up to HARD_LIKE_* */
#define WANT_TAG  64u /* a hit in a world has this tag; ignored for any-hit */

struct hard_want {
    unsigned what; /* 0: nothing */
    enum hard_scope scope;
    uint32_t id_first, id_count; /* WANT_ID: of part.id */
    float t;                     /* WANT_T */
    uint32_t tag;                /* WANT_TAG */
    uint32_t like;               /* WANT_LIKE: a ray of part.like */
    int shift;                   /* its t times 2^shift is this one's ... */
    float add;                   /* ... minus add */
};

/* In which triangle tests two related rays must agree in every bit of t; in the others they name
 * the same triangle, and the judge bounds t. Bits. */
#define HARD_LIKE_MT   1u
#define HARD_LIKE_WOOP 2u

/* One scene, or one world, with its rays; owns its arrays. Zero-initialized it is empty. */
struct hard_part {
    char label[HARD_LABEL_MOST]; /* "k=-30" */
    struct scene scene;
    bool is_world;      /* then the scene is empty, and hits name placed triangles */
    struct world world; /* its meshes are complete before the first ray is added */
    struct ray *ray;
    struct ray_mode *mode;  /* of a world: one per ray */
    struct hard_want *want; /* one per ray */
    uint32_t *id;           /* the sets of WANT_ID */
    uint32_t *prim_of;      /* like: triangle i is triangle prim_of[i] there; NULL: i */
    size_t ray_count, id_count;
    size_t vertex_room, index_room, ray_room, mode_room, want_room, id_room;
    size_t like;             /* part that WANT_LIKE points into */
    unsigned like_bits;      /* HARD_LIKE_* */
    uint32_t leaf;           /* items per leaf; 0: the default */
    bool deep;               /* the rtrs builder splits without a smallest size (eps 0) */
    bool bad_scene;          /* scene_check refuses it: answers are not judged */
    const char *must_refuse; /* layouts that must refuse it, separated by blanks; or NULL */
    double boxes_most;       /* mean box tests per ray on repaired members; 0: no limit */
    bool failed;             /* no memory: what is here is incomplete */
};

void hard_part_free(struct hard_part *part);

/* All parts of a case. */
struct hard_made {
    struct hard_part part[HARD_PARTS_MOST];
    size_t part_count;
};

/* A defect that the case demonstrates: members that must fail the case, or refuse it. */
struct hard_defect {
    const char *fault;   /* "RTRS's fault F2: ...", "embree#589", "packHalf2x16" */
    enum cause cause;    /* cause that explain must find for most wrong rays; CAUSE_NONE: not
                            checked, since no single answer is wrong */
    const char *members; /* pattern of query.engine.layout.builder.box.tri */
    const char *refuses; /* they must refuse, and the reason has this in it; or NULL */
    const char *version; /* of an engine, as version_told() takes it: others may be without it;
                            or NULL */
    bool rare; /* its rays depend on the processor: where none shows it, nothing is wrong */
    const struct layout *layout; /* a member of no table, made to be wrong; or NULL */
    const struct engine *engine;
};

#define HARD_TREES_ONLY 1u   /* not played on engines without a tree */
#define HARD_NO_HITS    2u   /* no ray hits, by design */
#define HARD_TWICE      4u   /* traced twice: the same bits */
#define HARD_ANY_TOO    8u   /* any-hit is compared with the member's own closest hit */
#define HARD_FLOAT_MODE 16u  /* again with FTZ and DAZ set, on one thread and on many: same bits */
#define HARD_PARITY     32u  /* a closed mesh: an even number of crossings from outside */
#define HARD_STRUCTURE  64u  /* packed_check of every member, as published ones too */
#define HARD_NO_TREES   128u /* not played on engines with a tree */
#define HARD_WORLD      256u /* every part is a world: for engines that trace worlds, all queries */

struct hard_case {
    unsigned number; /* 1 to 64: open questions; from 70: known truths; from 101: worlds */
    const char *name;
    const char *recipe, *expected, *source; /* one line each */
    unsigned flags;
    const char *driver; /* that the Vulkan engines are to run on, as --driver; NULL: any */
    void (*make)(struct hard_made *made);
    /* Instead of make: measures the driver itself, as engine vulkan. Sets outcome and reason. */
    void (*probe)(const struct engine_options *options, struct hard_result *out);
    struct hard_defect defect[HARD_DEFECTS_MOST]; /* ends at the first without a fault */
};

/* The case that has `place` cases of a smaller number; NULL if there are no more. */
const struct hard_case *hard_case_at(size_t place);

/* Makes all parts of a case; the same bytes on every machine.
 * Errors: STATUS_MEMORY; STATUS_INPUT a recipe that names a scene wrongly. Free in either case. */
enum status hard_make(const struct hard_case *one, struct hard_made *out,
                      struct reason *reason) MUST_USE;

void hard_free(struct hard_made *made);

/* What can be broken. */
enum hard_property {
    PROPERTY_KEPT,    /* nothing */
    PROPERTY_VERDICT, /* the judge finds WRONG */
    PROPERTY_HIT,     /* WANT_HIT */
    PROPERTY_MISS,    /* WANT_MISS */
    PROPERTY_ID,      /* WANT_ID */
    PROPERTY_T,       /* WANT_T */
    PROPERTY_ENDS,    /* WANT_ENDS */
    PROPERTY_LIKE,    /* WANT_LIKE */
    PROPERTY_CULLED,  /* brute force with the same test hits what is truly hit, the tree nothing */
    PROPERTY_BITS,    /* engine cpu answers other bits */
    PROPERTY_REPEAT,  /* a second trace answers other bits */
    PROPERTY_ANY,     /* any-hit finds a hit where closest hit finds none, or the reverse */
    PROPERTY_MODE,    /* the float mode or the number of threads changes the answer */
    PROPERTY_STRAY,   /* something was written behind the last answer */
    PROPERTY_FINITE,  /* a hit whose t, u or v is not finite, or of no triangle of the scene */
    PROPERTY_REFUSAL, /* should have refused, or refused without a reason */
    PROPERTY_STRUCTURE, /* packed_check found a fault */
    PROPERTY_BUDGET,    /* more box tests than the case allows */
    PROPERTY_PARITY,    /* an odd number of crossings */
    PROPERTY_TAG,       /* WANT_TAG */
    PROPERTY_COUNT
};

/* "verdict", "hit", ... */
const char *hard_property_name(enum hard_property property);

/* The engine that answered, as far as expectations depend on it. */
struct hard_subject {
    struct model model;
    bool any; /* any-hit: names some triangle, at its own t */
};

/* Checks the answer to ray `i` of `part` against its want. `like` is the same member's answer to
 * the ray of part.like (NULL: WANT_LIKE is not checked). `excused`: the judge lets this ray's
 * answer be another triangle or a miss. Returns PROPERTY_KEPT or the first broken property. */
enum hard_property hard_check(const struct hard_part *part, size_t i,
                              const struct hard_subject *subject, const struct hit *answer,
                              const struct hit *like, bool excused);

#endif
