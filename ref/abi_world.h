/* What C and the shaders both read of worlds (ref/world/world.h), by the rules of ref/abi.h. */
#ifndef ABI_WORLD_H
#define ABI_WORLD_H

#include "ref/abi.h"

#define ABI_CUSTOM_MOST 0xFFFFFFu /* largest custom index of an instance */

/* Flags of an instance; the values of VkGeometryInstanceFlagBitsKHR. */
#define ABI_INSTANCE_CULL_DISABLE    1u
#define ABI_INSTANCE_FLIP_FACING     2u
#define ABI_INSTANCE_FORCE_OPAQUE    4u
#define ABI_INSTANCE_FORCE_NO_OPAQUE 8u
#define ABI_INSTANCE_FLAGS           15u

/* Flags of a ray; the values of SPIR-V's ray flags. */
#define ABI_RAY_OPAQUE         0x01u
#define ABI_RAY_NO_OPAQUE      0x02u
#define ABI_RAY_FIRST          0x04u /* ends at the first confirmed hit, like ABI_QUERY_ANY */
#define ABI_RAY_SKIP_CLOSEST   0x08u /* no closest-hit shader: of no meaning to a query */
#define ABI_RAY_CULL_BACK      0x10u
#define ABI_RAY_CULL_FRONT     0x20u
#define ABI_RAY_CULL_OPAQUE    0x40u
#define ABI_RAY_CULL_NO_OPAQUE 0x80u
#define ABI_RAY_SKIP_TRIANGLES 0x100u
#define ABI_RAY_FLAGS          0x1FFu

/* Filters, and the cells of one along u and along v. */
#define ABI_FILTER_ALL       0u
#define ABI_FILTER_NONE      1u
#define ABI_FILTER_TRIANGLES 2u
#define ABI_FILTER_CELLS     3u
#define ABI_FILTER_GRID      4u

#define ABI_INSTANCE_IDENTITY 16u /* instance_record.flags: rays are not transformed */

/* An instance as engines read it, or a part of one (ref/two_level/braid.h).
 * ref/world/object_ray.h says what w and t are for. */
struct instance_record {
    float w[9]; /* the inverse of M, row by row */
    float t[3];
    U32 first;       /* number of its first placed triangle */
    U32 mesh;        /* 0xFFFFFFFF: inactive; of a part: the number of its tree */
    U32 custom_mask; /* custom index; in the upper 8 bits the mask */
    U32 flags;       /* ABI_INSTANCE_* */
};
ABI_SIZE(struct instance_record, 64)

/* What a ray of a world may meet. */
struct ray_mode {
    U32 mask;  /* 8 bits */
    U32 flags; /* ABI_RAY_* */
};
ABI_SIZE(struct ray_mode, 8)

/* What a hit in a world says besides struct hit: the custom index of its instance, and which side
 * was seen. 0 for a miss. */
#define ABI_TAG_CUSTOM 0xFFFFFFu
#define ABI_TAG_FRONT  0x80000000u

/* Binding 7 of these shaders: the world, in quads of four words. Trees come first, the top and then
 * that of each mesh, then those of parts of meshes, ABI_WORLD_TREE quads each:
 *   0  first word of its nodes, first word of its items, number of its mesh's first triangle, root
 *   1  packed.ref_count, packed.item_count, number of triangles of its mesh (top: of entries),
 *      number of its mesh's first geometry
 *   2  number of its mesh's geometries, 0, 0, 0
 * Then a struct instance_record per entry of the top: instances, then parts of instances; a word
 * per part, the number of its instance, up to a whole quad; and a quad per geometry: first
 * triangle, number of triangles, 1 if it is opaque, 0. */
#define ABI_BIND_WORLD       7
#define ABI_WORLD_TREE       3u /* quads */
#define ABI_WORLD_INSTANCE   4u
#define ABI_WORLD_RAY        3u /* struct ray, then the words of a struct ray_mode and two of 0 */
#define ABI_WORLD_HIT        2u /* struct hit, then the tag and three words of 0 */
#define ABI_WORLD_QUAD_BYTES 16u

/* Shader query_world traces the driver's own trees, in binding 8. Its world is a quad for each
 * instance (push.records): number of its first placed triangle, number of its first geometry,
 * number of its geometries (0: no mesh), its flags; then the quads of geometries as above, of each
 * mesh once. */
#define ABI_BIND_STRUCTURE 8

#define ABI_PHANTOM 0xFFFFFFFEu /* hit.prim of an answer that names no triangle of the world */

/* Push constants. */
struct world_push {
    U32 ray_count;
    U32 capacity; /* as of struct push */
    U32 instance_count;
    U32 records; /* first quad of the records, and of the geometries */
    U32 geometries;
    U32 filter_kind; /* ABI_FILTER_* */
    U32 filter_seed;
    U32 filter_share;
    U32 first; /* world_brute: placed triangles first .. last - 1 are tested */
    U32 last;
    U32 index;       /* of the instance that triangle `first` belongs to */
    U32 entry_count; /* of the top: instances and parts */
    float share;     /* of braid_width (ref/two_level/braid.h); 0 without parts */
    float reach;
};
ABI_SIZE(struct world_push, 56)

#endif
