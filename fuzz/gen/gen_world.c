#include "fuzz/gen/gen_world.h"

#include "fuzz/gen/aim.h"
#include "fuzz/gen/gen_sketch.h"
#include "ref/world/bake.h"
#include "scenes/rays/ray_modes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MESHES_MOST 3u
#define PARTS_MOST  3u /* geometries of a mesh */

/* Placed triangles that rays are aimed at. */
#define AIMED_MOST 4096u

/* --- what is placed --------------------------------------------------------------------------- */

struct box gen_mesh_box(const struct fuzz_trial *trial, uint32_t mesh)
{
    uint32_t first, count;
    struct box box = box_empty();
    trial_world_mesh(&trial->world, mesh, &first, &count);
    for (size_t i = 3 * (size_t)first; i < 3 * ((size_t)first + count); i++)
        box_add_point(&box, trial->scene.vertex + 3 * (size_t)trial->scene.index[i]);
    return count > 0 ? box : (struct box){{-1, -1, -1}, {1, 1, 1}};
}

static enum status copy_of(const struct scene *scene, struct scene *out)
{
    enum status status = scene_make(scene->vertex_count, scene->tri_count, out);
    if (status)
        return status;
    memcpy(out->vertex, scene->vertex, 12 * (size_t)scene->vertex_count);
    memcpy(out->index, scene->index, 12 * (size_t)scene->tri_count);
    return STATUS_OK;
}

enum status gen_world_placed(const struct fuzz_trial *trial, struct scene *out,
                             struct reason *reason)
{
    struct trial_meshes meshes;
    *out = (struct scene){0};
    enum status status = trial_meshes_make(&trial->world, &trial->scene, &meshes, reason);
    if (status)
        return status;
    status = world_bake(&meshes.world, AIMED_MOST, out, reason);
    trial_meshes_free(&meshes);
    if (status == STATUS_MEMORY || (!status && out->tri_count > 0))
        return status;
    scene_free(out);
    if (copy_of(&trial->scene, out))
        return fail(reason, STATUS_MEMORY, "no memory for placed triangles");
    return STATUS_OK;
}

/* --- drawing ---------------------------------------------------------------------------------- */

/* A recipe of ordinary size: the others are about limits of layouts, which scenes reach. */
static const struct recipe *ordinary_recipe(struct rng *rng)
{
    const struct recipe *recipe = gen_recipe(rng);
    while (recipe->goal)
        recipe = gen_recipe(rng);
    return recipe;
}

static void note(struct fuzz_trial *trial, const char *text)
{
    size_t used = strlen(trial->origin.recipe);
    snprintf(trial->origin.recipe + used, sizeof trial->origin.recipe - used, "%s%s",
             used ? ", " : "", text);
}

/* Draws the triangles of one mesh behind those that are there. */
static void draw_mesh(struct rng *rng, uint32_t goal, struct fuzz_trial *trial)
{
    struct scene *scene = &trial->scene;
    const struct recipe *recipe = ordinary_recipe(rng);
    struct sketch sketch = {.rng = rng,
                            .vertex = scene->vertex + 3 * (size_t)scene->vertex_count,
                            .index = scene->index + 3 * (size_t)scene->tri_count,
                            .goal = goal};
    gen_draw(recipe, &sketch);
    for (size_t i = 0; i < 3 * (size_t)sketch.tri_count; i++)
        sketch.index[i] += scene->vertex_count;
    scene->vertex_count += sketch.vertex_count;
    scene->tri_count += sketch.tri_count;
    note(trial, recipe->name);
}

/* Parts the triangles of a mesh. */
static void draw_geometries(struct rng *rng, uint32_t mesh, uint32_t triangles,
                            struct trial_world *world)
{
    uint32_t parts = rng_below(rng, 2) ? 1 : 1 + rng_below(rng, PARTS_MOST), left = triangles;
    for (uint32_t i = 0; i < parts; i++) {
        uint32_t some = rng_below(rng, left + 1), count = i + 1 == parts ? left : some;
        bool opaque = rng_below(rng, 4) > 0;
        world->geometry[world->geometry_count++] = (struct trial_geometry){mesh, count, opaque};
        left -= count;
    }
}

static void draw_instances(struct rng *rng, struct fuzz_trial *trial)
{
    struct trial_world *world = &trial->world;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct instance *one = &world->instance[i];
        const struct instance *before = i > 0 ? one - 1 : NULL;
        one->mesh = rng_below(rng, trial_world_meshes(world));
        const struct box box = gen_mesh_box(trial, one->mesh);
        gen_place(rng, &box, before, one);
        if (before && before->mesh != WORLD_NO_MESH && rng_below(rng, 2))
            one->mesh = before->mesh;
        if (rng_below(rng, 2))
            gen_instance_members(rng, i, one);
        else
            one->custom = i;
    }
}

/* Mostly a few instances: how they meet is what matters. */
static uint32_t draw_count(struct rng *rng)
{
    uint32_t few = 1 + rng_below(rng, 6), more = 1 + rng_below(rng, 40);
    return rng_below(rng, 16) == 0 ? more : few;
}

static enum status draw_own(struct rng *rng, const struct gen_options *options,
                            struct fuzz_trial *out, struct reason *reason)
{
    uint32_t triangles = options->triangles_least +
                         rng_below(rng, options->triangles_most - options->triangles_least + 1);
    uint32_t meshes = 1 + rng_below(rng, MESHES_MOST), count = draw_count(rng), left = triangles;
    bool empty = rng_below(rng, 32) == 0;
    enum status status = fuzz_trial_make(3 * triangles, triangles, options->rays, out, reason);
    if (!status)
        status = trial_world_make(0, (MESHES_MOST + 1) * PARTS_MOST, count, options->rays,
                                  &out->world, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    out->scene.vertex_count = out->scene.tri_count = 0;
    out->world.geometry_count = 0;
    for (uint32_t m = 0; m < meshes; m++) {
        uint32_t goal = m + 1 == meshes ? left : left / 2;
        draw_mesh(rng, goal, out);
        draw_geometries(rng, m, goal, &out->world);
        left -= goal;
    }
    if (empty)
        draw_geometries(rng, meshes, 0, &out->world);
    draw_instances(rng, out);
    out->world.filter = gen_filter(rng);
    return STATUS_OK;
}

enum status gen_world_draw(struct rng *rng, const struct gen_options *options,
                           struct fuzz_trial *out, struct reason *reason)
{
    const char *name = "";
    if (rng_below(rng, 4) > 0)
        return draw_own(rng, options, out, reason);
    enum status status = gen_world_of_scenes(rng, options->rays, out, &name, reason);
    if (!status)
        note(out, name);
    return status;
}

enum status gen_world_aim(struct rng *rng, struct fuzz_trial *trial, struct reason *reason)
{
    static const enum ray_modes modes[] = {RAY_MODES_ALL, RAY_MODES_MIXED, RAY_MODES_MIXED,
                                           RAY_MODES_DRAWN};
    struct scene placed;
    struct aim aim;
    enum status status = gen_world_placed(trial, &placed, reason);
    if (status)
        return status;
    aim_make(&placed, trial->build.leaf, rng, &aim);
    aim_rays(&aim, rng, trial->ray, trial->ray_count);
    enum ray_modes which = modes[rng_below(rng, ARRAY_COUNT(modes))];
    ray_modes_make(which, rng_u64(rng), trial->ray_count, trial->world.mode);
    scene_free(&placed);
    return STATUS_OK;
}
