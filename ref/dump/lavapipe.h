/* Acceleration structures that lavapipe, Mesa's Vulkan driver on the processor, serialises. For the
 * files of its reader.
 *
 * Both UUIDs are the package's version, cut at 16 characters. Behind the handles comes the
 * structure itself (src/gallium/frontends/lavapipe/lvp_acceleration_structure.h of Mesa 25.0), with
 * offsets counted from its begin:
 *   head      40 bytes: bounds (least x y z, most x y z), size of all, handles, offset of the
 *             leaves, a word without meaning
 *   boxes     56 bytes each: bounds of two children, then both as words; the first is the root
 *   leaves    48 bytes of a triangle: three vertices, an unused word, number of the triangle,
 *             number of its geometry (28 bits) and flags; 120 bytes of an instance: handle of the
 *             bottom level, custom index and mask, offset and flags, the transform back (3 rows of
 *             4), an unused word, number of the instance, the transform
 * A child is its offset with its kind in the two low bits: 0 a triangle, 1 a box, 2 an instance, 3
 * a box of a shader's own; or all ones: none. Room that is not used, behind the boxes and behind
 * the leaves, is 0. */
#ifndef LAVAPIPE_H
#define LAVAPIPE_H

#include "ref/dump/serialised.h"

#define LVP_HEAD     40u
#define LVP_BOX      56u
#define LVP_TRIANGLE 48u
#define LVP_INSTANCE 120u

/* One structure of a file. */
struct lvp_level {
    const char *name; /* of the file */
    uint64_t begin;   /* in the file */
    const char *at;   /* the structure, behind its handles */
    uint64_t size;    /* bytes of it */
    uint32_t handles; /* which lie before `at`; not 0: a top level */
    uint32_t leaf_at; /* offset of the leaves */
};

/* Reads the boxes and leaves of a level; instances get no trees. Errors: STATUS_INPUT "NAME:
 * structure at byte N: rule": a child that leads to no box or leaf of the level's kind, a transform
 * that is not finite; STATUS_MEMORY. *out is freed by the caller also on error. */
enum status lavapipe_read_level(const struct lvp_level *level, struct tree_dump *out,
                                struct reason *reason) MUST_USE;

/* "NAME: structure at byte N: ", and a rule. Returns STATUS_INPUT. */
enum status lavapipe_fail(const struct lvp_level *level, struct reason *reason, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));

#endif
