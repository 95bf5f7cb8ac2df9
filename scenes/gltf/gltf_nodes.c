/* Nodes and scenes of a glTF file, as they stand there. */
#include "scenes/gltf/gltf.h"
#include "scenes/read/world_fields.h"

#include <string.h>

/* A node while it is read. */
struct node_read {
    struct gltf *gltf;
    size_t at;
    double matrix[16]; /* column by column */
    double translation[3], rotation[4], scale[3];
    bool has_matrix, has_parts;
    struct instance told;
    bool is_told;
};

static struct gltf_node *node_of(const struct node_read *read)
{
    return &read->gltf->node.item[read->at];
}

/* An array of exactly `count` numbers. */
struct node_numbers {
    double *out;
    size_t count, done;
};

static enum status take_number(struct json_pull *pull, void *self)
{
    struct node_numbers *numbers = self;
    if (numbers->done == numbers->count)
        return json_pull_fail(pull, "is one more than %zu numbers", numbers->count);
    return json_pull_double(pull, &numbers->out[numbers->done++]);
}

static enum status take_numbers(struct json_pull *pull, size_t count, double *out)
{
    struct node_numbers numbers = {.out = out, .count = count};
    enum status status = json_pull_array(pull, take_number, &numbers);
    if (!status && numbers.done != count)
        status = json_pull_fail(pull, "must be %zu numbers, not %zu", count, numbers.done);
    return status;
}

static enum status take_matrix(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    read->has_matrix = true;
    enum status status = take_numbers(pull, 16, read->matrix);
    if (status)
        return status;
    const double *m = read->matrix;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return json_pull_fail(pull, "its last row, elements 3, 7, 11 and 15, must be 0 0 0 1");
    return STATUS_OK;
}

static enum status take_translation(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    read->has_parts = true;
    return take_numbers(pull, 3, read->translation);
}

static enum status take_scale(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    read->has_parts = true;
    return take_numbers(pull, 3, read->scale);
}

/* The squared length of the quaternion. */
static double length2(const double q[4])
{
    return (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
}

static enum status take_rotation(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    read->has_parts = true;
    enum status status = take_numbers(pull, 4, read->rotation);
    double squared = length2(read->rotation);
    if (!status && !(squared >= 0.98 && squared <= 1.02))
        status = json_pull_fail(pull, "is no quaternion of length 1, to within a hundredth");
    return status;
}

static enum status take_node_mesh(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &node_of(self)->mesh);
}

static enum status take_skin(struct json_pull *pull, void *self)
{
    ((struct node_read *)self)->gltf->notes->skins++;
    return json_walk_skip(&pull->walk);
}

static enum status take_child(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    uint32_t *child;
    if (!GLTF_APPEND(read->gltf->child, child))
        return gltf_no_memory(read->gltf);
    node_of(read)->children.count++;
    return gltf_take_id(pull, child);
}

static enum status take_children(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    node_of(read)->children.first = (uint32_t)read->gltf->child.count;
    return json_pull_array(pull, take_child, read);
}

static enum status take_told_flags(struct json_pull *pull, void *self)
{
    struct node_read *read = self;
    node_of(read)->flags_told = true;
    return take_flags(pull, &read->told);
}

static enum status take_told_custom(struct json_pull *pull, void *self)
{
    return take_custom(pull, &((struct node_read *)self)->told);
}

static enum status take_told_mask(struct json_pull *pull, void *self)
{
    return take_mask(pull, &((struct node_read *)self)->told);
}

static enum status take_raydiff(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"custom", take_told_custom, false},
                                                 {"mask", take_told_mask, false},
                                                 {"flags", take_told_flags, false},
                                                 {0}};
    ((struct node_read *)self)->is_told = true;
    return json_pull_object(pull, members, self);
}

/* Extras may be anything; those that are no object are other programs'. */
static enum status take_extras(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"raydiff", take_raydiff, false}, {0}};
    if (json_walk_peek(&pull->walk) != '{')
        return json_walk_skip(&pull->walk);
    return json_pull_object(pull, members, self);
}

static struct gltf_transform of_matrix(const double matrix[16])
{
    struct gltf_transform out;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out.m[i][j] = matrix[4 * j + i];
    return out;
}

/* Scales, then rotates, then translates. Dividing by the squared length makes it the rotation of
 * the quaternion of length 1 without a root, and a quarter turn exact. */
static struct gltf_transform of_parts(const struct node_read *read)
{
    const double *q = read->rotation, length = length2(q), w2 = q[3] * q[3];
    struct gltf_transform out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double own = (w2 + q[i] * q[i]) - (q[j] * q[j] + q[k] * q[k]);
        out.m[i][i] = own / length * read->scale[i];
        out.m[i][j] = 2 * (q[i] * q[j] - q[k] * q[3]) / length * read->scale[j];
        out.m[i][k] = 2 * (q[i] * q[k] + q[j] * q[3]) / length * read->scale[k];
        out.m[i][3] = read->translation[i];
    }
    return out;
}

/* Stores what was read of a node. */
static enum status finish_node(struct json_pull *pull, struct node_read *read)
{
    struct gltf *gltf = read->gltf;
    if (read->has_matrix && read->has_parts)
        return json_pull_fail(pull, "has a matrix, and translation, rotation or scale");
    if (read->has_matrix || read->has_parts) {
        struct gltf_transform *transform;
        if (!GLTF_APPEND(gltf->transform, transform))
            return gltf_no_memory(gltf);
        *transform = read->has_matrix ? of_matrix(read->matrix) : of_parts(read);
        node_of(read)->transform = (uint32_t)gltf->transform.count - 1;
    }
    if (read->is_told) {
        node_of(read)->told = alloc_copy(&read->told, 1, sizeof read->told);
        if (!node_of(read)->told)
            return gltf_no_memory(gltf);
    }
    return STATUS_OK;
}

static enum status take_node(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"children", take_children, false},
                                                 {"mesh", take_node_mesh, false},
                                                 {"matrix", take_matrix, false},
                                                 {"translation", take_translation, false},
                                                 {"rotation", take_rotation, false},
                                                 {"scale", take_scale, false},
                                                 {"skin", take_skin, false},
                                                 {"extras", take_extras, false},
                                                 {0}};
    struct gltf *gltf = self;
    struct gltf_node *node;
    if (gltf->node.count == GLTF_NONE - 1)
        return json_pull_fail(pull, "is one node more than 4294967294");
    if (!GLTF_APPEND(gltf->node, node))
        return gltf_no_memory(gltf);
    node->mesh = node->parent = node->transform = GLTF_NONE;
    struct node_read read = {.gltf = gltf,
                             .at = gltf->node.count - 1,
                             .rotation = {0, 0, 0, 1},
                             .scale = {1, 1, 1},
                             .told = instance_default()};
    enum status status = json_pull_object(pull, members, &read);
    return status ? status : finish_node(pull, &read);
}

enum status gltf_take_nodes(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_node, self);
}

static enum status take_root(struct json_pull *pull, void *self)
{
    struct gltf *gltf = self;
    uint32_t *root;
    if (!GLTF_APPEND(gltf->root, root))
        return gltf_no_memory(gltf);
    gltf->scene.item[gltf->scene.count - 1].count++;
    return gltf_take_id(pull, root);
}

static enum status take_roots(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_root, self);
}

static enum status take_scene(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"nodes", take_roots, false}, {0}};
    struct gltf *gltf = self;
    struct gltf_range *scene;
    if (!GLTF_APPEND(gltf->scene, scene))
        return gltf_no_memory(gltf);
    scene->first = (uint32_t)gltf->root.count;
    return json_pull_object(pull, members, gltf);
}

enum status gltf_take_scenes(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_scene, self);
}
