#define _POSIX_C_SOURCE 200809L /* strncasecmp */
#include "ref/files/file.h"
#include "scenes/worlds.h"

#include <string.h>
#include <strings.h>

static const struct {
    const char *ending;
    enum status (*write)(const struct world *world, FILE *stream, struct reason *reason);
} formats[] = {
    {".json", write_world}, {".gltf", write_gltf}, {".glb", write_glb},
    {".obj", NULL},         {".ply", NULL},        {".stl", NULL}, /* NULL: of a scene */
};

static enum status write_scene(const char *path, const struct world *world, struct reason *reason)
{
    char shown[WORLD_SHOWN];
    const struct scene *scene = world_only_scene(world);
    if (scene)
        return scene_write(path, scene, reason);
    return fail(reason, STATUS_INPUT,
                "%s: this format holds one mesh in one instance at the identity, not a world of "
                "%s; .json, .gltf and .glb do",
                file_label(path), world_show(world, shown));
}

enum status world_write(const char *path, const struct world *world, struct reason *reason)
{
    size_t length = strlen(path), i = 0;
    for (; i < ARRAY_COUNT(formats); i++) {
        size_t tail = strlen(formats[i].ending);
        if (length > tail && strcasecmp(path + length - tail, formats[i].ending) == 0)
            break;
    }
    if (i == ARRAY_COUNT(formats))
        return fail(reason, STATUS_INPUT,
                    "%s: unknown ending; worlds are written as .json (of raydiff), .gltf or .glb, "
                    "scenes also as .obj, .ply or .stl",
                    file_label(path));
    if (!formats[i].write)
        return write_scene(path, world, reason);
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    struct reason why = {""};
    if (status)
        return status;
    status = formats[i].write(world, out.stream, &why);
    if (!status)
        return file_out_commit(&out, reason);
    file_out_discard(&out);
    return fail(reason, status, "%s: %s", file_label(path), why.text);
}
