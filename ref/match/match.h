/* A match: one scene, one tree, one set of rays and the exact truth about them. Engines run on it
 * one after the other, and the judge judges each alone. Commands and tests loop over matches. */
#ifndef MATCH_H
#define MATCH_H

#include "ref/engine.h"
#include "ref/judge/judge.h"
#include "ref/packed/life.h"
#include "ref/packed/tree_file.h"
#include "ref/two_level/world_life.h"

#define POOL_MOST       427 /* every engine of the program, and all that may be added */
#define FINDING_MOST    4   /* kept of a row: so many that are WRONG, and so many bit differences */
#define REPEAT_MOST     32
#define MATCH_EDGES     4 /* classes of hits beside edges */
#define MATCH_EDGES_FEW 4.0

/* Engines opened once and kept, so that pipelines and devices are made once. */
struct pool {
    struct engine_options options;
    struct {
        const struct engine *engine;
        void *self;
        enum status status; /* of open */
        struct reason reason;
    } entry[POOL_MOST];
    size_t count;
};

/* Returns the opened engine's self, opening it if needed; NULL with *status and *reason if it
 * cannot run. */
void *pool_get(struct pool *pool, const struct engine *engine, enum status *status,
               struct reason *reason);

/* Closes all engines. */
void pool_free(struct pool *pool);

/* What else answers must satisfy. */
struct match_demands {
    float displacement; /* of an unknown formula: see struct model; 0: its own */
    bool watertight;    /* no hit inside a closed fan may be lost, whatever the engine promises; not
                           of lists */
};

/* The life of a match's scene or world: it is number `count` of these, which all have the same
 * triangles or meshes. Borrowed. */
struct match_life {
    const struct scene *scene; /* count + 1 of them: as built, and after each step; NULL: worlds */
    const struct world *world; /* likewise; NULL: scenes */
    enum life_act act[LIFE_STEPS_MOST];
    uint32_t count;
};

struct match_options {
    const struct builder *builder; /* tree_file_builder with `tree` */
    struct build_options build;
    const struct tree_file *tree;  /* borrowed, of the match's scene: in place of what a builder
                                      makes; NULL: built */
    const struct tri_store *store; /* of trees that are packed here; NULL: indexed */
    const struct box_test *box;
    const struct tri_test *tri;
    const struct builder *top_builder; /* of a world's top tree; NULL: `builder` */
    const struct layout *top_layout;   /* likewise; NULL: that which is packed */
    uint32_t braid;                    /* as world_build.braid */
    const struct scene *rest; /* borrowed: the scene before its vertices moved. Trees are built of
                                 it and packed, then refitted to the match's; NULL: nothing moved */
    const struct match_life *life; /* borrowed: trees go through its steps, and engines with them,
                                      which trace some rays after each; without `rest`, `tree` and
                                      automatic layouts. NULL: none */
    enum query query;
    unsigned repeats;      /* timed traces per engine, 1 to REPEAT_MOST */
    uint64_t brute_budget; /* ray-triangle pairs that the oracle's brute force may spend */
    uint64_t
        brute_rays; /* and the most rays it decides that way; 0: all that the budget pays for */
    struct match_demands demands;
};

/* The effect of a motion on a tree: costs as of tree_sah, 0 if the tree could not be refitted;
 * times of building the tree, of packing it and of refitting the packed one. */
struct match_refit {
    double sah_before, sah_after;
    uint64_t build_ns, pack_ns, refit_ns;
};

/* What a finding in a world has besides. */
struct world_finding {
    bool is; /* false: it is of a scene */
    struct ray_mode mode;
    uint32_t tag, expected_tag; /* of the answer, and of row.against's if the bits differ */
    struct place got, expected; /* of the answer's triangle and the expected one, if they are */
};

/* Something that was not allowed. */
struct finding {
    size_t ray_index;
    struct ray ray;
    struct hit got;             /* of a list: the hit at fault; a miss if one is lost */
    struct judgement judgement; /* why it is WRONG, unless `bits` */
    struct oracle_answer truth;
    struct hit expected; /* that of row.against, if `bits` */
    bool bits;           /* found by comparing with row.against, else by the judge */
    struct world_finding world;
};

enum row_status {
    ROW_OK,
    ROW_REFUSED, /* the layout cannot hold the scene, or RTRS panics */
    ROW_SKIPPED, /* the engine cannot run here */
    ROW_FAILED,  /* the engine did not finish */
    ROW_VACUOUS, /* no fault, but too few hits to mean anything */
};

/* Hits of one class of ref/match/match_edges.c, and how many of them were lost. */
struct edges_lost {
    size_t hits, lost;
};

/* One line of a result: an engine on a layout. */
struct row {
    struct match_options options; /* of its match */
    struct bvh_stats stats;       /* of its tree */
    const struct engine *engine;
    const struct layout *layout; /* NULL: the engine needs none */
    enum row_status status;
    enum status cause; /* of REFUSED, SKIPPED, FAILED */
    bool declined;     /* REFUSED: by the engine itself, not by its layout */
    bool absent;       /* SKIPPED: the engine cannot run here at all, or traces no worlds */
    struct reason reason;
    /* See row_bytes_known. Scene: of vertices and indices, where the storage reads them; of a
     * tracer from outside as it tells. Memory: 0 is not known. */
    uint64_t node_bytes, item_bytes, scene_bytes, memory_bytes;
    size_t rays, hits;
    size_t compared;             /* answers judged */
    size_t brute;                /* of them, those whose truth brute force decided too */
    size_t count[VERDICT_COUNT]; /* by the judge */
    size_t wrong[WRONG_COUNT];   /* kinds of count[VERDICT_WRONG] */
    double worst_over;           /* largest err/E of t, see struct judgement */
    struct {
        size_t count;          /* answers that have one: an unknown formula's hits and lost hits */
        double p50, p99, most; /* displacement, see struct judgement */
        size_t fan_lost;       /* hits lost inside a closed fan */
        double allowed;        /* by the tracer's own word, or by demand; else what is usual */
    } displacement;
    struct edges_lost edges[MATCH_EDGES]; /* hits of an unknown formula, one of each list, by
                                             distance from edges: see ref/match/match_edges.c */
    size_t edges_beyond; /* more lost than rounding explains: counted in differences */
    size_t fans_lost; /* with options.demands.watertight: hits lost inside a closed fan; likewise */
    struct {          /* QUERY_ALL: an answer is a list, a hit one that is not empty */
        size_t triangles; /* listed */
        /* Of a world nothing below is known: false and 0. */
        size_t doubles;    /* lists with two triangles of which exactly one should be hit */
        bool closed;       /* the mesh is: then also */
        size_t parity;     /* lists of which it is known whether they must be even or odd, but for
                              those with a wall on an end of the range (VERDICT_BORDER) */
        size_t parity_off; /* and that are not, with each double hit counted once */
    } lists;
    struct {           /* a quantised scene's answers for the original, see ref/match/original.h */
        size_t judged; /* 0: it is not one */
        size_t beyond; /* need more than the displacement that was certified: WRONG */
        size_t lost, phantom, other; /* a miss for a hit, a hit for a miss, not the nearest */
        double allowed, most, most_decoded; /* certified; needed for the original, the decoded */
    } original;
    size_t bit_differences;       /* against `against`, if bits */
    bool bits;                    /* compared with `against` bit for bit, and must be equal */
    const struct engine *against; /* engine cpu on the same tree; of compiled shaders the raw one */
    struct engine_compiled compiled; /* of an engine with compiled shaders that was prepared */
    size_t moved; /* of one whose bits are free: answers with other bits than `against` has */
    struct {      /* of a mode of a library, of `moved`: which is right by the judge */
        size_t both, own, plain, neither;
    } beside;
    bool unknown; /* its formula is not known */
    const char
        *formula;  /* of an engine with own_tri that ran: the triangle test of the table that it
                            reports; NULL: none of the table */
    bool of_world; /* the match is of a world */
    bool judged;   /* false: a member as published takes part; answers are only counted */
    size_t differences;       /* above 0 the exit code is 1 */
    double mrays[3];          /* million rays per second: median, least, most */
    struct match_refit refit; /* with options.rest */
    struct {                  /* with options.life, at its last step */
        enum life_fate fate;  /* of the tree; of an engine without one what the step says */
        bool updated;         /* the engine updated what it held, else it was prepared anew */
        bool again;         /* some answers are WRONG, and it was opened and prepared anew; then: */
        size_t wrong_again; /* so many are WRONG */
    } life;
    uint64_t boxes, tris;
    bool device_clock;
    struct finding finding[2 * FINDING_MOST];
    size_t finding_count;
};

/* Whether bytes of its tree are known: on a layout, or as a tracer from outside tells them. */
static inline bool row_bytes_known(const struct row *row)
{
    return row->layout || row->node_bytes > 0;
}

const char *row_status_name(enum row_status status);

/* True if answers with other bits than the reference engine's, or those of the library's plain
 * mode, are counted and are no fault. */
static inline bool row_counts_bits(const struct row *row)
{
    return row->against && !row->bits && (row->engine->foreign_bits || row->engine->plain);
}

/* The tests that a row's engine ran, which may be its own whatever the options are: "own" is a test
 * of no table, "-" none. */
const char *row_box_name(const struct row *row);
const char *row_tri_name(const struct row *row);
/* The triangle test of the table with that formula, or NULL. */
const char *row_formula_name(enum twin_formula formula);

/* How many of `hits` hits of class `class` of row->edges may be lost. */
double match_edges_limit(size_t class, size_t hits);

/* "12 of 20 (at most 9), ..., the nearest first: not rounding": at most MATCH_EDGES_TEXT bytes. */
#define MATCH_EDGES_TEXT 400
void match_edges_text(const struct edges_lost edges[MATCH_EDGES], char text[MATCH_EDGES_TEXT]);

/* How many more than match_edges_limit were lost, in all classes. */
size_t match_edges_beyond(const struct edges_lost edges[MATCH_EDGES]);

/* True if the row makes a command fail with EXIT_MISMATCH. */
bool row_failed(const struct row *row);

/* Owns what it made; scene, world, modes and rays are borrowed. */
struct match {
    struct match_options options;
    const struct scene *scene;   /* NULL: of a world */
    const struct world *world;   /* NULL: of a scene */
    const struct ray_mode *mode; /* of a world: one per ray; NULL: ray_mode_all() for each */
    const struct ray *ray;
    size_t ray_count;
    struct bvh bvh; /* with options.rest the tree of that scene */
    struct bvh_stats stats;
    struct match_refit refit; /* of the tree and the packed tree */
    struct oracle *oracle;
    struct oracle_answer *truth; /* exact nearest hits of closed ranges */
    struct oracle_stats work;    /* what they took */
    size_t brute_count;       /* the first this many were decided by brute force and by the tree */
    struct packed packed;     /* of the layout last packed */
    struct life_tree *tree;   /* of options.life: those of all its steps, but that the last one's
                                 packed tree is `packed`; NULL: nothing is packed */
    struct world_life *lived; /* the same of a world: the last one's is `packed_world` */
    struct world_trees trees; /* of a world: in place of bvh */
    struct packed_world packed_world; /* and of packed */
    struct {
        const struct engine *engine; /* NULL: not yet traced */
        struct hit *hit;             /* its hits on packed, which bits are compared with */
        uint32_t *tag;
    } against;
    struct hit *answer;               /* of the engine last run */
    struct hit *again;                /* its second answers */
    uint32_t *answer_tag, *again_tag; /* of a world: tags of these */
    unsigned char *unstable;          /* per ray: the two differ */
    struct {                          /* the last closest hits, for any-hit to be compared with */
        struct hit *hit;              /* room for all rays */
        uint32_t *tag;                /* of a world: theirs */
        size_t count;                 /* 0: none */
        const struct engine *engine;
        const struct box_test *box;
    } closest;
    struct pool *pool; /* borrowed */
};

/* Builds the tree (or takes the options') and decides every ray exactly: by the oracle's tree, and
 * as many as the options pay for by brute force too. Errors: STATUS_LIMIT the builder would not
 * end; STATUS_UNSUPPORTED the oracle cannot run here; STATUS_MEMORY; STATUS_INTERNAL the oracle's
 * two ways contradict each other. */
enum status match_make(const struct scene *scene, const struct ray *ray, size_t ray_count,
                       const struct match_options *options, struct pool *pool, struct match *out,
                       struct reason *reason) MUST_USE;

/* The same of a world that has passed world_finish: hits name placed triangles. The options'
 * builder builds all trees, and a layout packs both levels. The options have neither tree nor
 * rest; a life is of worlds. Errors: as match_make; STATUS_LIMIT also those of world_trees_make. */
enum status match_make_world(const struct world *world, const struct ray *ray,
                             const struct ray_mode *mode, size_t ray_count,
                             const struct match_options *options, struct pool *pool,
                             struct match *out, struct reason *reason) MUST_USE;

/* The layout that is packed, of a world that of its meshes; NULL: none. */
const struct layout *match_layout(const struct match *match);

/* Triangles of the scene, or placed ones of the world. */
uint32_t match_tri_count(const struct match *match);

/* Another tree and triangle test for the same rays: the truth stays; nothing is packed. The tree is
 * the options' if they have one, and no builder builds. On an error the match is usable for engines
 * without a tree only. Errors: STATUS_LIMIT, STATUS_MEMORY. */
enum status match_rebuild(struct match *match, const struct builder *builder,
                          const struct build_options *build, const struct tri_test *tri,
                          struct reason *reason) MUST_USE;

/* Changes box test and query; tree, truth and packed layout stay. */
void match_set(struct match *match, const struct box_test *box, enum query query);

/* Makes `layout` the one that the next rows run on. Errors: those of packed_make and, with the
 * options' rest, of packed_refit; with their life, of life_begin and life_step; or with a tree of
 * the options' of tree_file_pack; the match then has no layout and stays usable. */
enum status match_pack(struct match *match, const struct layout *layout,
                       struct reason *reason) MUST_USE;

/* As match_pack with packed_make_auto, or a packed tree in its own layout; `refused` tells why
 * smaller layouts were not possible. */
enum status match_pack_auto(struct match *match, char *refused, size_t refused_bytes,
                            struct reason *reason) MUST_USE;

/* Runs one engine on the packed layout (or without one) at least twice and judges it. Engines that
 * promise bits are compared with engine cpu, or with the engine whose shaders were compiled,
 * any-hits with the closest hits of the same engine, layout and box test if those ran just before.
 * QUERY_ALL: two traces, timed by the host, work not counted. Never fails: what went wrong is in
 * the row. */
void match_run(struct match *match, const struct engine *engine, struct row *row);

/* A row for a layout that could not be packed. */
void match_refused(const struct match *match, const struct layout *layout,
                   const struct engine *engine, enum status cause, const struct reason *reason,
                   struct row *row);

void match_free(struct match *match);

#endif
