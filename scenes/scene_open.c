#define _POSIX_C_SOURCE 200809L /* strcasecmp, stat */
#include "ref/base/nearest_name.h"
#include "ref/base/text.h"
#include "ref/files/file.h"
#include "scenes/opening.h"
#include "scenes/read/formats.h"
#include "scenes/spec.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const struct format {
    const char *ending;
    scene_read_fn *read; /* NULL: of worlds alone */
    enum status (*write)(const struct scene *scene, FILE *stream, struct reason *reason);
} formats[] = {
    {".json", read_rtrs, write_rtrs}, {".obj", read_obj, write_obj}, {".ply", read_ply, write_ply},
    {".stl", read_stl, write_stl},    {".gltf", NULL, NULL},         {".glb", NULL, NULL},
};

/* Whether `path` without its last `cut` bytes ends in `ending` (case ignored) after at least one
 * character. */
static bool ends_in(const char *path, size_t cut, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending) + cut;
    return length > tail && strncasecmp(path + length - tail, ending, strlen(ending)) == 0;
}

/* The format of a file name, by its ending; `zipped`: ".gz" may follow it. NULL if none. */
static const struct format *find_format(const char *path, bool zipped)
{
    size_t cut = zipped && ends_in(path, 0, ".gz") ? 3 : 0;
    for (size_t i = 0; i < ARRAY_COUNT(formats); i++)
        if (ends_in(path, cut, formats[i].ending))
            return &formats[i];
    return NULL;
}

/* A text that names neither a generator nor a file. */
static enum status unknown_scene(const char *spec, struct reason *reason)
{
    char known[240] = "", hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(spec, strcspn(spec, ":"));
    for (size_t i = 0; generators[i]; i++) {
        text_append(known, sizeof known, "%s%s", i ? ", " : "", generators[i]->name);
        nearest_try(&nearest, generators[i]->name);
    }
    for (size_t i = 0; world_generators[i]; i++)
        nearest_try(&nearest, world_generators[i]->name);
    return fail(
        reason, STATUS_INPUT,
        "unknown scene '%.80s': no file, and no generator; those are %s (of worlds: raydiff "
        "scene list)%s",
        spec, known, nearest_hint(&nearest, hint));
}

enum status opening_read(const char *path, scene_read_fn **read, char **bytes, size_t *size,
                         struct reason *reason)
{
    *read = NULL;
    *bytes = NULL;
    *size = 0;
    const struct format *format = find_format(path, true);
    struct stat about;
    if (!format && stat(path, &about) != 0)
        return unknown_scene(path, reason);
    if (!format && S_ISDIR(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: is a directory", file_label(path));
    if (!format)
        return fail(reason, STATUS_INPUT,
                    "%s: unknown ending; scenes are .json (RTRS), .obj, .ply or .stl, worlds .json "
                    "(of raydiff), .gltf or .glb, each also .gz",
                    file_label(path));
    enum status status = file_read(path, bytes, size, reason);
    if (status && reason && strstr(path, "scenes/fetched/") && stat(path, &about) != 0)
        text_append(reason->text, sizeof reason->text, "; make scenes fetches the meshes there");
    if (!status && !(format->read == read_rtrs && is_world(*bytes, *size)))
        *read = format->read;
    return status;
}

static enum status read_within(const char *path, const struct world_file *up, struct scene *out,
                               struct reason *reason)
{
    scene_read_fn *read;
    struct world world;
    struct world_notes notes;
    char *bytes;
    size_t size;
    *out = (struct scene){0};
    enum status status = opening_read(path, &read, &bytes, &size, reason);
    if (!status && read)
        status = read(file_label(path), bytes, size, out, reason);
    else if (!status && !(status = opening_world(path, bytes, size, up, &world, &notes, reason)))
        status = world_take_scene(file_label(path), &world, out, reason);
    free(bytes);
    return status;
}

enum status scene_read(const char *path, struct scene *out, struct reason *reason)
{
    return read_within(path, NULL, out, reason);
}

enum status scene_write(const char *path, const struct scene *scene, struct reason *reason)
{
    const struct format *format = find_format(path, false);
    if (!format || !format->write)
        return fail(reason, STATUS_INPUT,
                    "%s: unknown ending; scenes are written as .json (RTRS), .obj, .ply or .stl",
                    file_label(path));
    enum status status = scene_check(scene, reason);
    if (status)
        return status;
    struct file_out out;
    status = file_out_open(path, &out, reason);
    if (!status)
        status = format->write(scene, out.stream, reason);
    if (!status)
        return file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

enum status scene_generate(const char *spec, uint64_t seed, bool *found, struct scene *out,
                           struct reason *reason)
{
    const struct generator *generator = NULL;
    for (size_t i = 0; generators[i] && !generator; i++)
        generator = spec_names(spec, generators[i]->name) ? generators[i] : NULL;
    *out = (struct scene){0};
    *found = generator != NULL;
    if (!generator)
        return STATUS_OK;
    const struct spec_maker maker = {generator->name, generator->param};
    double value[GENERATOR_PARAMS];
    enum status status = spec_values(&maker, spec, value, &seed, reason);
    if (!status)
        status = generator_make(generator, value, seed, out, reason);
    if (status)
        return status;
    struct reason rule;
    status = scene_check(out, &rule);
    if (status) {
        scene_free(out);
        return fail(reason, status, "%s: %s", generator->name, rule.text);
    }
    return STATUS_OK;
}

enum status scene_open_within(const char *spec, uint64_t seed, const struct world_file *up,
                              struct scene *out, struct reason *reason)
{
    bool found;
    struct world world;
    enum status status = scene_generate(spec, seed, &found, out, reason);
    if (status || found)
        return status;
    status = world_generate(spec, seed, &found, &world, reason);
    if (!status && found)
        return world_take_scene(spec, &world, out, reason);
    return status ? status : read_within(spec, up, out, reason);
}

enum status scene_open(const char *spec, uint64_t seed, struct scene *out, struct reason *reason)
{
    return scene_open_within(spec, seed, NULL, out, reason);
}
