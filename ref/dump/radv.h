/* Acceleration structures that RADV, Mesa's Vulkan driver for AMD's cards, serialises, as cards of
 * GFX10.3 to GFX11.5 take them. For the files of its reader.
 *
 * The first UUID is "AMD-MESA-DRV", the second the driver's build. A top level has a handle for
 * each instance: the address of its structure. Behind them comes the structure itself
 * (src/amd/vulkan/bvh/bvh.h of Mesa 25.0), then room, so that all but it is a multiple of 128
 * bytes:
 *   head      104 bytes: offset of the nodes, an unused word, the root's bounds (least x y z, most
 *             x y z), size of the structure and that of all (64 bits each), words without meaning;
 *             at 80 the offset of the leaves and at 88 the number of instances, 64 bits each
 *   ways back of each 64 bytes of nodes the parent, in reverse order; not looked at
 *   nodes     first the root, which is a box of floats, then leaves, then boxes. A box: four
 *             children, then the bounds of each, as floats (128 bytes in all) or as halves (64). A
 *             triangle, 64 bytes: three vertices, three unused words, its number, that of its
 *             geometry (28 bits) and flags. An instance, 128 bytes: pointer to its structure's
 *             nodes, custom index and mask, offset and flags, the transform back (3 rows of 4), its
 *             number, where the nodes begin in its structure, two unused words, the transform
 * A child is its offset from the first node in units of 8 bytes, a multiple of 64 bytes, with its
 * kind in the three low bits; or all ones: none. A pointer holds bits 6 to 47 of the address,
 * shifted down by 3. */
#ifndef RADV_H
#define RADV_H

#include "ref/dump/serialised.h"

#define RADV_HEAD 104u
#define RADV_SLOT 64u /* nodes have one or two of these */

/* Where words of an instance are. */
#define RADV_POINTER 0u
#define RADV_BEGIN   68u

/* One structure of a file. */
struct radv_level {
    const char *name; /* of the file */
    uint64_t begin;   /* in the file */
    const char *at;   /* the structure, behind its handles */
    const char *node; /* the first of its nodes */
    uint64_t slots;   /* 64 bytes of nodes each */
    uint32_t handles; /* which lie before `at`; not 0: a top level */
};

/* Byte `at` of instance i of a top level. */
static inline const char *radv_instance(const struct radv_level *level, uint32_t i, size_t at)
{
    return level->node + 2 * RADV_SLOT * ((size_t)i + 1) + at;
}

/* Reads the nodes that the root leads to, numbered by their places; instances get no trees: `below`
 * is which of the file it is. Errors: STATUS_INPUT "NAME: structure at byte N: rule": a child that
 * leads out of the nodes, into another or to one that is not of the level's kind, a transform that
 * is not finite; STATUS_MEMORY. *out is freed by the caller also on error. */
enum status radv_read_level(const struct radv_level *level, struct tree_dump *out,
                            struct reason *reason) MUST_USE;

#endif
