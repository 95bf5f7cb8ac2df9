/* What C and the shaders that trace worlds both read, besides ref/abi.h; under the same rules. */
#ifndef ABI_WORLD_H
#define ABI_WORLD_H

#include "ref/abi.h"

/* Binding 7 of these shaders: the world, in quads of four words. Trees come first, the top and then
 * that of each mesh, ABI_WORLD_TREE quads each:
 *   0  first word of its nodes, first word of its items, number of its first triangle, root
 *   1  packed.ref_count, packed.item_count, number of triangles (top: of instances), number of its
 *      first geometry
 *   2  number of its geometries, 0, 0, 0
 * Then a struct instance_record per instance, and a quad per geometry: first triangle, number of
 * triangles, 1 if it is opaque, 0. */
#define ABI_BIND_WORLD       7
#define ABI_WORLD_TREE       3u /* quads */
#define ABI_WORLD_INSTANCE   4u
#define ABI_WORLD_RAY        3u /* struct ray, then the words of a struct ray_mode and two of 0 */
#define ABI_WORLD_HIT        2u /* struct hit, then the tag and three words of 0 */
#define ABI_WORLD_QUAD_BYTES 16u

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
};
ABI_SIZE(struct world_push, 32)

#endif
