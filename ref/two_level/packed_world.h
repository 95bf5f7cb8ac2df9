/* A packed world: what engines traverse. Formats of instance nodes do not exist here: the top is a
 * tree like any other, whose items are numbers of instances. */
#ifndef PACKED_WORLD_H
#define PACKED_WORLD_H

#include "ref/layout.h"
#include "ref/two_level/world_trees.h"

/* Owns its arrays (see packed_world_free). Items of `top` are numbers of instances and are stored
 * by `indexed`; items of bottom[m] are triangles of mesh m. An instance that is not active
 * (world_is_active) is in no leaf and keeps its number. */
struct packed_world {
    struct packed top;
    struct packed *bottom;          /* one per mesh; node_count 0 if it has no triangles */
    struct instance_record *record; /* one per instance */
    struct box *box;                /* in the world, of each instance: see struct world_trees */
    uint32_t instance_count, mesh_count;
    /* Most entries of one stack that serves both levels: what the top needs, and on it what the
     * neediest bottom needs. Not over packed_world_stack_most. */
    uint32_t stack_need;
    bool split; /* a bottom is from a split tree: all hits can list a triangle twice */
};

/* Packs the trees of a world. Layouts as published (layout.faithful) have their faults as tops,
 * too: they lose the last instance. Errors, each with the level or the mesh it is about: those of
 * world_records_make; those of packed_make_stored, which has the limits of the layouts: where it
 * names triangles of the top these are instances; STATUS_LIMIT a stack over
 * packed_world_stack_most; STATUS_MEMORY. */
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
    for (uint32_t i = 0; i < packed->mesh_count; i++) {
        uint32_t bottom = layout_stack_most(packed->bottom[i].layout);
        most = bottom > most ? bottom : most;
    }
    return most;
}

/* Bytes of the nodes and the storages of both levels, and of the records. */
uint64_t packed_world_bytes(const struct packed_world *packed);

#endif
