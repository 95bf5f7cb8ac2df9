/* raydiff scene convert. */
#include "cmd/scene/cmd_scene.h"

#include "cmd/common/cmd_options.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/scene/quantise.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool ends_in(const char *path, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

/* A scene is written as RTRS's JSON unless the name asks for a world's. */
static bool is_rtrs(const char *path, const struct world *world)
{
    return world_is_plain(world) && ends_in(path, ".json") && !ends_in(path, ".world.json");
}

static void tell_scene(const char *path, const struct world *world)
{
    const struct scene *scene = world_only_scene(world);
    bool more = scene->normal || scene->light_count || scene->material_count || scene->has_camera;
    printf("%s: %s, %s\n", path, COUNTED(scene->tri_count, "triangle"),
           COUNTED(scene->vertex_count, "vertex"));
    if (more && !is_rtrs(path, world))
        printf("not kept, since the format has no place for them: normals, lights, materials, "
               "camera\n");
}

static void tell_world(const char *path, const struct world *world)
{
    char shown[WORLD_SHOWN];
    printf("%s: %s\n", path, world_show(world, shown));
}

static void tell_left_out(const struct world_notes *notes)
{
    if (notes->points_and_lines)
        printf("left out: %u primitive%s of points or lines\n", notes->points_and_lines,
               plural(notes->points_and_lines));
    if (notes->skins || notes->morphs)
        printf("left out: %u skin%s, %u primitive%s with morph targets; they are placed at rest\n",
               notes->skins, plural(notes->skins), notes->morphs, plural(notes->morphs));
}

/* Replaces a scene by its copy on a grid. */
static enum status move_to_grid(struct world *world, const char *from, uint32_t bits,
                                struct quantised *moved, struct reason *reason)
{
    struct reason why = {""};
    struct scene out;
    if (!world_is_plain(world))
        return fail(reason, STATUS_INPUT,
                    "%s: --bits moves the vertices of a scene, this is a world", from);
    struct scene *scene = world->mesh[0].scene;
    enum status status = scene_quantise(scene, bits, &out, moved, &why);
    if (status)
        return fail(reason, status, "%s: %.150s", from, why.text);
    scene_free(scene);
    *scene = out;
    return STATUS_OK;
}

static void tell_moved(const struct quantised *moved)
{
    printf(
        "on a grid of %u bits an axis: vertices moved by %s at most, certified; %s without area\n",
        moved->grid.bits, BOUND(moved->distance), COUNTED(moved->flat, "triangle"));
}

int scene_convert(const struct scene_options *options)
{
    if (options->argument_count != 2)
        return usage_error("scene", "convert: one scene and one file are needed");
    const char *from = options->argument[0], *to = options->argument[1];
    struct world world;
    struct world_notes notes;
    struct quantised moved;
    struct reason reason;
    enum status status = world_open_noted(from, options->seed, &world, &notes, &reason);
    if (!status && options->bits)
        status = move_to_grid(&world, from, options->bits, &moved, &reason);
    if (!status && is_rtrs(to, &world))
        status = scene_write(to, world_only_scene(&world), &reason);
    else if (!status)
        status = world_write(to, &world, &reason);
    if (!status && world_is_plain(&world))
        tell_scene(to, &world);
    else if (!status)
        tell_world(to, &world);
    if (!status && options->bits)
        tell_moved(&moved);
    if (!status)
        tell_left_out(&notes);
    world_free(&world);
    return exit_with_reason("scene", status, &reason);
}
