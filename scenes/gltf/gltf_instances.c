/* The tree of nodes of a glTF file, and the instances that are made of it. */
#include "scenes/gltf/gltf.h"
#include "scenes/read/world_fields.h"

#include <math.h>

/* --- the tree --------------------------------------------------------------------------------- */

/* Sets the parent of each node; none has two. */
static enum status set_parents(struct gltf *gltf)
{
    for (uint32_t i = 0; i < gltf->node.count; i++) {
        struct gltf_range children = gltf->node.item[i].children;
        for (uint32_t k = 0; k < children.count; k++) {
            uint32_t child = gltf->child.item[children.first + k];
            if (child >= gltf->node.count)
                return gltf_fail(gltf, "nodes[%u].children[%u]: %u, but there are %zu nodes", i, k,
                                 child, gltf->node.count);
            struct gltf_node *node = &gltf->node.item[child];
            if (node->parent != GLTF_NONE)
                return gltf_fail(gltf,
                                 "nodes[%u].children[%u]: node %u has a parent already, node %u", i,
                                 k, child, node->parent);
            node->parent = i;
        }
    }
    return STATUS_OK;
}

/* The root above a node. */
static enum status find_root(const struct gltf *gltf, uint32_t at, uint32_t *root)
{
    *root = at;
    for (unsigned deep = 0; gltf->node.item[*root].parent != GLTF_NONE; deep++) {
        *root = gltf->node.item[*root].parent;
        if (*root == at)
            return gltf_fail(gltf, "nodes[%u]: is its own ancestor", at);
        if (deep == GLTF_DEEP)
            return gltf_fail(gltf,
                             "nodes[%u]: lies deeper than %u nodes, or under a circle of them", at,
                             GLTF_DEEP);
    }
    return STATUS_OK;
}

/* Marks the roots of a scene. */
static enum status mark_roots(struct gltf *gltf, uint32_t scene)
{
    struct gltf_range roots = gltf->scene.item[scene];
    for (uint32_t k = 0; k < roots.count; k++) {
        uint32_t root = gltf->root.item[roots.first + k];
        if (root >= gltf->node.count)
            return gltf_fail(gltf, "scenes[%u].nodes[%u]: %u, but there are %zu nodes", scene, k,
                             root, gltf->node.count);
        struct gltf_node *node = &gltf->node.item[root];
        if (node->parent != GLTF_NONE)
            return gltf_fail(gltf,
                             "scenes[%u].nodes[%u]: node %u is no root: its parent is node %u",
                             scene, k, root, node->parent);
        if (node->in_scene)
            return gltf_fail(gltf, "scenes[%u].nodes[%u]: node %u is there twice", scene, k, root);
        node->in_scene = true;
    }
    return STATUS_OK;
}

/* Marks the nodes of the scene that is placed. */
static enum status mark_scene(struct gltf *gltf)
{
    uint32_t scene = gltf->default_scene;
    if (scene != GLTF_NONE && scene >= gltf->scene.count)
        return gltf_fail(gltf, "scene: %u, but there are %zu scenes", scene, gltf->scene.count);
    uint32_t root;
    enum status status = set_parents(gltf);
    for (uint32_t i = 0; i < gltf->node.count && !status; i++)
        status = find_root(gltf, i, &root);
    if (!status && gltf->scene.count)
        status = mark_roots(gltf, scene == GLTF_NONE ? 0 : scene);
    for (uint32_t i = 0; i < gltf->node.count && !status; i++) {
        status = find_root(gltf, i, &root);
        gltf->node.item[i].in_scene = !gltf->scene.count || gltf->node.item[root].in_scene;
    }
    return status;
}

/* --- matrices --------------------------------------------------------------------------------- */

/* What is placed by `inner`, then by `outer`. */
static struct gltf_transform multiply(const struct gltf_transform *outer,
                                      const struct gltf_transform *inner)
{
    struct gltf_transform out;
    for (int i = 0; i < 3; i++) {
        const double *a = outer->m[i];
        for (int j = 0; j < 4; j++) {
            out.m[i][j] = (a[0] * inner->m[0][j] + a[1] * inner->m[1][j]) + a[2] * inner->m[2][j];
            if (j == 3)
                out.m[i][j] += a[3];
        }
    }
    return out;
}

/* The transform of a node in its scene, rounded. Nodes without one leave it as it is, to the signs
 * of zeros. */
static enum status place(const struct gltf *gltf, uint32_t at, struct instance *instance)
{
    /* From this double on, rounding to float gives infinity; NaN fails the comparison. */
    static const double beyond = 0x1.ffffffp127;
    struct gltf_transform all;
    bool any = false;
    for (uint32_t i = at; i != GLTF_NONE; i = gltf->node.item[i].parent) {
        uint32_t own = gltf->node.item[i].transform;
        if (own != GLTF_NONE)
            all = any ? multiply(&gltf->transform.item[own], &all) : gltf->transform.item[own];
        any = any || own != GLTF_NONE;
    }
    for (int i = 0; i < 12 && any; i++) {
        double value = all.m[i / 4][i % 4];
        if (!(fabs(value) < beyond))
            return gltf_fail(gltf,
                             "nodes[%u]: row %d, column %d of its matrix in the scene is beyond "
                             "the range of a 32-bit float",
                             at, i / 4, i % 4);
        instance->m[i / 4][i % 4] = (float)value;
    }
    if (instance_det_sign(instance->m) == 0)
        return gltf_fail(gltf,
                         "nodes[%u]: its matrix in the scene is singular: the determinant is "
                         "exactly 0",
                         at);
    return STATUS_OK;
}

/* --- instances -------------------------------------------------------------------------------- */

/* True if the node is an instance. */
static bool is_placed(const struct gltf_node *node)
{
    return node->in_scene && (node->mesh != GLTF_NONE || node->told);
}

static enum status make_instance(const struct gltf *gltf, uint32_t at, const bool *double_sided,
                                 struct instance *out)
{
    const struct gltf_node *node = &gltf->node.item[at];
    *out = node->told ? *node->told : instance_default();
    out->mesh = node->mesh == GLTF_NONE ? WORLD_NO_MESH : node->mesh;
    if (node->mesh != GLTF_NONE && !node->flags_told && double_sided[node->mesh])
        out->flags = ABI_INSTANCE_CULL_DISABLE;
    return place(gltf, at, out);
}

enum status gltf_make_instances(struct gltf *gltf, const bool *double_sided, struct world *out)
{
    enum status status = mark_scene(gltf);
    for (uint32_t i = 0; i < gltf->node.count && !status; i++) {
        uint32_t mesh = gltf->node.item[i].mesh;
        if (mesh != GLTF_NONE && mesh >= gltf->mesh.count)
            status = gltf_fail(gltf, "nodes[%u].mesh: %u, but there are %zu meshes", i, mesh,
                               gltf->mesh.count);
        out->instance_count += is_placed(&gltf->node.item[i]);
    }
    if (status)
        return status;
    out->instance = alloc_zeroed(out->instance_count, sizeof *out->instance);
    if (!out->instance)
        return gltf_no_memory(gltf);
    uint32_t next = 0;
    for (uint32_t i = 0; i < gltf->node.count && !status; i++)
        if (is_placed(&gltf->node.item[i]))
            status = make_instance(gltf, i, double_sided, &out->instance[next++]);
    return status;
}
