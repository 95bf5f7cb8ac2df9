/* What one part of a hard case needs for all its members: truth, trees, answers, judges. */
#ifndef HARD_CACHE_H
#define HARD_CACHE_H

#include "tests/hard/run.h"

#define CACHE_JUDGES 48
#define CACHE_TRIS   5 /* triangle tests, by id */
_Static_assert(CACHE_TRIS == ABI_TRI_BALDWIN_WEBBER + 1, "one of them has no place");

/* A judge of one engine's answers. */
struct hard_judge {
    const struct engine *engine;
    const struct tri_test *tri;
    enum query query;
    bool watertight;
    struct judge *judge;
};

struct hard_cache {
    const struct hard_part *part;
    struct oracle *oracle;
    struct oracle_answer *truth; /* NULL: a bad scene, or a world */
    struct match match;          /* of a world, in place of all that follows but `reason` */
    const struct layout *top;    /* of its top tree; `layout`: of the others */
    struct hit *brute[CACHE_TRIS];
    const struct builder *builder; /* of bvh; NULL: none yet */
    struct bvh bvh;
    enum status built;
    const struct layout *layout; /* of packed, by that builder; NULL: none yet */
    struct packed packed;
    enum status made;     /* of building and packing */
    struct reason reason; /* if not STATUS_OK */
    bool checked;         /* packed_check has run */
    enum status structure;
    struct hit *answer, *again; /* room for one more than there are rays */
    struct judgement *judged;   /* of answer */
    bool *open;                 /* per ray: the judge lets it be another triangle, or none */
    bool answered;              /* by the member that is playing */
    bool in_range;              /* coordinates are 0 or 2^-60 to 2^40: boxes lose nothing */
    struct hit *cpu;            /* engine cpu's, if cpu_valid */
    bool cpu_valid;
    const struct box_test *cpu_box;
    const struct tri_test *cpu_tri;
    enum query cpu_query;
    struct hard_judge judge[CACHE_JUDGES];
    size_t judge_count;
};

/* Decides the part's rays. Errors: those of the oracle; STATUS_MEMORY. Free in either case. */
enum status cache_make(const struct hard_part *part, struct hard_cache *out,
                       struct reason *reason) MUST_USE;
void cache_free(struct hard_cache *cache);

/* How many of the part's rays truly hit something. */
size_t cache_truly(const struct hard_cache *cache);

/* The member's tree in its layout. Returns the status of building and packing; the reason is in
 * cache->reason. */
enum status cache_pack(struct hard_cache *cache, const struct hard_member *member) MUST_USE;

/* Answers of brute force with `tri`, closest hits. NULL without memory. */
const struct hit *cache_brute(struct hard_cache *cache, const struct tri_test *tri);

/* The judge of the member's answers. Errors: STATUS_MEMORY. */
enum status cache_judge(struct hard_cache *cache, const struct hard_member *member,
                        const struct model *model, struct judge **out,
                        struct reason *reason) MUST_USE;

/* The member's job on the part; the tree is that of the last cache_pack. */
struct job cache_job(const struct hard_cache *cache, const struct hard_member *member);

#endif
