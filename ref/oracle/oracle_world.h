/* The oracle of a world (ref/world/world.h): what a ray exactly hits of meshes placed by instances.
 * A placed triangle has the vertices M v + T of real numbers; t counts in multiples of the ray's
 * direction. Triangles are named by their numbers in the world.
 *
 * oracle_pair, oracle_compare, oracle_rational and oracle_t_text take an oracle of a world, too,
 * and decide geometry alone: no mask, flag or filter, and inactive instances that have a mesh as
 * well.
 *
 * Facing. With e1 and e2 two edges of the triangle in its mesh, (M e1) x (M e2) = det(M) M^-T (e1 x
 * e2). So D = d . ((M e1) x (M e2)) = det(M) (M^-1 d) . (e1 x e2) = det(M) D', and D', the D of the
 * space of the mesh, has the sign of D times that of det M. */
#ifndef ORACLE_WORLD_H
#define ORACLE_WORLD_H

#include "ref/oracle/oracle.h"
#include "ref/world/world.h"

/* Makes the oracle of `world`, which is borrowed and must have passed world_finish: an oracle a
 * mesh, however many instances it has, and some 150 bytes and 2 us an instance. Errors as
 * oracle_make. */
enum status oracle_make_world(const struct world *world, struct oracle **out,
                              struct reason *reason) MUST_USE;

/* The world that the oracle was made of; NULL if it was a scene. */
const struct world *oracle_world(const struct oracle *oracle);

/* --- what counts ------------------------------------------------------------------------------
 * Here an oracle of a scene counts as one of world_of_scene. */

/* Whether a triangle that is hit shows its front. pair->det is not 0. */
bool oracle_is_front(const struct oracle *oracle, const struct oracle_pair *pair, uint32_t prim);

/* Why a triangle on a ray does not count: the first of these that holds. */
enum oracle_admission {
    ORACLE_ADMITTED,
    ORACLE_MASKED,         /* the instance is inactive, or the ray's mask or flags leave it out */
    ORACLE_CULLED_OPACITY, /* as opaque, or as not opaque */
    ORACLE_CULLED_FACING,
    ORACLE_FILTERED, /* it is not opaque, and the filter passes it over */
    ORACLE_ADMISSION_COUNT
};

/* Whether a triangle counts that is hit, or that touches the ray in its plane. `pair` is what
 * oracle_pair gives of it. In plane there is neither facing nor u and v: culling by facing admits
 * it, and so does a filter that reads these. */
enum oracle_admission oracle_admit(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, uint32_t prim,
                                   const struct oracle_pair *pair);

/* "admitted", "masked", "culled by opacity", "culled by facing", "filtered". */
const char *oracle_admission_name(enum oracle_admission admission);

/* Encloses u = w1 / D and v = w2 / D of a triangle that is hit: u[0] <= u <= u[1], v likewise, in
 * double, at most 3 neighbours apart. */
void oracle_weights(const struct oracle *oracle, const struct ray *ray, uint32_t prim, double u[2],
                    double v[2]);

/* Whether the filter's answer on a triangle that is hit could be another if u were up to du and v
 * up to dv off: false if it is opaque, and of filters that do not read u and v. du, dv >= 0. It is
 * true, too, if a few neighbours in double farther off it could. */
bool oracle_filter_is_open(const struct oracle *oracle, const struct ray *ray, struct ray_mode mode,
                           uint32_t prim, double du, double dv);

/* --- rays ------------------------------------------------------------------------------------- */

/* Exact nearest hits of `count` rays in the oracle's world, of the triangles that count; everything
 * else as oracle_closest. Ties are counted across instances. ORACLE_SAW_IN_PLANE is set for
 * triangles that oracle_admit admits.
 *   mode   one per ray, each as ray_mode_check takes it; NULL: ray_mode_all
 * ABI_RAY_FIRST changes nothing. ORACLE_AUTO is ORACLE_TREE: about 1 to 4 us a ray on a
 * thousand instances of a mesh of 10^4 triangles. Errors: none. */
enum status oracle_closest_world(const struct oracle *oracle, enum oracle_path path,
                                 enum oracle_ends ends, const struct ray *ray,
                                 const struct ray_mode *mode, size_t count, unsigned threads,
                                 struct oracle_answer *out, struct oracle_stats *stats,
                                 struct reason *reason) MUST_USE;

/* As oracle_crossings, of the triangles of the oracle's world that count for `mode`. */
enum status oracle_crossings_world(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, double t_most,
                                   struct oracle_crossing **list, size_t *capacity, size_t *count,
                                   struct reason *reason) MUST_USE;

#endif
