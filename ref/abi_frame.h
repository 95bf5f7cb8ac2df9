/* Further definitions shared by C and the rendering shaders, under the rules of ref/abi.h. */
#ifndef ABI_FRAME_H
#define ABI_FRAME_H

#include "ref/abi.h"

/* Additional specialization constants of the rendering shaders, see ref/frame.h. */
#define ABI_SPEC_PROFILE 8
#define ABI_SPEC_BOUNCES 9
#define ABI_SPEC_LIGHTS  10
#define ABI_SPEC_STEPS   11 /* 1: a dispatch traces one ray of each path, not all of them */
#define ABI_SPEC_TILE    12
#define ABI_SPEC_LOOK    13 /* ABI_LOOK_* */

/* Features that a scene and a frame need. */
#define ABI_LOOK_EYE      1u  /* light 0 is at the eye */
#define ABI_LOOK_AMBIENCE 2u  /* ambience > 0 */
#define ABI_LOOK_SPECULAR 4u  /* a material is specular */
#define ABI_LOOK_REFLECT  8u  /* paths can continue after a segment */
#define ABI_LOOK_SEGMENTS 16u /* segments are recorded */
#define ABI_LOOK_COLORS   32u /* colours are recorded */
#define ABI_LOOK_GENERAL                                                                           \
    64u /* bounces, lights and light 0 at the eye are read from push constants */

/* Descriptor bindings of the rendering shaders; ABI_BIND_NODES, _ITEMS and _TRIS are unchanged. */
#define ABI_BIND_STATE    0 /* uvec4[]: ABI_STATE_HEAD, then ABI_STATE_QUADS per pixel */
#define ABI_BIND_PIXELS   1 /* U32[]: colours in bits 0-23, above them serial and ABI_FLAG_* */
#define ABI_BIND_SEGMENTS 2 /* struct segment[]: bounces per pixel */
#define ABI_BIND_COLORS   6 /* float[]: 3 per pixel */
#define ABI_BIND_SHADE    7 /* shade_light[ABI_LIGHTS_MOST], shade_tri[], shade_material[] */

/* Paths in steps. Quad i of the head belongs to ray i: number of workgroups, 1, 1, number of paths
 * that have such a ray. */
#define ABI_RAYS_MOST   2112u /* per path: 64 segments with 32 lights each */
#define ABI_STATE_HEAD  2113u
#define ABI_STATE_QUADS 9u
#define ABI_FLAG_BITS   5u /* of a pixel's uppermost byte; the other three are the serial */
#define ABI_SERIALS     8u

/* Push constants of the rendering shaders. */
struct frame_push {
    U32 root; /* as struct push */
    U32 node_count;
    U32 item_count;
    U32 tri_count;
    U32 width; /* of the picture, in pixels */
    U32 height;
    U32 first_row;  /* of pixels: the buffers begin with it */
    U32 first_tile; /* of the dispatch, counted from first_row */
    U32 serial;     /* 1 to ABI_SERIALS - 1, different from the previous frame's */
    U32 look;       /* read with ABI_LOOK_GENERAL only, as are bounces and lights */
    U32 bounces;
    U32 lights;
    U32 ray;        /* in steps: how many rays of each path were traced before */
    U32 part_first; /* without a tree: the triangles tested by this dispatch */
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
#define ABI_NO_SEGMENT       0xFFFFFFFEu /* segment.prim: the path ended before this segment */

/* Shading data of a triangle: unit normals of its vertices, and the unit normal of its plane (along
 * (b - a) x (c - a); zero if it has no area). */
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

/* One segment of a path: what its ray hit (t 0 and ABI_NO_PRIM: nothing), and one bit per light. */
struct segment {
    float t;
    U32 prim;
    U32 asked;    /* lights to which a shadow ray was traced */
    U32 shadowed; /* those whose shadow ray was blocked */
};
ABI_SIZE(struct segment, 16)

#endif
