/* What raydiff check is run on: a scene or a world, opened, and rays into it. */
#include "cmd/check/cmd_check.h"

#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/store.h"
#include "ref/world/world_boxes.h"
#include "scenes/move.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

/* Moves the scene out of a plain world; it may have no triangle, which is vacuous. */
static void take_scene(struct world *world, struct scene *out)
{
    struct scene *own = world->mesh[0].scene;
    *out = *own;
    *own = (struct scene){0};
    world_free(world);
}

enum status check_open_either(const char *spec, uint64_t seed, struct check_subject *out,
                              struct reason *reason)
{
    enum status status = world_open(spec, seed, &out->world, reason);
    if (status)
        return status;
    out->is_world = !world_is_plain(&out->world);
    if (!out->is_world)
        take_scene(&out->world, &out->scene);
    return STATUS_OK;
}

static enum status move_scene(const struct check_options *o, const char *spec,
                              struct check_subject *out, struct reason *reason)
{
    if (out->is_world || !(o->move > 0))
        return STATUS_OK;
    scene_move(&out->scene, o->move, o->seed);
    return scene_open(spec, o->seed, &out->rest, reason);
}

static enum status live_as_scene(const struct check_options *o, const char *spec, uint32_t steps,
                                 struct check_subject *out, struct reason *reason)
{
    struct reason why = {""};
    enum status status = steps_of_scene(o->step, o->step_count, &why);
    if (status)
        return fail(reason, status, "--steps: %s: %s (docs/worlds.md)", spec, why.text);
    status = steps_scenes(&out->scene, o->step, steps, out->past, reason);
    if (status)
        return status;
    memcpy(out->scene.vertex, out->past[steps].vertex,
           3 * sizeof *out->scene.vertex * (size_t)out->scene.vertex_count);
    out->life.scene = out->past;
    return STATUS_OK;
}

/* The world itself has then moved, too: vertices and instances are copied to where they are. */
static enum status live_as_world(const struct check_options *o, uint32_t steps,
                                 struct check_subject *out, struct reason *reason)
{
    struct world *world = &out->world;
    enum status status = steps_worlds(world, o->step, steps, out->before, reason);
    if (status)
        return status;
    const struct world *last = &out->before[steps];
    for (uint32_t i = 0; i < world->mesh_count; i++)
        if (last->mesh[i].scene->vertex_count > 0)
            memcpy(world->mesh[i].scene->vertex, last->mesh[i].scene->vertex,
                   12 * (size_t)last->mesh[i].scene->vertex_count);
    if (world->instance_count > 0)
        memcpy(world->instance, last->instance, world->instance_count * sizeof *last->instance);
    memcpy(world->first, last->first, (world->instance_count + (size_t)1) * sizeof *last->first);
    out->life.world = out->before;
    return STATUS_OK;
}

/* Takes the scene or the world through the steps. */
static enum status live(const struct check_options *o, const char *spec, uint32_t steps,
                        struct check_subject *out, struct reason *reason)
{
    if (o->step_count == 0)
        return STATUS_OK;
    out->life.count = steps;
    enum status status = out->is_world ? live_as_world(o, steps, out, reason)
                                       : live_as_scene(o, spec, steps, out, reason);
    out->lives = status == STATUS_OK;
    for (uint32_t i = 0; i < steps; i++)
        out->life.act[i] = o->step[i].act;
    return status;
}

static enum status check_use_of(const struct check_options *o, const char *spec, bool is_world,
                                struct reason *reason)
{
    if (!is_world && o->modes_named)
        return fail(reason, STATUS_INPUT,
                    "--modes: %s is a scene; only worlds have masks and flags (docs/worlds.md)",
                    spec);
    if (!is_world && option_was_given("braid"))
        return fail(reason, STATUS_INPUT,
                    "--braid: %s is a scene; only worlds have instances (docs/worlds.md)", spec);
    if (is_world && o->move > 0)
        return fail(reason, STATUS_INPUT, "--move: %s is a world; only scenes are moved", spec);
    if (is_world && o->bvh)
        return fail(reason, STATUS_INPUT, "--bvh: %s is a world; a tree file is of a scene", spec);
    for (size_t i = 0; i < o->store.count && is_world; i++)
        if (tri_stores[o->store.index[i]]->lossy)
            return fail(reason, STATUS_INPUT, "--store %s: %s is a world; only scenes are decoded",
                        tri_stores[o->store.index[i]]->name, spec);
    return STATUS_OK;
}

static enum status aim(const struct check_options *o, struct check_scene *result,
                       struct check_subject *out, struct reason *reason)
{
    struct reason why = {""};
    enum status status = world_rays_new(&out->world, ray_sets[o->rays], (enum ray_modes)o->modes,
                                        o->seed, result->ray_count, &out->ray, &out->mode, &why);
    return status ? fail(reason, status, "%s: %s", result->spec, why.text) : STATUS_OK;
}

/* Vertices of all instances, or the most that the member holds. */
static uint32_t placed_vertices(const struct world *world)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        count += world_scene(world, i) ? world_scene(world, i)->vertex_count : 0;
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

/* False if no ray can hit anything. */
static bool is_active(const struct world *world)
{
    bool active = false;
    for (uint32_t i = 0; i < world->instance_count && !active; i++)
        active = world_is_active(world, i);
    return active;
}

void check_describe(const struct world *world, struct check_scene *result)
{
    result->tri_count = world_tri_count(world);
    result->vertex_count = placed_vertices(world);
    result->instance_count = world->instance_count;
    result->vacuous = !is_active(world);
}

static void note_engines(const struct check_options *o, struct check_scene *result)
{
    for (size_t e = 0; e < o->engine.count; e++) {
        const struct engine *engine = engines[o->engine.index[e]];
        if (!engine->worlds)
            text_append(result->scenes_only, sizeof result->scenes_only, "%s%s",
                        result->scenes_only[0] ? ", " : "", engine->name);
    }
}

enum status check_open(const struct check_options *options, const char *spec,
                       struct check_scene *result, struct check_subject *out, struct reason *reason)
{
    *out = (struct check_subject){0};
    enum status status = check_open_either(spec, options->seed, out, reason);
    if (status == STATUS_OK)
        status = move_scene(options, spec, out, reason);
    if (status == STATUS_OK)
        status = check_use_of(options, spec, out->is_world, reason);
    if (status == STATUS_OK)
        status = live(options, spec, result->step, out, reason);
    if (status)
        return status;
    if (!out->is_world) {
        result->tri_count = out->scene.tri_count;
        result->vertex_count = out->scene.vertex_count;
        return ray_set_new(ray_sets[options->rays], &out->scene, options->seed, result->ray_count,
                           &out->ray, reason);
    }
    check_describe(&out->world, result);
    result->modes = ray_modes_name((enum ray_modes)options->modes);
    note_engines(options, result);
    return result->vacuous ? STATUS_OK : aim(options, result, out, reason);
}

void check_close(struct check_subject *subject)
{
    if (subject->life.scene)
        steps_free(subject->past, subject->life.count);
    if (subject->life.world)
        steps_worlds_free(subject->before, subject->life.count);
    scene_free(&subject->scene);
    scene_free(&subject->rest);
    world_free(&subject->world);
    free(subject->ray);
    free(subject->mode);
}
