/* Further definitions shared by C and the rendering shaders, under the rules of ref/abi.h. */
#ifndef ABI_FRAME_H
#define ABI_FRAME_H

#include "ref/abi.h"

/* Frames, see ref/frame.h: specialization constants of the rendering shaders beside these. */
#define ABI_SPEC_PROFILE 8
#define ABI_SPEC_BOUNCES 9
#define ABI_SPEC_LIGHTS  10
#define ABI_SPEC_STEPS   11 /* 1: a dispatch traces one ray of each path, not all of them */
#define ABI_SPEC_TILE    12
#define ABI_SPEC_LOOK    13 /* ABI_LOOK_* */

/* Features that a scene and a frame need. */
#define ABI_LOOK_EYE      1u  /* light 0 stands at the eye */
#define ABI_LOOK_AMBIENCE 2u  /* there is some */
#define ABI_LOOK_SPECULAR 4u  /* a material has some */
#define ABI_LOOK_REFLECT  8u  /* paths can continue after a segment */
#define ABI_LOOK_SEGMENTS 16u /* segments are recorded */
#define ABI_LOOK_COLORS   32u /* colours are recorded */
#define ABI_LOOK_GENERAL                                                                           \
    64u /* numbers of bounces and lights, and EYE, are of the push constants                       \
         */

/* Their descriptor bindings; ABI_BIND_NODES, _ITEMS and _TRIS are the same. */
#define ABI_BIND_STATE    0 /* uvec4[]: ABI_STATE_HEAD, then ABI_STATE_QUADS per pixel */
#define ABI_BIND_PIXELS   1 /* U32[]: colours in bits 0-23, above them serial and ABI_FLAG_* */
#define ABI_BIND_SEGMENTS 2 /* struct segment[]: bounces per pixel */
#define ABI_BIND_COLORS   6 /* float[]: 3 per pixel */
#define ABI_BIND_SHADE    7 /* shade_light[ABI_LIGHTS_MOST], shade_tri[], shade_material[] */

/* Paths in steps. Quad i of the head is of ray i: how many workgroups there are, 1, 1, how many
 * paths have such a ray. */
#define ABI_RAYS_MOST   2112u /* of a path: 64 segments with 32 lights each */
#define ABI_STATE_HEAD  2113u
#define ABI_STATE_QUADS 9u
#define ABI_FLAG_BITS   5u /* of a pixel's uppermost byte; the serial has the other three */
#define ABI_SERIALS     8u

/* Push constants of the rendering shaders. */
struct frame_push {
    U32 root; /* as struct push */
    U32 node_count;
    U32 item_count;
    U32 tri_count;
    U32 width; /* of the picture */
    U32 height;
    U32 first_row;  /* of pixels: the buffers begin with it */
    U32 first_tile; /* of the dispatch, counted from there */
    U32 serial;     /* 1 to ABI_SERIALS - 1, other than of the frame before */
    U32 look;       /* ABI_LOOK_GENERAL reads these three */
    U32 bounces;
    U32 lights;
    U32 ray;        /* how many rays of each path were traced before, where they go in steps */
    U32 part_first; /* triangles of this dispatch, where every one is tested */
    U32 part_last;
    float ambience;
    float tmin;
    float tmax;
    float offset;
    float centre; /* struct view */
    float pos[3];
    float right[3];
    float up[3];
    float forward[3];
};
ABI_SIZE(struct frame_push, 128)

#define ABI_PROFILE_REPAIRED 0u
#define ABI_PROFILE_RTRS     1u
#define ABI_LIGHTS_MOST      32u         /* bits of segment.asked */
#define ABI_NO_SEGMENT       0xFFFFFFFEu /* segment.prim: the path ended before */

/* What shading needs of a triangle: unit normals of its vertices, the unit normal of its plane
 * (along (b - a) x (c - a); zero if it has no area). */
struct shade_tri {
    float na[3];
    U32 material;
    float nb[3];
    U32 pad0;
    float nc[3];
    U32 pad1;
    float plane[3];
    U32 pad2;
};
ABI_SIZE(struct shade_tri, 64)

struct shade_material {
    float color[3];
    float spec; /* exponent */
    float diffuse, specular, reflective;
    U32 pad;
};
ABI_SIZE(struct shade_material, 32)

struct shade_light {
    float pos[3];
    float strength;
};
ABI_SIZE(struct shade_light, 16)

/* One segment of a path: what its ray hit (t 0 and ABI_NO_PRIM: nothing), and bits of lights. */
struct segment {
    float t;
    U32 prim;
    U32 asked;    /* lights that a shadow ray was sent to */
    U32 shadowed; /* those of them that it did not reach */
};
ABI_SIZE(struct segment, 16)

#endif
