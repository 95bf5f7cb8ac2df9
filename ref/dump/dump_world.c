#include "ref/dump/dump_world.h"

#include <stdlib.h>
#include <string.h>

struct dump_comparing {
    const struct tree_dump *dump;
    const struct world *world;
    struct dump_differences *out;
};

static void note(struct dump_comparing *c, uint32_t instance, const struct dump_source *triangle)
{
    struct dump_differences *out = c->out;
    if (out->instances + out->triangles == 0) {
        out->instance = instance;
        out->triangle = triangle ? *triangle : (struct dump_source){DUMP_NO_NUMBER, 0};
    }
    if (triangle)
        out->triangles++;
    else
        out->instances++;
}

/* The triangle of a mesh with that number, or NULL. */
static const uint32_t *triangle_of(const struct world_mesh *mesh, const struct dump_source *source)
{
    if (source->geometry >= mesh->geometry_count ||
        source->triangle >= mesh->geometry[source->geometry].count)
        return NULL;
    return mesh->scene->index +
           3 * ((size_t)mesh->geometry[source->geometry].first + source->triangle);
}

/* Triangles of a tree are each in the file once, so as many as the mesh has are all of them. */
static void compare_mesh(struct dump_comparing *c, uint32_t instance, const struct tree_dump *tree,
                         const struct world_mesh *mesh)
{
    const struct scene *scene = mesh->scene;
    uint32_t known = 0;
    for (uint32_t i = 0; i < tree->scene.tri_count; i++) {
        const uint32_t *index = triangle_of(mesh, &tree->source[i]);
        bool same = index != NULL;
        for (size_t v = 0; v < 3 && same; v++)
            same = memcmp(tree->scene.vertex + 9 * (size_t)i + 3 * v,
                          scene->vertex + 3 * (size_t)index[v], 3 * sizeof(float)) == 0;
        if (!same)
            note(c, instance, &tree->source[i]);
        known += index != NULL;
    }
    for (uint32_t i = known; i < scene->tri_count; i++)
        note(c, instance, &(struct dump_source){DUMP_NO_NUMBER - 1, i - known});
}

static bool is_same(const struct dump_instance *is, const struct instance *should)
{
    return memcmp(is->m, should->m, sizeof is->m) == 0 && is->custom == should->custom &&
           is->mask == should->mask && should->mesh != WORLD_NO_MESH;
}

/* Items are sorted by number. `met` has which mesh each tree was compared with, plus 1. */
static void compare_instances(struct dump_comparing *c, uint32_t *met)
{
    const struct tree_dump *dump = c->dump;
    uint32_t item = 0;
    for (uint32_t i = 0; i < c->world->instance_count; i++) {
        const struct instance *should = &c->world->instance[i];
        if (item == dump->tri_count || dump->instance[item].number != i) {
            if (should->mesh != WORLD_NO_MESH)
                note(c, i, NULL);
            continue;
        }
        const struct dump_instance *is = &dump->instance[item++];
        const uint32_t tree = is->below;
        if (!is_same(is, should) ||
            (tree != DUMP_NO_TREE && met[tree] && met[tree] != should->mesh + 1)) {
            note(c, i, NULL);
            continue;
        }
        if (tree == DUMP_NO_TREE || met[tree])
            continue;
        met[tree] = should->mesh + 1;
        compare_mesh(c, i, &dump->below[tree], &c->world->mesh[should->mesh]);
    }
    for (; item < dump->tri_count; item++)
        note(c, dump->instance[item].number, NULL);
}

enum status dump_compare(const struct tree_dump *dump, const struct world *world,
                         struct dump_differences *out, struct reason *reason)
{
    struct dump_comparing c = {dump, world, out};
    *out = (struct dump_differences){.triangle.geometry = DUMP_NO_NUMBER};
    if (dump->instance) {
        uint32_t *met = alloc_zeroed(dump->below_count, sizeof *met);
        if (!met)
            return fail(reason, STATUS_MEMORY, "no memory to compare %zu trees", dump->below_count);
        compare_instances(&c, met);
        free(met);
    } else if (world->mesh_count == 1) {
        compare_mesh(&c, 0, dump, &world->mesh[0]);
    } else if (dump->tri_count || world->instance_count) {
        return fail(reason, STATUS_INPUT, "a tree of one mesh, the world has %u",
                    world->mesh_count);
    }
    return STATUS_OK;
}
