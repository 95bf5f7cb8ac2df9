/* A scene made of meshes: what RTRS's `construct` does. */
#ifndef CONSTRUCT_H
#define CONSTRUCT_H

#include "scenes/transform.h"
#include "ref/scene/scene.h"

#define CONSTRUCT_DEFAULT UINT32_MAX /* a model's material: the default red */

/* A mesh and where it is put. Its own materials, normals, lights and camera are left behind. */
struct construct_model {
    const char *spec; /* as scene_open takes it: a file or a generator */
    uint32_t material;
    struct transform transform;
    uint32_t vertex_count, tri_count; /* filled in by construct_scene */
};

struct construct {
    struct construct_model *model; /* at least one */
    const struct material *material;
    const struct light *light;
    uint32_t model_count, material_count, light_count;
    struct camera camera;
    uint64_t seed;     /* of generators whose spec has none */
    bool fill_normals; /* see construct_scene */
    /* Called before each model is read; NULL: not called. */
    void (*step)(void *user, const char *spec);
    void *user;
};

/* Facts about the result that a user may want to see. */
struct construct_notes {
    uint32_t red;    /* index of the default material, or CONSTRUCT_DEFAULT if it is not there */
    uint32_t unused; /* vertices of no triangle */
    uint32_t filled; /* vertices of a triangle whose normal is nothing; also if that is the error */
};

/* Puts the models' triangles one after the other, vertices in their order, and makes normals from
 * the result (scene_normals). Material k is the k-th of `material`; the default red comes behind
 * them, so that no index moves, and only if a model asks for it or there is no material: then it is
 * 0, and a model may also say 0. A mirrored model's triangles are turned around (corners 1 and 2
 * change places), so that what was outside stays outside.
 * Normals that would be NaN in RTRS's files are (0, 1, 0): of vertices of no triangle always,
 * of others if fill_normals. Errors, each naming the model: STATUS_INPUT no model, a material out
 * of range, numbers that are not finite, a camera that looks nowhere, what scene_open says,
 * vertices that leave the range of a float, a vertex of a triangle without normal (unless
 * fill_normals); STATUS_LIMIT more than 2^32 - 2 vertices or triangles; STATUS_MEMORY. On error
 * *out is zero. Source: RTRS's scene/mod.rs and bin/construct.rs; its indices are off by one.
 */
enum status construct_scene(const struct construct *from, struct scene *out,
                            struct construct_notes *notes, struct reason *reason) MUST_USE;

#endif
