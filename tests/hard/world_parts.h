/* Makes worlds and their rays for hard cases. As in tests/hard/parts.h a failure is kept in
 * part.failed. A part gets its meshes first, then its instances' numbers, then rays. */
#ifndef HARD_WORLD_PARTS_H
#define HARD_WORLD_PARTS_H

#include "tests/hard/parts.h"

/* A new part with a world of `meshes` meshes, which must all be set, and `instances` instances of
 * mesh 0: at the identity, mask 0xFF, no flags, custom index 0xC0DE00 + i. */
struct hard_part *part_world(struct hard_made *made, uint32_t meshes, uint32_t instances,
                             const char *label);

/* Instance i; of a part that failed one that nothing uses. */
struct instance *part_instance(struct hard_part *part, uint32_t i);

/* A mesh of plates: triangle k is (2k, 0, 0), (2k + 1, 0, 0), (2k, 1, 0), whose front is seen from
 * above. Geometry g has sizes[g] of them and is opaque if g is even. */
void mesh_plates(struct hard_part *part, uint32_t mesh, uint32_t geometries, const uint32_t *sizes);
/* A mesh of one opaque geometry with a generator's scene, see scene_open; seed 1. */
void mesh_open(struct hard_part *part, uint32_t mesh, const char *spec);

/* A closed cube of 12 triangles, from 0 to 1 along each axis. */
void mesh_cube(struct hard_part *part, uint32_t mesh);

/* Rows of the instance's M, and its T. */
void place_linear(struct instance *instance, const double m[3][3]);
void place_at(struct instance *instance, float x, float y, float z);
/* M of a rotation by a quaternion of whole numbers, times `size`: no libm, the same bytes on every
 * machine. */
void rotation_of(const int q[4], double size, double m[3][3]);
/* One whose numbers are drawn from -9 to 9. */
void rotation_draw(struct rng *rng, double size, double m[3][3]);

/* M p + T, in double. */
void placed_point(const struct instance *instance, const double p[3], double out[3]);
/* The number of the placed triangle. */
uint32_t placed_number(const struct hard_part *part, uint32_t instance, uint32_t prim);

/* Adds a ray whose answer is judged. */
void world_ray(struct hard_part *part, struct ray ray, struct ray_mode mode);
/* From `from` to a point of doubles; t is about 1 there. */
struct ray ray_to(const float from[3], const double to[3]);
/* Adds a ray that meets plate `prim` of an instance at u = v = 1/4 and t = 4, from above or below.
 * In the space of the mesh it runs along (slant, 0, -1) or (slant, 0, 1). */
void world_shot(struct hard_part *part, uint32_t instance, uint32_t prim, bool above, float slant,
                struct ray_mode mode);

/* The part's last ray must hit that triangle of the instance and see that side of it. */
void want_seen(struct hard_part *part, uint32_t instance, uint32_t prim, bool front);

/* What a ray of the given flags may meet; mask 0xFF. */
static inline struct ray_mode mode_of(uint32_t flags)
{
    return (struct ray_mode){0xFF, flags};
}

#endif
