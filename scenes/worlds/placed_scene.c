#include "scenes/worlds/placed_scene.h"

#include "ref/world/bake.h"
#include "ref/world/world_boxes.h"
#include "scenes/worlds.h"

#include <string.h>

/* Hues that differ in brightness, too, for those who see few. */
static const float colours[][3] = {
    {0.90f, 0.60f, 0.00f}, {0.35f, 0.70f, 0.90f}, {0.00f, 0.60f, 0.50f}, {0.95f, 0.90f, 0.25f},
    {0.00f, 0.45f, 0.70f}, {0.80f, 0.40f, 0.00f}, {0.80f, 0.60f, 0.70f}, {0.75f, 0.75f, 0.75f}};
#define COLOURS ARRAY_COUNT(colours)

/* The instances of the scene in its order: those that rays can meet, every `step` of all. */
static void paint(const struct world *world, uint32_t step, struct scene *scene)
{
    uint32_t tri = 0;
    for (uint64_t i = 0; i < world->instance_count; i += step) {
        if (!world_is_active(world, (uint32_t)i))
            continue;
        uint32_t count = world_scene(world, (uint32_t)i)->tri_count;
        for (uint32_t k = 0; k < count && tri < scene->tri_count; k++)
            scene->material_of[tri++] = (int32_t)(i % COLOURS);
    }
}

static enum status colour(const struct world *world, struct scene *scene, struct reason *reason)
{
    scene->material_of = alloc_zeroed(scene->tri_count, sizeof *scene->material_of);
    scene->material = alloc_zeroed(COLOURS, sizeof *scene->material);
    if (!scene->material_of || !scene->material)
        return fail(reason, STATUS_MEMORY, "no memory for colours");
    scene->material_count = COLOURS;
    for (size_t c = 0; c < COLOURS; c++) {
        scene->material[c] = (struct material){.albedo = {0.9f, 0.1f, 0}, .spec = 10};
        memcpy(scene->material[c].color, colours[c], sizeof colours[c]);
    }
    paint(world, world_bake_step(world, PLACED_MOST), scene);
    return STATUS_OK;
}

enum status placed_scene_open(const char *spec, uint64_t seed, struct scene *out, uint64_t *placed,
                              struct reason *reason)
{
    struct world world;
    struct reason why = {""};
    *placed = 0;
    *out = (struct scene){0};
    enum status status = world_open(spec, seed, &world, reason);
    if (status)
        return status;
    if (world_only_scene(&world)) {
        world_free(&world);
        return scene_open(spec, seed, out, reason);
    }
    for (uint32_t i = 0; i < world.instance_count; i++)
        if (world_is_active(&world, i))
            *placed += world_scene(&world, i)->tri_count;
    if (*placed == 0)
        status = fail(&why, STATUS_INPUT, "a world in which nothing can be hit");
    if (!status)
        status = world_bake(&world, PLACED_MOST, out, &why);
    if (!status)
        status = colour(&world, out, &why);
    if (status) {
        scene_free(out);
        (void)fail(reason, status, "%.120s: %s", spec, why.text);
    }
    world_free(&world);
    return status;
}
