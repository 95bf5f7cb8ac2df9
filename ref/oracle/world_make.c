#include "ref/oracle/internal.h"
#include "ref/oracle/oracle_world.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static float finite(float x)
{
    return fminf(fmaxf(x, -FLT_MAX), FLT_MAX);
}

/* Nodes of the mesh's tree whose boxes are placed: their union is smaller than the whole box,
 * placed, by a third of its sides and more if it is turned. */
#define PLACED_LEVELS 4

/* Grows *out by the boxes of what lies `levels` below a node, placed, or above it in leaves. */
static void add_placed(const struct tree *tree, uint32_t at, unsigned levels, const float m[3][4],
                       struct box *out)
{
    const struct tree_node *node = &tree->node[at];
    for (int side = 0; side < 2; side++) {
        struct box box;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = node->lo[k][side];
            box.hi[k] = node->hi[k][side];
        }
        if (box.lo[0] > box.hi[0]) /* an empty side of the root */
            continue;
        if (levels > 1 && node->count[side] == 0) {
            add_placed(tree, node->child[side], levels - 1, m, out);
        } else {
            box = placing_bounds(m, &box);
            box_add_box(out, &box);
        }
    }
}

/* The box of one instance, for the tree; false if the rays need not look for it. */
static bool part_of(const struct placing *placing, uint32_t at, struct oracle_part *out)
{
    const struct instance *instance = &placing->world->instance[at];
    const struct scene *scene = world_scene(placing->world, at);
    if (instance->mask == 0 || !scene || scene->tri_count == 0)
        return false;
    out->prim = at;
    out->box = box_empty();
    add_placed(&placing->mesh[instance->mesh]->tree, 0, PLACED_LEVELS, instance->m, &out->box);
    for (int k = 0; k < 3; k++)
        out->middle[k] = 0.5f * finite(out->box.lo[k]) + 0.5f * finite(out->box.hi[k]);
    return true;
}

static enum status make_top(struct placing *placing, struct reason *reason)
{
    const struct world *world = placing->world;
    uint32_t count = 0;
    struct oracle_part *part = alloc_zeroed(world->instance_count, sizeof *part);
    placing->inverse = alloc_zeroed(world->instance_count, sizeof *placing->inverse);
    if (!part || !placing->inverse) {
        free(part);
        return fail(reason, STATUS_MEMORY, "oracle: no memory for %u instances",
                    world->instance_count);
    }
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *instance = &world->instance[i];
        if (instance_is_identity(instance))
            placing->inverse[i] = (struct inverse){.det_sign = 1, .identity = true};
        else
            placing_invert(instance->m, &placing->inverse[i]);
        count += part_of(placing, i, &part[count]);
    }
    enum status status = tree_make_parts(part, count, 1, &placing->top, reason);
    free(part);
    return status;
}

static enum status make_placing(const struct world *world, struct placing *out,
                                struct reason *reason)
{
    out->world = world;
    out->mesh = alloc_zeroed(world->mesh_count, sizeof(struct oracle *));
    if (!out->mesh)
        return fail(reason, STATUS_MEMORY, "oracle: no memory for %u meshes", world->mesh_count);
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        enum status status = oracle_make(world->mesh[i].scene, &out->mesh[i], reason);
        if (status)
            return status;
    }
    return make_top(out, reason);
}

enum status oracle_make_world(const struct world *world, struct oracle **out, struct reason *reason)
{
    *out = NULL;
    enum status status = oracle_environment(reason);
    if (status)
        return status;
    struct oracle *oracle = alloc_zeroed(1, sizeof *oracle);
    if (oracle)
        oracle->placing = alloc_zeroed(1, sizeof *oracle->placing);
    if (!oracle || !oracle->placing) {
        free(oracle);
        return fail(reason, STATUS_MEMORY, "oracle: no memory");
    }
    status = make_placing(world, oracle->placing, reason);
    if (status) {
        oracle_free(oracle);
        return status;
    }
    *out = oracle;
    return STATUS_OK;
}

void placing_free(struct placing *placing)
{
    if (!placing)
        return;
    for (uint32_t i = 0; placing->mesh && i < placing->world->mesh_count; i++)
        oracle_free(placing->mesh[i]);
    tree_free(&placing->top);
    free(placing->mesh);
    free(placing->inverse);
    free(placing);
}

const struct world *oracle_world(const struct oracle *oracle)
{
    return oracle->placing ? oracle->placing->world : NULL;
}
