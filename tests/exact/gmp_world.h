/* What a ray meets of a world, by another road than ref/oracle: placed vertices and the ray in the
 * space of a mesh as GMP rationals, and the rules of ref/world/world.h applied to one placed
 * triangle after another. Of ref/world only the filter's hash is used. For tests. */
#ifndef TESTS_GMP_WORLD_H
#define TESTS_GMP_WORLD_H

#include "ref/oracle/oracle_world.h"
#include "tests/exact/exact_gmp.h"

/* Where a placed triangle is, by counting; `prim` is one of the world's. */
struct place gmp_world_place(const struct world *world, uint32_t prim);

/* M^-1 d, exactly; `out` has been initialised. */
void gmp_world_object_direction(const struct instance *instance, const float d[3], mpq_t out[3]);

/* True if the line of a ray surely passes a placed triangle of vertices `p` in its mesh by, farther
 * than by 2^-16 of the distances: it spares the rationals. */
bool gmp_world_far_off(const struct instance *instance, const struct ray *ray, float p[3][3]);

/* M v + T of the vertices of a placed triangle; v has been initialised. */
void gmp_world_vertices(const struct world *world, uint32_t prim, mpq_t v[3][3]);

/* As exact_gmp_pair. */
void gmp_world_pair(const struct world *world, const struct ray *ray, uint32_t prim,
                    struct gmp_pair *pair);

/* Sign of d' . ((v1 - v0) x (v2 - v0)) in the space of the mesh, d' = M^-1 d. */
int gmp_world_facing(const struct world *world, const struct ray *ray, uint32_t prim);

/* Whether and why a triangle counts that is hit or touches the ray in its plane. */
enum oracle_admission gmp_world_admit(const struct world *world, const struct ray *ray,
                                      struct ray_mode mode, uint32_t prim,
                                      const struct gmp_pair *pair);

/* The exact nearest set of what counts. */
void gmp_world_nearest(const struct world *world, const struct ray *ray, struct ray_mode mode,
                       enum oracle_ends ends, struct gmp_nearest *out);

#endif
