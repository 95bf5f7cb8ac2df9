/* Judging lists of all hits: every triangle along a ray, sorted by t. Each list is judged alone,
 * against all exact crossings of the ray: each hit that the formula cannot help finding must be
 * listed, once; each triangle listed must be one that it can find, with t, u and v within their
 * bounds; and they must stand in the order of their t. */
#ifndef JUDGE_ALL_H
#define JUDGE_ALL_H

#include "ref/judge/judge.h"
#include "ref/scene/topology.h"

struct list_judgement {
    struct judgement judgement; /* expected, t_lo, t_hi: of a hit that was lost, or should stand
                                   before the one at fault, or in its place with other numbers; else
                                   ABI_NO_PRIM. over and displacement: the largest of the list */
    struct hit at_fault;        /* if WRONG: the hit; a miss if one is lost */
    uint32_t tag;               /* of a world: the tag of at_fault; 0 of a miss */
};

/* Judges the list of one ray; safe from several threads at once.
 *   judge   made for QUERY_ALL
 *   hit     `count` of them, as sorted by all_hits_sort; may be NULL if that is 0
 * VERDICT_RIGHT: exactly the exact hits, in exact order (those at the same t in any). Else the last
 * class of enum verdict that something about the list needs: a hit listed or left out by chance is
 * BOUNDARY, BORDER, IN_PLANE, SLAB or NOISE, as a closest hit would be; NEAR_TIE: two hits stand in
 * the other order, as both errors allow. Errors: STATUS_MEMORY (VERDICT_OUT_OF_CONTRACT then). */
enum status judge_list(const struct judge *judge, const struct ray *ray, const struct hit *hit,
                       size_t count, struct list_judgement *out);

/* Properties of a list that depend on the mesh, not on the formula. */
struct list_mesh {
    bool doubled;     /* two triangles are listed of which exactly one should be: leaks_extra */
    uint32_t pair[2]; /* two such */
    bool parity;      /* the mesh is closed and it is known whether the number is even or odd */
    bool parity_off;  /* it is the other, with each double hit counted once */
};

/* Finds them for the list of one ray in contract.
 *   closed   topology_open_edge found none
 * The number of walls between the ends of the range is known from the exact crossings if the ray
 * passes through their interiors; else from a ray in another direction, which tells whether the
 * origin is inside. Errors: STATUS_MEMORY. */
enum status judge_list_mesh(const struct oracle *oracle, const struct topology *topology,
                            bool closed, const struct ray *ray, const struct hit *hit, size_t count,
                            struct list_mesh *out);

#endif
