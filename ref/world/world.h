/* A world: meshes, placed by instances. A scene is a world of one instance whose transform is the
 * identity. The rules are those of Vulkan's and DXR's acceleration structures (Vulkan
 * specification, chapters "Acceleration Structures" and "Ray Traversal"; DXR functional
 * specification, "Ray flags" and "Instance masking").
 *
 * A placed triangle is a triangle of one instance. Placed triangles are numbered through the world,
 * instance by instance: number world.first[i] + k is triangle k of the mesh of instance i. Hits
 * name placed triangles (struct hit.prim), so that whatever counts or compares the triangles of a
 * scene does the same with those of a world. Its vertices are M v + T of real numbers, exactly. */
#ifndef WORLD_H
#define WORLD_H

#include "ref/abi_world.h"
#include "ref/scene/scene.h"

/* The triangles first .. first + count - 1 of a mesh. */
struct geometry {
    uint32_t first, count;
    bool opaque; /* false: the filter decides its candidates */
};

/* Geometries cover the triangles of the scene in order, each once; at least one, which may be
 * empty. */
struct world_mesh {
    struct scene *scene;
    struct geometry *geometry;
    uint32_t geometry_count;
};

#define WORLD_NO_MESH 0xFFFFFFFFu

/* A placed mesh. It is inactive, and no ray meets it, if mesh is WORLD_NO_MESH or mask is 0; it
 * keeps its index. */
struct instance {
    float m[3][4];   /* M and, in the last column, T: p is placed at M p + T. det M is not 0 */
    uint32_t mesh;   /* index, or WORLD_NO_MESH */
    uint32_t custom; /* at most ABI_CUSTOM_MOST; need not differ from others' */
    uint32_t mask;   /* 8 bits; a ray meets the instance if its own mask has a bit in common */
    uint32_t flags;  /* ABI_INSTANCE_*; not both FORCE_OPAQUE and FORCE_NO_OPAQUE */
};

/* Which candidates that are not opaque count as hits: a function of the triangle and of the cell of
 * a coarse grid over u and v that the hit lies in. */
enum filter_kind {
    FILTER_ALL = ABI_FILTER_ALL,             /* every candidate */
    FILTER_NONE = ABI_FILTER_NONE,           /* none */
    FILTER_TRIANGLES = ABI_FILTER_TRIANGLES, /* chosen by a hash of instance, geometry, triangle */
    FILTER_CELLS = ABI_FILTER_CELLS, /* the same with the cell: ABI_FILTER_GRID cells along u and
                                        along v */
};

struct filter_rule {
    enum filter_kind kind;
    uint32_t seed;  /* of the hash */
    uint32_t share; /* about so many of 256 pass, 0 to 256 */
};

/* Owns its arrays and, unless `borrows`, the scenes (see world_free). A world made by a reader has
 * passed world_finish. */
struct world {
    struct world_mesh *mesh;
    struct instance *instance;
    uint32_t *first; /* instance_count + 1 numbers of placed triangles; made by world_finish */
    uint32_t mesh_count, instance_count;
    struct filter_rule filter;
    bool borrows; /* the scenes of its meshes are somebody else's */
};

/* Where a placed triangle is. */
struct place {
    uint32_t instance;
    uint32_t mesh;
    uint32_t prim;     /* triangle of the mesh's scene */
    uint32_t geometry; /* of the mesh */
    uint32_t tri;      /* triangle of the geometry */
};

/* Makes the world of one opaque mesh, `scene`, which is borrowed, in one instance at the identity,
 * mask 0xFF. Errors: STATUS_MEMORY. */
enum status world_of_scene(const struct scene *scene, struct world *out,
                           struct reason *reason) MUST_USE;

/* Frees what the world owns and zeroes it. A zero world is allowed. */
void world_free(struct world *world);

/* Checks every rule above and numbers the placed triangles. Errors: STATUS_INPUT with mesh or
 * instance and rule: a scene that scene_check refuses; geometries that do not cover their mesh; an
 * instance of a mesh that does not exist; a transform that is not finite, or whose determinant is
 * exactly 0; a custom index, a mask or flags out of range; both force flags; a filter of no known
 * kind. STATUS_LIMIT more than 2^32 - 2 placed triangles. STATUS_MEMORY. A world without instances,
 * or without triangles, passes. */
enum status world_finish(struct world *world, struct reason *reason) MUST_USE;

/* Checks the rules of instance `at` alone, whose mesh must be among those that the world has.
 * Errors: those of world_finish for an instance. */
enum status world_check_instance(const struct world *world, uint32_t at,
                                 struct reason *reason) MUST_USE;

/* Number of placed triangles. */
static inline uint32_t world_tri_count(const struct world *world)
{
    return world->instance_count ? world->first[world->instance_count] : 0;
}

/* Where placed triangle `prim` is, which is below world_tri_count. */
struct place world_place(const struct world *world, uint32_t prim);

/* The same of triangle `prim` of the mesh of an instance, which has that triangle. */
struct place world_place_in(const struct world *world, uint32_t instance, uint32_t prim);

/* The instance that placed triangle `prim` belongs to. */
uint32_t world_instance_of(const struct world *world, uint32_t prim);

/* The scene of an instance's mesh; NULL if it has none. */
static inline const struct scene *world_scene(const struct world *world, uint32_t instance)
{
    uint32_t mesh = world->instance[instance].mesh;
    return mesh == WORLD_NO_MESH ? NULL : world->mesh[mesh].scene;
}

/* True if the transform is the identity, bit for bit but for the signs of zeros. */
bool instance_is_identity(const struct instance *instance);

/* Sign of det M, exactly: -1, 0, 1. The nine numbers are finite. */
int instance_det_sign(const float m[3][4]);

/* --- what a ray may meet ---------------------------------------------------------------------- */

/* Every instance and triangle: what a ray of a scene has. */
static inline struct ray_mode ray_mode_all(void)
{
    return (struct ray_mode){0xFF, 0};
}

/* Checks a ray's mask and flags. Errors: STATUS_INPUT: a mask over 8 bits; unknown flags; more than
 * one of OPAQUE, NO_OPAQUE, CULL_OPAQUE, CULL_NO_OPAQUE; more than one of SKIP_TRIANGLES,
 * CULL_BACK, CULL_FRONT. */
enum status ray_mode_check(struct ray_mode mode, struct reason *reason) MUST_USE;

/* True if the ray may meet the instance at all. */
static inline bool world_meets(const struct instance *instance, struct ray_mode mode)
{
    return instance->mesh != WORLD_NO_MESH && (instance->mask & mode.mask) != 0 &&
           !(mode.flags & ABI_RAY_SKIP_TRIANGLES);
}

/* Whether a candidate counts as opaque: the geometry's own flag, overridden by the instance's,
 * overridden by the ray's. */
bool world_is_opaque(const struct instance *instance, bool geometry_opaque, struct ray_mode mode);

/* True if the front of a triangle is seen, given the sign of d . ((v1 - v0) x (v2 - v0)) in the
 * space of the mesh: front if it is negative (vertices run counterclockwise, seen from the ray's
 * origin, where the axes are right-handed), the other side with FLIP_FACING. A mirror in the
 * transform changes nothing. The sign is not 0. */
static inline bool world_is_front(const struct instance *instance, int object_sign)
{
    return (object_sign < 0) != ((instance->flags & ABI_INSTANCE_FLIP_FACING) != 0);
}

/* True if the ray's flags cull a candidate of that opacity and facing. */
bool world_culls(const struct instance *instance, bool opaque, bool front, struct ray_mode mode);

/* Whether a candidate that is not opaque counts. u and v are in [0, 1], or count as such. */
bool filter_passes(const struct filter_rule *filter, const struct place *place, float u, float v);

/* Whether the answer depends on u and v. */
static inline bool filter_reads_uv(const struct filter_rule *filter)
{
    return filter->kind == FILTER_CELLS;
}

#endif
