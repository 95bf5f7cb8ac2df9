/* Shared by scene_open and world_open: files that name files. */
#ifndef OPENING_H
#define OPENING_H

#include "scenes/worlds.h"

#include <sys/types.h>

/* A world file that is being read, and the one that names it. */
struct world_file {
    dev_t device;
    ino_t file;
    const struct world_file *up; /* or NULL */
};

/* As scene_open, from within the file `up`. */
enum status scene_open_within(const char *spec, uint64_t seed, const struct world_file *up,
                              struct scene *out, struct reason *reason) MUST_USE;

/* Reads a file that scene_open or world_open takes. *read is its reader if it is a scene's, else
 * NULL: a world's. The caller frees *bytes. Errors: STATUS_INPUT an unknown ending, or no
 * file; as file_read. */
typedef enum status scene_read_fn(const char *name, const char *bytes, size_t size,
                                  struct scene *out, struct reason *reason);
enum status opening_read(const char *path, scene_read_fn **read, char **bytes, size_t *size,
                         struct reason *reason) MUST_USE;

/* Reads the bytes of a world file. Errors: as of world_open. */
enum status opening_world(const char *path, const char *bytes, size_t size,
                          const struct world_file *up, struct world *out, struct world_notes *notes,
                          struct reason *reason) MUST_USE;

/* Moves the scene of world_only_scene out of a world, which is freed, also on error. Errors:
 * STATUS_INPUT "NAME: is a world of ..., and a scene is needed". */
enum status world_take_scene(const char *name, struct world *world, struct scene *out,
                             struct reason *reason) MUST_USE;

/* Runs the generator of scenes, or of worlds, that a text names; *found is false, and nothing
 * happens, if it names none. Errors: as of generator_make, and of scene_check. */
enum status scene_generate(const char *spec, uint64_t seed, bool *found, struct scene *out,
                           struct reason *reason) MUST_USE;
enum status world_generate(const char *spec, uint64_t seed, bool *found, struct world *out,
                           struct reason *reason) MUST_USE;

/* Opens a scene that the file `path` names: a generator, or a file in the folder of that one or
 * below it. Errors: STATUS_INPUT a path that leads elsewhere; as scene_open. */
enum status scene_open_beside(const char *path, const char *spec, struct scene *out,
                              struct reason *reason) MUST_USE;

#endif
