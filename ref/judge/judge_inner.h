/* What the judge's files share; for them only. */
#ifndef JUDGE_INNER_H
#define JUDGE_INNER_H

#include "ref/judge/judge_world.h"
#include "ref/judge/ray_triangle.h"
#include "ref/scene/topology.h"
#include "ref/twin/twin_placed.h"
#include "ref/world/world_boxes.h"

#include <pthread.h>
#include <stdatomic.h>

#define JUDGE_UNIT 0x1p-24 /* u */

/* Made at the first use; a million triangles take a second. */
struct judge_lazy {
    pthread_mutex_t lock;
    uint32_t count;                       /* of meshes; 1 for a scene */
    _Atomic(struct topology *) *topology; /* one each */
};

struct judge {
    const struct oracle *oracle;
    const struct scene *scene; /* NULL: of a world */
    const struct world *world; /* NULL: of a scene */
    struct twin_place *place;  /* of each instance; zeros where no ray meets it */
    uint32_t tri_count;        /* of the scene, or placed ones */
    struct ray_mode mode;      /* worlds: of the ray that is judged */
    struct model model;
    enum query query;
    bool own;            /* the formula is one of ref/primitives/tri.h */
    bool fans;           /* a closed fan cannot be missed: judge_fan.c */
    bool by_bounds;      /* see judge_by_bounds */
    bool in_contract;    /* the scene's coordinates are in contract */
    double displacement; /* unknown formula: what any triangle allows, in units */
    float largest[3];    /* |coordinate| per axis of the scene */
    double beyond;       /* worlds: share of an end of the range that an engine's t may lie beyond
                            it, since it compares before it divides (judge_noise.c) */
    struct box *box;     /* of each instance; NULL: all triangles are looked at */
    struct judge_lazy *lazy;
};

/* Of worlds of more triangles an any-hit answer without a name is looked for only in instances that
 * the ray comes near to: see judge_unnamed.c. */
#define JUDGE_ALL_MOST (1u << 20)

/* Share of its bound by which a twin's near-exact u or v may be off, with room to spare. */
#define JUDGE_SHARE 0x1p-20

/* How far an edge must be from the ray, in u * max |vertex - origin|, for an unknown formula to be
 * sure of its side: Woop with Vulkan's loosest rounding is within 24. */
#define FAN_BAND 32.0

/* The largest kappa (struct twin_place) of a transform with which an unknown formula is judged. */
#define JUDGE_KAPPA_MOST 0x1p10

/* Twins of one ray that were computed before, together with those of other rays. */
#define JUDGE_KNOWN_MOST 2
struct judge_known {
    uint32_t prim[JUDGE_KNOWN_MOST];
    struct twin twin[JUDGE_KNOWN_MOST];
    size_t count;
};

/* --- judge_geometry.c: a triangle of the scene, or a placed one ------------------------------- */

/* Where a triangle is. */
struct judge_at {
    const struct scene *scene;
    uint32_t prim;     /* of that scene */
    uint32_t base;     /* numbers of the scene's triangles begin here */
    uint32_t mesh;     /* 0 for a scene */
    uint32_t instance; /* likewise */
};

struct judge_at judge_locate(const struct judge *judge, uint32_t prim);

/* The vertices in the space that the triangle test works in. */
void judge_tri(const struct judge *judge, uint32_t prim, float v[3][3]);

/* The ray in the space of the mesh of a placed triangle. */
void judge_take_along(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      struct twin_ray *out);

/* True if the judge promises anything of that triangle: false where the ray in the space of its
 * mesh is out of contract, or, for an unknown formula, its transform is ill-conditioned. */
bool judge_takes(const struct judge *judge, const struct ray *ray, uint32_t prim);

/* RIGHT of finite numbers. Of others WRONG, or OUT_OF_CONTRACT: where the ray is out of contract in
 * the space of the triangle's mesh products overflow, whatever the formula (A8). An any-hit without
 * a name, prim ABI_NO_PRIM, has no such space. The ray is in contract. */
enum verdict judge_finite(const struct judge *judge, const struct ray *ray, const struct hit *hit);

/* The twin of a triangle; `known` may be NULL. */
struct twin judge_twin(const struct judge *judge, const struct ray *ray, uint32_t prim,
                       const struct judge_known *known);

#define JUDGE_TOGETHER 64u /* triangles looked at together, at most */

/* As oracle_crossings; of a world as oracle_crossings_world. */
enum status judge_crossings(const struct judge *judge, const struct ray *ray, double t_most,
                            struct oracle_crossing **list, size_t *capacity, size_t *count);

/* --- judge_admit.c: what counts in a world ---------------------------------------------------- */

/* Whether an answer, whose triangle exists, is one that the world rules out, whatever the numbers:
 * WRONG_MASKED, CULLED, OPACITY, INSTANCE or FACING; else WRONG_NOT. */
enum wrong judge_ruled_out(const struct judge *judge, const struct ray *ray,
                           const struct hit *answer, uint32_t tag);

/* True if the triangle counts in every evaluation that accepts it. Always, in a scene. */
bool judge_surely_counts(const struct judge *judge, const struct ray *ray, uint32_t prim,
                         const struct twin *twin);

/* True if the triangle of a world counts in some evaluation that accepts it. */
bool judge_may_count(const struct judge *judge, const struct ray *ray, uint32_t prim);

/* True if another instance has the answered triangle where it was answered: WRONG is then
 * WRONG_INSTANCE. *found is false in a scene, and where the named triangle itself is at that t.
 * Errors: STATUS_MEMORY. */
enum status judge_is_anothers(const struct judge *judge, const struct ray *ray,
                              const struct hit *answer, bool *found);

/* --- judge.c --- */

/* As judge_answer, in_contract being that of the ray. */
enum status judge_knowing(const struct judge *judge, const struct ray *ray, bool in_contract,
                          const struct oracle_answer *truth, const struct hit *answer,
                          const struct judge_known *known, struct judgement *out);

/* Error of t over its bound, given that the exact t lies in [lo, hi]. */
double judge_over(double t, double lo, double hi, double bound);

/* True if t is in the range of the ray: open if model.open, else closed. */
bool judge_in_range(const struct judge *judge, const struct ray *ray, float t);

/* --- judge_named.c --- */

/* Is the answer right for the triangle it names, whatever else the ray hits? RIGHT: an exact hit
 * in range, t, u and v within their bounds. Else the class that excuses it, or WRONG with
 * out->wrong set. Sets out->over. */
enum verdict judge_named(const struct judge *judge, const struct ray *ray,
                         const struct oracle_answer *truth, const struct hit *answer,
                         const struct judge_known *known, struct judgement *out);

/* The class of an answer whose t, u and v are right for the triangle's plane. */
enum verdict judge_by_pair(const struct judge *judge, const struct ray *ray, uint32_t prim,
                           const struct oracle_pair *pair);

/* An answer that names a triangle which cannot be hit. Returns VERDICT_WRONG. */
static inline enum verdict judge_impossible(const struct oracle_answer *truth,
                                            struct judgement *out)
{
    return judge_set_wrong(out, truth->prim == ABI_NO_PRIM ? WRONG_PHANTOM : WRONG_TRIANGLE);
}

/* True if u and v are within the twin's bounds. */
bool judge_barycentrics(const struct twin *twin, const struct hit *answer);

/* --- judge_noise.c --- */

/* True if some evaluation of a named formula can give this answer: for a triangle whose
 * determinant's sign is open, so that no bound of t is known. */
bool judge_can_answer(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      const struct hit *answer);

/* The same for any answer in the range of the ray. */
bool judge_can_hit(const struct judge *judge, const struct ray *ray, uint32_t prim);

/* The share of an end of the range that a t of this model may lie beyond it; 0 unless it is that of
 * Embree's default test. */
double judge_share_beyond(const struct model *model);

/* True if the formula, which accepts the triangle, may answer t: in the ray's range, or as far
 * outside as a comparison before the division allows. */
bool judge_may_keep(const struct judge *judge, const struct ray *ray, uint32_t prim, float t);

/* --- judge_all.c --- */

/* As judge_list; in a world with the tags of the hits. */
enum status judge_list_tagged(const struct judge *judge, const struct ray *ray,
                              const struct hit *hit, const uint32_t *tag, size_t count,
                              struct list_judgement *out);

/* --- judge_unnamed.c --- */

/* A bit for each of the scene's triangles first .. first + count - 1, 1 to JUDGE_TOGETHER of them:
 * 0 where two edge functions surely have opposite signs, so that neither judge_may_be_hit nor a
 * formula of judge_looks_first takes it for hit. */
uint64_t judge_first_look(const struct judge *judge, const struct ray *ray, uint32_t first,
                          uint32_t count);

/* True of the models whose evaluations judge_first_look allows for. */
bool judge_looks_first(const struct model *model);

/* True if the ray's line, whatever its range, passes the box, widened by 1/16 of the largest
 * coordinate of both. False of a box that is empty. */
bool judge_comes_near(const struct ray *ray, const struct box *box);

/* Judges an any-hit answer that is a hit and names no triangle. */
void judge_unnamed_hit(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, struct judgement *out);

/* --- judge_lost.c --- */

/* The triangles that an engine found, sorted by index. */
struct judge_found {
    struct judge_slot {
        uint32_t prim;
        uint32_t at; /* place in the engine's list */
    } * slot;
    size_t count;
};

/* The entry of `prim`, the first if there are several, or NULL; `found` may be NULL. */
const struct judge_slot *judge_find(const struct judge_found *found, uint32_t prim);

/* *lost: the exact hit of `prim`, which was not found, is one that this formula cannot miss, and
 * `reach` lies clearly behind it.
 *   found   what was found; NULL: nothing
 * Errors: STATUS_MEMORY. */
enum status judge_cannot_miss(const struct judge *judge, const struct ray *ray, uint32_t prim,
                              double t_lo, double t_hi, double reach,
                              const struct judge_found *found, const struct judge_known *known,
                              bool *lost);

/* Looks for a hit that cannot be missed and is clearly nearer than `reach` (INFINITY: the answer is
 * a miss); then *lost is true and `out` names it. Errors: STATUS_MEMORY. */
enum status judge_lost(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, double reach,
                       const struct judge_known *known, bool *lost, struct judgement *out);

/* The class that excuses the loss of the exact hit of `prim`. */
enum verdict judge_why_lost(const struct judge *judge, const struct ray *ray, uint32_t prim,
                            double t_lo, double t_hi, double reach,
                            const struct judge_known *known);

/* --- judge_fan.c --- */

/* True if `prim`, a hit some of whose signs are open, lies in a closed fan one of whose triangles a
 * watertight test must hit, and none of them is among `found` (which may be NULL); then *limit is
 * the largest t that it may answer. Errors: STATUS_MEMORY. */
enum status judge_fan(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      const struct judge_found *found, bool *closed, double *limit);

/* --- judge_distance.c --- */

/* Judges an answer of an unknown formula by the displacement it needs. */
enum status judge_by_distance(const struct judge *judge, const struct ray *ray,
                              const struct oracle_answer *truth, const struct hit *answer,
                              struct judgement *out);

/* As judge_named for an unknown formula; sets out->displacement. */
enum verdict judge_named_by_distance(const struct judge *judge, const struct ray *ray,
                                     const struct oracle_answer *truth, const struct hit *answer,
                                     struct judgement *out);

/* One lost hit of an unknown formula. */
struct judge_loss {
    uint32_t prim;
    double need; /* a displacement that excuses it, in units; 0: none was lost */
    double over; /* the same over what is allowed of it: of all such the least */
    double t_lo, t_hi;
    enum verdict why; /* the class that this displacement makes of it */
    double unit;      /* u * max |vertex - origin| of the triangle */
};

/* What the loss of a hit in front of `reach` needs. */
struct judge_loss judge_loss_of(const struct judge *judge, const struct ray *ray,
                                const struct oracle_crossing *lost, double reach);

/* Distance of the ray's point at t to the triangle, in its unit. */
double judge_point_displacement(const struct ray_triangle *tri, double t);

/* --- judge_allowed.c --- */

/* One ray and triangle with the error bounds of the classical test, whatever the order of its
 * operations. w_c / D weighs vertex c and T / D is t, as in ref/oracle/oracle.h. D - t T over
 * tri.area is a distance, too. */
struct judge_rounding {
    struct ray_triangle tri;
    double edge[3], edge_most[3]; /* w_c, and the largest error of a computed one */
    double det, det_most;         /* D, likewise */
    double t, t_most;             /* T, likewise */
    double across[3];             /* |d x edge c|: w_c over it is the distance of ray and edge */
    double extra; /* displacement in units that is allowed of the transform; 0 in a scene */
};

struct judge_rounding judge_rounding_of(const struct ray *ray, float v[3][3]);

/* The same of a triangle of the scene, or of a placed one in the world. */
struct judge_rounding judge_rounding_at(const struct judge *judge, const struct ray *ray,
                                        uint32_t prim);

/* Distance of the line of the ray to the line of edge c, in the plane across the ray, in units. */
double judge_edge_distance(const struct judge_rounding *rounding, int c);

/* By how much t changes if the triangle moves one unit along its normal. */
double judge_unit_of_t(const struct judge_rounding *rounding);

/* Displacements in units that an unknown formula is allowed: of edge c seen along the ray, and of
 * the plane from the ray's point at t. At least the judge's own. */
double judge_edge_allowed(const struct judge *judge, const struct judge_rounding *rounding, int c);
double judge_plane_allowed(const struct judge *judge, const struct judge_rounding *rounding,
                           double t);

/* True if the classical test may answer this weight of vertex c. */
bool judge_weight_allowed(const struct judge_rounding *rounding, int c, double weight);

/* True if an unknown formula may accept the triangle, somewhere along the line of the ray. */
bool judge_may_accept(const struct judge *judge, const struct judge_rounding *rounding);

/* True if the determinant may have either sign. */
bool judge_det_is_open(const struct judge_rounding *rounding);

/* True if an unknown formula may see either side: the same, or vertices that move by the allowance
 * turn the triangle over, as seen along the ray. Its heights there, |det| / across, shrink by at
 * most twice as much. */
bool judge_side_is_open(const struct judge *judge, const struct judge_rounding *rounding);

/* The least |w_c| over its bound: below 1 the classical test may lose an exact hit. */
double judge_margin(const struct judge_rounding *rounding);

/* The margin of struct judgement, for an exact hit. */
double judge_margin_of(const struct judge *judge, const struct ray *ray, uint32_t prim);

#endif
