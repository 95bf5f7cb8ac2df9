/* Fast traversal of a world: a tree of ref/fast/fast.h over the boxes of the instances, one
 * instance a leaf, and one over the triangles of each mesh. Rays enter instances by the contract of
 * ref/world/object_ray.h, and the triangle test has the operations of tri_woop, so hits have the
 * bits of the reference's. What counts as a hit is decided as in ref/world/candidate.h. */
#ifndef FAST_WORLD_H
#define FAST_WORLD_H

#include "ref/fast/fast.h"
#include "ref/world/world.h"

/* An instance in one cache line: what struct instance_record has, its matrix by columns. */
struct fast_instance {
    _Alignas(64) float column[3][4]; /* column j of the inverse, and T_j */
    uint32_t mesh;
    uint32_t custom_mask;
    uint32_t first;
    uint32_t flags;
};
_Static_assert(sizeof(struct fast_instance) == 64, "one line");

/* Owns its arrays (see fast_world_free), and borrows the world and the records, which need not be
 * there any more when it is freed. */
struct fast_world {
    struct fast_tree top;
    struct fast_tree *bottom; /* one per mesh, mesh_count of them */
    uint32_t mesh_count;
    struct fast_instance *instance;
    const struct instance_record *record;
    const struct world *world;
    bool plain; /* no candidate is left to the filter, unless a ray's flags do so */
};

/* Makes the fast form of a world from trees over its instances and over the triangles of each mesh,
 * whose form has been checked.
 *   top     items are numbers of instances; a tree without nodes if none is active
 *   items   the triangles that stand for the instances (world_items_make)
 *   bottom  one per mesh
 *   record  one per instance (world_records_make)
 * Errors: those of fast_make, with the level or mesh; STATUS_MEMORY. On error *out is zero. */
enum status fast_world_make(const struct world *world, const struct bvh *top,
                            const struct scene *items, const struct bvh *bottom,
                            const struct instance_record *record, struct fast_world *out,
                            struct reason *reason) MUST_USE;

void fast_world_free(struct fast_world *fast); /* a zero one is fine */

/* Bytes of the nodes and blocks of both levels, and of the instances. */
uint64_t fast_world_bytes(const struct fast_world *fast);

/* Traces a ray of which a kernel cannot traverse the top, as fast_careful does a tree. */
void fast_careful_world(const struct fast_world *fast, const struct ray *ray, struct ray_mode mode,
                        bool any, struct hit *hit, uint32_t *tag);

/* Goes on with a ray in one instance, of which a kernel cannot traverse the tree.
 *   inside  the ray in the space of the mesh
 *   hit     the nearest hit so far, or a miss; replaced, with its tag, by what is nearer and counts
 * Returns true if it was replaced. */
bool fast_careful_instance(const struct fast_world *fast, uint32_t instance,
                           const struct ray *inside, struct ray_mode mode, bool any,
                           struct hit *hit, uint32_t *tag);

/* Finds all triangles that the ray hits and that count, as trace_world_ray_all writes them. Returns
 * their number, which may be over `capacity`. */
uint32_t fast_world_all(const struct fast_world *fast, const struct ray *ray, struct ray_mode mode,
                        uint32_t capacity, struct hit *hit, uint32_t *tag);

#endif
