/* Makes one scene of several meshes, as RTRS's `construct` does. */
#ifndef CONSTRUCT_H
#define CONSTRUCT_H

#include "scenes/transform.h"
#include "ref/scene/scene.h"

#define CONSTRUCT_DEFAULT UINT32_MAX /* a model's material: the default red */

/* A mesh and its transform. The mesh's own materials, normals, lights and camera are dropped. */
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
    uint64_t seed;     /* for generators whose spec has no seed */
    bool fill_normals; /* see construct_scene */
    /* Called before each model is read. May be NULL. */
    void (*step)(void *user, const char *spec);
    void *user;
};

/* Facts about the result to report to the user. */
struct construct_notes {
    uint32_t red;    /* index of the default material, or CONSTRUCT_DEFAULT if it was not added */
    uint32_t unused; /* vertices that no triangle uses */
    uint32_t filled; /* vertices of triangles with undefined normals; 1 on that error */
};

/* Concatenates the models: vertices and triangles keep their order. Normals are computed from the
 * result (scene_normals). Material k is the k-th of `material`. The default red is appended, so
 * that no index moves, and only if a model uses it or there is no material; in that case it is
 * material 0, and a model may also name it 0. Triangles of a mirrored model are reversed (corners 1
 * and 2 are swapped), so that their outside stays outside.
 * Normals that would be NaN in RTRS's files are (0, 1, 0): always for vertices that no triangle
 * uses, for others if fill_normals.
 * Errors, each naming the model: STATUS_INPUT no model, a material out of range, numbers that are
 * not finite, a camera whose target is its position, errors of scene_open, transformed vertices
 * outside the range of a float, a vertex of a triangle without normal (unless fill_normals);
 * STATUS_LIMIT more than 2^32 - 2 vertices or triangles; STATUS_MEMORY. On error *out is zero.
 * Source: RTRS's scene/mod.rs and bin/construct.rs; its indices are off by one. */
enum status construct_scene(const struct construct *from, struct scene *out,
                            struct construct_notes *notes, struct reason *reason) MUST_USE;

#endif
