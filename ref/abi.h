/* Everything that C and the shaders both read. Compiled as C17 and as GLSL 4.50, so it contains
 * only #define and structs of 4-byte scalars and arrays of them; no function (a shared decoder
 * would make both sides wrong together), no 16-bit member (halves are packed in words).
 * tests/base/test_abi.c checks the layout on the installed driver. */
#ifndef ABI_H
#define ABI_H

#ifdef VULKAN
#define U32 uint
#define ABI_SIZE(type, bytes)
#else
#include <stdint.h>
#define U32                   uint32_t
#define ABI_SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), #type);
#endif

#define ABI_NO_PRIM    0xFFFFFFFFu /* hit.prim of a miss; an empty item slot */
#define ABI_STACK_MAX  64u         /* largest traversal stack of a binary layout, in entries */
#define ABI_STACK_WIDE 256u        /* the same for a wide layout; a node pushes up to 8 */
#define ABI_WORKGROUP  64u         /* default rays per workgroup */
#define ABI_TRI_FLOATS 9u          /* floats per gathered triangle: v0, v1, v2 */

/* Specialization constant ids of every tracing shader. */
#define ABI_SPEC_WORKGROUP 0
#define ABI_SPEC_BOX       1 /* enum box_test_id */
#define ABI_SPEC_TRI       2 /* enum tri_test_id */
#define ABI_SPEC_QUERY     3 /* enum query */
#define ABI_SPEC_STACK     4 /* entries of the traversal stack: 16, 32 or 64; wide: 128, 256 */
#define ABI_SPEC_STORE     5 /* ABI_STORE_* */
#define ABI_SPEC_LAYOUT_0  6 /* layout.constant of a layout that shares its shader with others */
#define ABI_SPEC_LAYOUT_1  7

/* Values of ABI_SPEC_BOX, ABI_SPEC_TRI, ABI_SPEC_QUERY and ABI_SPEC_STORE. */
#define ABI_BOX_RTRS             0u
#define ABI_BOX_ROBUST           1u
#define ABI_BOX_WATERTIGHT       2u
#define ABI_TRI_MT_RTRS          0u
#define ABI_TRI_MT               1u
#define ABI_TRI_WOOP             2u
#define ABI_TRI_PLUECKER         3u
#define ABI_TRI_BALDWIN_WEBBER   4u
#define ABI_QUERY_CLOSEST        0u
#define ABI_QUERY_ANY            1u
#define ABI_QUERY_ALL            2u
#define ABI_STORE_INDEXED        0u /* also for layouts that store items in nodes */
#define ABI_STORE_GATHERED       1u
#define ABI_STORE_EDGES          2u
#define ABI_STORE_BALDWIN_WEBBER 3u
#define ABI_STORE_COMPACT        4u
#define ABI_STORE_QUANTISED      5u
#define ABI_STORE_TRUNCATED      6u
#define ABI_STORE_DGF1           7u

/* ABI_SPEC_LAYOUT_0 and _1 for the shaders grid2, grid4 and grid8: number format and frame. */
#define ABI_NUMBER_F32  0u
#define ABI_NUMBER_F16  1u
#define ABI_NUMBER_BF16 2u
#define ABI_NUMBER_U8   3u
#define ABI_NUMBER_U10  4u
#define ABI_NUMBER_U12  5u
#define ABI_NUMBER_U16  6u
#define ABI_FRAME_WORLD 0u
#define ABI_FRAME_SCENE 1u
#define ABI_FRAME_NODE  2u

/* Descriptor bindings, set 0. */
#define ABI_BIND_RAYS  0 /* struct ray[] */
#define ABI_BIND_HITS  1 /* struct hit[]: one per ray, or push.capacity per ray */
#define ABI_BIND_FLAGS 2 /* U32[]: ABI_FLAG_* per ray */
#define ABI_BIND_NODES 3 /* U32[]: the packed words of the layout */
#define ABI_BIND_ITEMS 4 /* U32[]: the words of the triangle storage, if the layout has one */
#define ABI_BIND_TRIS  5 /* float[]: ABI_TRI_FLOATS per triangle, in scene order; if read */
#define ABI_BIND_FOUND 6 /* U32[]: ABI_QUERY_ALL: number of triangles each ray hit; else unused */
#define ABI_BIND_ASKED 7 /* U32[2]: decoding shaders only: a record and what to read from it */

/* Decoding shaders: kind of node. */
#define ABI_DECODED_NONE  0u
#define ABI_DECODED_INNER 1u
#define ABI_DECODED_LEAF  2u

#define ABI_FLAG_DONE      1u  /* the invocation completed */
#define ABI_FLAG_EXHAUSTED 2u  /* the result is invalid; a flag below gives the cause */
#define ABI_FLAG_STACK     4u  /* the traversal stack was full */
#define ABI_FLAG_VISITS    8u  /* more visits than nodes */
#define ABI_FLAG_LOOP      16u /* a loop ended before its own condition was met */

/* A ray. t is in multiples of dir, which need not have length 1. */
struct ray {
    float org[3];
    float tmin;
    float dir[3];
    float tmax;
};
ABI_SIZE(struct ray, 32)

/* A result. u is the weight of vertex 1 and v of vertex 2; a miss is 0, 0, 0, ABI_NO_PRIM. */
struct hit {
    float t;
    float u;
    float v;
    U32 prim;
};
ABI_SIZE(struct hit, 16)

/* Push constants of the tracing shaders. */
struct push {
    U32 ray_count;
    U32 root;       /* packed.root */
    U32 node_count; /* packed.ref_count, also the limit of node visits per ray; binary: records */
    U32 item_count; /* words of the triangle storage */
    U32 tri_count;
    U32 capacity; /* ABI_QUERY_ALL: the most hits per ray; hits of ray i begin at hit[i *
                     capacity] */
};
ABI_SIZE(struct push, 24)

/* One node of layout f32. Inner: first is the index of the second child (the first child follows
 * its parent directly), count is 0. Leaf: items first .. first + count - 1 of the item array. */
struct node_f32 {
    float lo[3];
    U32 first;
    float hi[3];
    U32 count;
};
ABI_SIZE(struct node_f32, 32)

/* One 16-byte record of the reduced-footprint layouts: word k holds the half floats of axis k, the
 * lower bound in the low half. The meaning of tag depends on the layout, see ref/layouts/. */
struct node_rf {
    U32 bounds[3];
    U32 tag;
};
ABI_SIZE(struct node_rf, 16)

/* One node of layout rtrs_direct, 48 bytes; the pads are zero. */
struct node_rtrs_direct {
    U32 fst;
    U32 snd;
    U32 item_first;
    U32 item_count;
    float lo[3];
    U32 pad0;
    float hi[3];
    U32 pad1;
};
ABI_SIZE(struct node_rtrs_direct, 48)

#endif
