/* A packed world: what engines traverse. Formats of instance nodes do not exist here: the top is a
 * tree like any other, whose items are numbers of instances. */
#ifndef PACKED_WORLD_H
#define PACKED_WORLD_H

#include "ref/layout.h"
#include "ref/two_level/world_trees.h"

/* Owns its arrays (see packed_world_free). The top's entries are the instances and, behind them,
 * the parts of those that are opened (ref/two_level/braid.h). Items of `top` are numbers of entries
 * and are stored by `indexed`. bottom[m] is the tree of mesh m, whose triangles are its items;
 * behind them are trees of parts, of some of the triangles of a mesh, shared by all entries of the
 * same part. An instance that is not active (world_is_active) is in no leaf of the top, nor is one
 * that is opened, and both keep their numbers. */
struct packed_world {
    struct packed top;
    struct packed *bottom; /* tree_count; node_count 0 if the mesh has no triangles */
    uint32_t *mesh;        /* of each tree; mesh[m] is m below mesh_count */
    /* One per entry. That of a part is its instance's, but `mesh` is the number of its tree. */
    struct instance_record *record;
    uint32_t *instance; /* of each entry */
    struct box *box;    /* in the world, of each entry: see struct world_trees */
    uint32_t instance_count, entry_count, mesh_count, tree_count;
    float share, reach; /* of braid_width; 0 without parts */
    /* Most entries of one stack that serves both levels: what the top needs, and on it what the
     * neediest bottom needs. Not over packed_world_stack_most. */
    uint32_t stack_need;
    bool split; /* a bottom is from a split tree: all hits can list a triangle twice */
};

/* Packs the trees of a world. Layouts as published (layout.faithful) have their faults as tops,
 * too: they lose the last instance. Errors, each with the level or the mesh it is about: those of
 * world_records_make; those of packed_make_stored, which has the limits of the layouts: where it
 * names triangles of the top these are instances; STATUS_LIMIT a stack over
 * packed_world_stack_most, or 2^32 - 1 trees; STATUS_MEMORY. */
enum status packed_world_make(const struct world *world, const struct world_trees *trees,
                              const struct layout *top, const struct layout *bottom,
                              const struct tri_store *store, struct packed_world *out,
                              struct reason *reason) MUST_USE;

void packed_world_free(struct packed_world *packed); /* a zero one is fine */

/* Makes the records of all instances, instance_count of them; that of an instance that is not
 * active has no inverse, zeros, and mesh WORLD_NO_MESH. Caller frees *out. Errors: STATUS_LIMIT the
 * inverse of a transform is beyond float32, with the instance; STATUS_MEMORY. */
enum status world_records_make(const struct world *world, struct instance_record **out,
                               struct reason *reason) MUST_USE;

/* The largest stack of a traversal of both levels: that of the layout which has more. */
static inline uint32_t packed_world_stack_most(const struct packed_world *packed)
{
    uint32_t top = layout_stack_most(packed->top.layout), most = top;
    for (uint32_t i = 0; i < packed->tree_count; i++) {
        uint32_t bottom = layout_stack_most(packed->bottom[i].layout);
        most = bottom > most ? bottom : most;
    }
    return most;
}

/* Finds stack_need, for which only trees that a ray can get to count. Errors: STATUS_LIMIT it is
 * over packed_world_stack_most. */
enum status packed_world_stack(struct packed_world *packed, struct reason *reason) MUST_USE;

/* Bytes of the nodes and the storages of both levels, and of the records. */
uint64_t packed_world_bytes(const struct packed_world *packed);

#endif
