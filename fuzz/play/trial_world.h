/* The world of a trial: which of its triangles make which mesh, and how the meshes are placed. The
 * vertices and triangles of all meshes are the trial's scene, mesh after mesh, so that what edits,
 * shrinks or sends a scene does the same with those of a world. */
#ifndef FUZZ_TRIAL_WORLD_H
#define FUZZ_TRIAL_WORLD_H

#include "ref/world/world.h"

#define FUZZ_GEOMETRIES_MOST 64u
#define FUZZ_INSTANCES_MOST  4096u
#define FUZZ_PLACED_MOST     1048576u /* placed triangles */

/* The next `count` triangles of the scene, of that mesh. Geometries of a mesh follow each other;
 * meshes are numbered from 0 without gaps. */
struct trial_geometry {
    uint32_t mesh, count;
    bool opaque;
};

/* Owns its arrays. Zero for a trial of a scene. */
struct trial_world {
    bool is; /* the trial is of a world */
    struct trial_geometry *geometry;
    struct instance *instance;
    struct ray_mode *mode; /* one per ray of the trial */
    uint32_t geometry_count, instance_count;
    struct filter_rule filter;
};

/* A world of one mesh that is all of a scene of `triangles`, opaque, with `instances` of it at the
 * identity, mask 0xFF; rays meet all of it. Errors: STATUS_LIMIT over the most; STATUS_MEMORY. *out
 * is zero on error. */
enum status trial_world_make(uint32_t triangles, uint32_t geometries, uint32_t instances,
                             uint32_t rays, struct trial_world *out,
                             struct reason *reason) MUST_USE;

/* A deep copy. Errors: STATUS_MEMORY. */
enum status trial_world_copy(const struct trial_world *world, uint32_t rays,
                             struct trial_world *out, struct reason *reason) MUST_USE;

void trial_world_free(struct trial_world *world); /* a zero one is fine */

/* Number of meshes. */
static inline uint32_t trial_world_meshes(const struct trial_world *world)
{
    return world->geometry_count ? world->geometry[world->geometry_count - 1].mesh + 1 : 0;
}

/* The first triangle of a mesh in the scene, and how many it has. */
void trial_world_mesh(const struct trial_world *world, uint32_t mesh, uint32_t *first,
                      uint32_t *count);

/* Rejects geometries out of order, or that do not cover `scene`; what world_finish and
 * ray_mode_check refuse; more than the most. Errors: STATUS_INPUT, STATUS_LIMIT, STATUS_MEMORY. */
enum status trial_world_check(const struct trial_world *world, const struct scene *scene,
                              uint32_t rays, struct reason *reason) MUST_USE;

/* Goes on with a hash (FNV-1a) over all of the world. */
uint64_t trial_world_hash(const struct trial_world *world, uint32_t rays, uint64_t hash);

/* How far a transform is from the identity: 0 the identity, 1 translated, 2 scaled by powers of two
 * along axes, 3 scaled along axes, 4 else. */
uint32_t trial_world_place(const struct instance *instance);

/* The same summed up over all instances. */
uint32_t trial_world_places(const struct trial_world *world);

/* How much there is to read of the rest: 0 of a scene, 1 of each geometry, else 0 for what
 * trial_world_make sets. */
uint64_t trial_world_weight(const struct trial_world *world, uint32_t rays);

/* A world as engines take it. Owns what it made. */
struct trial_meshes {
    struct world world; /* its scenes are `scene` */
    struct scene *scene;
};

/* Makes the world of a trial's world and scene, both borrowed: each mesh has the vertices that its
 * triangles name, in the scene's order. It has passed world_finish. Errors: those of world_finish;
 * STATUS_MEMORY. *out is zero on error. */
enum status trial_meshes_make(const struct trial_world *world, const struct scene *scene,
                              struct trial_meshes *out, struct reason *reason) MUST_USE;

void trial_meshes_free(struct trial_meshes *meshes); /* a zero one is fine */

/* "all", "none", "triangles", "cells"; NULL for another number. */
const char *trial_filter_name(enum filter_kind kind);

#endif
