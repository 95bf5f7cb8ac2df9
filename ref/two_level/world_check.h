/* Checks a packed world against its world, without rays. */
#ifndef WORLD_CHECK_H
#define WORLD_CHECK_H

#include "ref/two_level/packed_world.h"

/* Kinds of faults of a packed world. */
enum world_rule {
    WORLD_SOUND,
    WORLD_NUMBERS, /* instances or meshes are not as many as the world's; entries or trees are not
                      of instances and meshes of the world, in order */
    WORLD_RECORD,  /* a record is not its instance's: W is not the inverse rounded once, or another
                      member differs */
    WORLD_BOX,     /* a placed vertex lies outside the box of its entry; an instance that is not
                      active has a box */
    WORLD_TOP,     /* the top is no tree of its entries and their boxes, each once: the parts of
                      opened instances, and other active instances */
    WORLD_BOTTOM,  /* a bottom is no tree of its mesh, or of the triangles of a part */
    WORLD_PARTS,   /* the parts of an instance do not have each triangle of its mesh once */
    WORLD_WIDTH,   /* share or reach is less than an opened instance needs */
    WORLD_STACK    /* stack_need is less than both levels need, or over the limit */
};

/* Members of a record. */
enum record_part {
    RECORD_FIRST, /* the number of its first triangle */
    RECORD_MESH,
    RECORD_CUSTOM,
    RECORD_MASK,
    RECORD_FACING,  /* the flags about facing */
    RECORD_OPACITY, /* the flags about opacity */
    RECORD_IDENTITY,
    RECORD_TRANSLATION,
    RECORD_INVERSE,
    RECORD_PART_COUNT
};

/* Result of world_pack_check. */
struct world_faults {
    enum world_rule first; /* rule of the described fault */
    enum record_part part; /* of WORLD_RECORD: the member that differs */
    uint32_t records;      /* entries with another record */
    uint32_t boxes;        /* entries with a vertex outside their box */
    uint32_t tops;         /* 1 if packed_check finds a fault in the top */
    uint32_t bottoms;      /* trees of meshes or parts in which packed_check finds a fault */
    uint32_t parts;        /* triangles in two parts of an instance, and instances with triangles in
                              none */
    uint32_t widths;       /* opened instances that share and reach do not cover */
    uint32_t stacks;       /* 1 if stack_need is wrong */
};

/* Checks that each record is that of its instance, bit for bit; that each box contains M v + T of
 * every vertex of every triangle of its entry, by integers; that the top and every bottom pass
 * packed_check, so that each entry is reached once, each triangle of a mesh in its bottom (in a
 * split one every part of it), and nothing else; that each triangle of each active instance is in
 * one entry; that boxes are tested as wide as seams need; that the stack is as large as needed.
 * Returns STATUS_OK if it finds no fault, else STATUS_INPUT with the first fault in `reason`;
 * *faults (may be NULL) has the counts. STATUS_MEMORY leaves *faults zero. */
enum status world_pack_check(const struct world *world, const struct packed_world *packed,
                             struct world_faults *faults, struct reason *reason) MUST_USE;

#endif
