/* Worlds by name: generators, and files of all formats. */
#ifndef WORLDS_H
#define WORLDS_H

#include "ref/world/world.h"
#include "scenes/read/world_formats.h"
#include "scenes/scenes.h"

struct placer; /* scenes/worlds/placer.h */

/* A generator of worlds, run by world_generator_make. The names of scenes' generators are not
 * among them. */
struct world_generator {
    const char *name;
    const char *summary;
    struct param param[GENERATOR_PARAMS]; /* ends at the first entry without a name */
    /* Draws the world. `value` has one checked entry per param. */
    enum status (*make)(struct placer *placer, const double *value, struct reason *reason);
    bool seedless; /* the world does not depend on the seed */
    bool undrawn;  /* made for one measurement: campaigns do not draw it */
};

/* NULL-terminated. */
extern const struct world_generator *const world_generators[];

const struct world_generator *world_generator_find(const char *name); /* or NULL */

/* Makes a world from one value per param, in order. The same arguments give the same bytes on every
 * machine. It has passed world_finish. Errors: as of generator_make. */
enum status world_generator_make(const struct world_generator *generator, const double *value,
                                 uint64_t seed, struct world *out, struct reason *reason) MUST_USE;

/* Makes or reads a world from a user's text:
 *   "crowd:n=100"                     a generator of worlds, with parameters
 *   "path/to/file.gltf"               a file of a world: .gltf, .glb, or .json with the member
 *                                     "raydiff_world"; each also .gz
 *   any text that scene_open takes    a world of one opaque mesh in one instance at the identity
 * Files that a world file names are in its folder or below; a generator there has the seed 1 if its
 * text gives none, so that files do not depend on `seed`. A world may be empty.
 * Errors: STATUS_INPUT one line with file, place and rule, also for world files that name each
 * other in a circle; STATUS_MEMORY. */
enum status world_open(const char *spec, uint64_t seed, struct world *out,
                       struct reason *reason) MUST_USE;

/* The same; *notes is what the file has and the world does not. */
enum status world_open_noted(const char *spec, uint64_t seed, struct world *out,
                             struct world_notes *notes, struct reason *reason) MUST_USE;

/* The scene of a world that is one mesh in one instance at the identity which every ray meets as a
 * scene's: its mask is not 0, and each candidate counts. Else NULL. */
const struct scene *world_only_scene(const struct world *world);

/* True if nothing is lost by taking world_only_scene: one mesh of one opaque geometry, mask 0xFF,
 * custom index 0, no flags, the filter that passes all. */
bool world_is_plain(const struct world *world);

/* Writes a world by the ending of the file: world .json, .gltf (its buffer in a data: URI), .glb;
 * or .stl, .obj, .ply: the triangles of world_only_scene. As scene_write, whole or not at all.
 * Errors: STATUS_INPUT unknown ending, what the format cannot hold, cannot write; STATUS_MEMORY. */
enum status world_write(const char *path, const struct world *world,
                        struct reason *reason) MUST_USE;

/* "2 meshes, 3 instances, 24 placed triangles". */
#define WORLD_SHOWN 100
const char *world_show(const struct world *world, char text[WORLD_SHOWN]);

#endif
