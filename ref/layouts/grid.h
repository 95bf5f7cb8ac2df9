/* The grid family: layouts of slotted nodes that differ in the number of children of a node (2, 4
 * or 8), in the number format of a bound and in the frame that scales it. All of them are data for
 * the same functions (grid.c) and for one shader per width (shaders/grid.glsl).
 *
 * A record, in words:
 *   0     record of the first child that is inner; the others follow, in the order of slots
 *   1     first item of the first child that is a leaf; the others follow
 *   2 ..  a byte for each slot (4 per word): inner: 128 + number of inner slots before it; leaf:
 *         its items minus 1 in bits 5 and 6, its first item minus word 1 in bits 0-4; 255 empty
 *   then, if each node has its frame: origin x, y, z, and the biased exponents of the scales in
 *         bits 0-7, 8-15, 16-23
 *   then, for each slot, lower x, upper x, lower y, upper y, lower z, upper z: consecutive codes
 *         from the lowest bit on, also across the end of a word; 10-bit codes three per word
 *
 * If the scene has the frame, it is record 0 (words 0-3 as above), and the root is record 1. */
#ifndef GRID_H
#define GRID_H

#include "ref/layouts/grid_number.h"

#define GRID_LEAF_MOST 4u /* most items of a leaf */

/* Combinations of format and frame, for each width all that make sense: integers need a frame, and
 * float32 needs none. Two children with float32 would be layout f32 in other words. */
#define GRID_OF(X, width)                                                                          \
    X(width, f16, F16, world, WORLD)                                                               \
    X(width, f16, F16, scene, SCENE)                                                               \
    X(width, f16, F16, node, NODE)                                                                 \
    X(width, bf16, BF16, world, WORLD)                                                             \
    X(width, bf16, BF16, scene, SCENE)                                                             \
    X(width, u8, U8, scene, SCENE)                                                                 \
    X(width, u8, U8, node, NODE)                                                                   \
    X(width, u10, U10, scene, SCENE)                                                               \
    X(width, u10, U10, node, NODE)                                                                 \
    X(width, u12, U12, scene, SCENE)                                                               \
    X(width, u12, U12, node, NODE)                                                                 \
    X(width, u16, U16, scene, SCENE)                                                               \
    X(width, u16, U16, node, NODE)

/* All layouts of the family: X(width, format, FORMAT, frame, FRAME) for each. */
#define GRID_MEMBERS(X)                                                                            \
    GRID_OF(X, 2)                                                                                  \
    X(4, f32, F32, world, WORLD)                                                                   \
    GRID_OF(X, 4)                                                                                  \
    X(8, f32, F32, world, WORLD)                                                                   \
    GRID_OF(X, 8)

/* Name of the struct layout of one of them. */
#define GRID_SYMBOL(width, format, frame) layout_bvh##width##_##format##_##frame

#endif
