#define _POSIX_C_SOURCE 200809L /* stat */
#include "ref/files/file.h"
#include "scenes/opening.h"
#include "scenes/spec.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* --- generators ------------------------------------------------------------------------------- */

enum status world_generate(const char *spec, uint64_t seed, bool *found, struct world *out,
                           struct reason *reason)
{
    const struct world_generator *generator = NULL;
    for (size_t i = 0; world_generators[i] && !generator; i++)
        generator = spec_names(spec, world_generators[i]->name) ? world_generators[i] : NULL;
    *out = (struct world){0};
    *found = generator != NULL;
    if (!generator)
        return STATUS_OK;
    const struct spec_maker maker = {generator->name, generator->param};
    double value[GENERATOR_PARAMS];
    enum status status = spec_values(&maker, spec, value, &seed, reason);
    return status ? status : world_generator_make(generator, value, seed, out, reason);
}

/* --- files that a file names ------------------------------------------------------------------ */

/* What a world file is opened with. */
struct beside {
    const char *path;
    struct world_file self;
};

/* True if the path leads to the folder itself or below it. */
static bool stays_below(const char *path)
{
    if (*path == '/' || *path == '\0')
        return false;
    for (const char *at = path; *at;) {
        size_t length = strcspn(at, "/");
        if (length == 2 && memcmp(at, "..", 2) == 0)
            return false;
        at += length + (at[length] == '/');
    }
    return true;
}

/* The path of a file that another names, which the caller frees. */
static enum status join(const char *of, const char *path, char **out, struct reason *reason)
{
    const char *slash = strrchr(of, '/');
    size_t folder = slash ? (size_t)(slash - of) + 1 : 0;
    *out = NULL;
    if (!stays_below(path))
        return fail(reason, STATUS_INPUT,
                    "'%.80s' is no file in the folder of this one, or below it", path);
    *out = alloc_zeroed(folder + strlen(path) + 3, 1);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory");
    /* "./" keeps a file from being taken for a generator of its name. */
    memcpy(*out, folder ? of : "./", folder ? folder : 2);
    strcat(*out, path);
    return STATUS_OK;
}

static enum status open_scene(void *user, const char *spec, struct scene *out,
                              struct reason *reason)
{
    const struct beside *beside = user;
    bool found;
    char *path;
    enum status status = scene_generate(spec, 1, &found, out, reason);
    if (status || found)
        return status;
    status = join(beside->path, spec, &path, reason);
    if (!status)
        status = scene_open_within(path, 1, &beside->self, out, reason);
    free(path);
    return status;
}

enum status scene_open_beside(const char *path, const char *spec, struct scene *out,
                              struct reason *reason)
{
    struct beside beside = {.path = path};
    return open_scene(&beside, spec, out, reason);
}

static enum status open_bytes(void *user, const char *name, char **bytes, size_t *size,
                              struct reason *reason)
{
    const struct beside *beside = user;
    char *path;
    *bytes = NULL;
    *size = 0;
    enum status status = join(beside->path, name, &path, reason);
    if (!status)
        status = file_read_stored(path, bytes, size, reason);
    free(path);
    return status;
}

enum status opening_world(const char *path, const char *bytes, size_t size,
                          const struct world_file *up, struct world *out, struct world_notes *notes,
                          struct reason *reason)
{
    struct stat about = {0};
    struct beside beside = {.path = path, .self = {.up = up}};
    const struct world_files files = {open_scene, open_bytes, &beside};
    *out = (struct world){0};
    *notes = (struct world_notes){0};
    if (stat(path, &about) != 0)
        return fail(reason, STATUS_INPUT, "%s: is gone", file_label(path));
    beside.self.device = about.st_dev;
    beside.self.file = about.st_ino;
    for (; up; up = up->up)
        if (up->device == about.st_dev && up->file == about.st_ino)
            return fail(reason, STATUS_INPUT, "%s: is being read: these files name each other",
                        file_label(path));
    if (is_world(bytes, size))
        return read_world(file_label(path), bytes, size, &files, out, reason);
    return read_gltf(file_label(path), bytes, size, &files, out, notes, reason);
}

/* --- worlds and scenes ------------------------------------------------------------------------ */

/* Makes the world of a scene, which is moved, also on error. */
static enum status world_own_scene(struct scene *scene, struct world *out, struct reason *reason)
{
    struct scene *moved = alloc_copy(scene, 1, sizeof *scene);
    *out = (struct world){0};
    if (!moved) {
        scene_free(scene);
        return fail(reason, STATUS_MEMORY, "no memory for a world");
    }
    *scene = (struct scene){0};
    enum status status = world_of_scene(moved, out, reason);
    if (!status) {
        out->borrows = false;
        return STATUS_OK;
    }
    scene_free(moved);
    free(moved);
    return status;
}

const struct scene *world_only_scene(const struct world *world)
{
    if (world->instance_count != 1)
        return NULL;
    const struct instance *instance = &world->instance[0];
    if (instance->mesh == WORLD_NO_MESH || instance->mask == 0 || !instance_is_identity(instance))
        return NULL;
    const struct world_mesh *mesh = &world->mesh[instance->mesh];
    for (uint32_t i = 0; i < mesh->geometry_count; i++)
        if (world->filter.kind != FILTER_ALL &&
            !world_is_opaque(instance, mesh->geometry[i].opaque, ray_mode_all()))
            return NULL;
    return mesh->scene;
}

bool world_is_plain(const struct world *world)
{
    if (!world_only_scene(world))
        return false;
    const struct instance *instance = &world->instance[0];
    const struct world_mesh *mesh = &world->mesh[0];
    const struct filter_rule *filter = &world->filter;
    return world->mesh_count == 1 && mesh->geometry_count == 1 && mesh->geometry[0].opaque &&
           instance->mask == 0xFF && instance->custom == 0 && instance->flags == 0 &&
           filter->kind == FILTER_ALL && filter->seed == 0 && filter->share == 0;
}

const char *world_show(const struct world *world, char text[WORLD_SHOWN])
{
    snprintf(text, WORLD_SHOWN, "%s, %s, %s", COUNTED(world->mesh_count, "mesh"),
             COUNTED(world->instance_count, "instance"),
             COUNTED(world_tri_count(world), "placed triangle"));
    return text;
}

enum status world_take_scene(const char *name, struct world *world, struct scene *out,
                             struct reason *reason)
{
    char shown[WORLD_SHOWN];
    *out = (struct scene){0};
    const struct scene *only = world_only_scene(world);
    enum status status = STATUS_OK;
    if (!only) {
        status = fail(reason, STATUS_INPUT,
                      "%.120s: is a world of %s; this command takes a scene: one mesh in one "
                      "instance at the identity",
                      name, world_show(world, shown));
    } else if (only->tri_count == 0) {
        status = fail(reason, STATUS_INPUT, "%.120s: has no triangle", name);
    } else {
        struct scene *own = world->mesh[world->instance[0].mesh].scene;
        *out = *own;
        *own = (struct scene){0};
    }
    world_free(world);
    return status;
}

enum status world_open_noted(const char *spec, uint64_t seed, struct world *out,
                             struct world_notes *notes, struct reason *reason)
{
    bool found;
    struct scene scene;
    *out = (struct world){0};
    *notes = (struct world_notes){0};
    enum status status = scene_generate(spec, seed, &found, &scene, reason);
    if (!status && found)
        return world_own_scene(&scene, out, reason);
    if (!status)
        status = world_generate(spec, seed, &found, out, reason);
    if (status || found)
        return status;
    scene_read_fn *read;
    char *bytes;
    size_t size;
    status = opening_read(spec, &read, &bytes, &size, reason);
    if (!status && read && !(status = read(file_label(spec), bytes, size, &scene, reason)))
        status = world_own_scene(&scene, out, reason);
    else if (!status && !read)
        status = opening_world(spec, bytes, size, NULL, out, notes, reason);
    free(bytes);
    return status;
}

enum status world_open(const char *spec, uint64_t seed, struct world *out, struct reason *reason)
{
    struct world_notes notes;
    return world_open_noted(spec, seed, out, &notes, reason);
}
