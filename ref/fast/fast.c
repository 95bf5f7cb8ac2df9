#include "ref/fast/fast.h"

#include "ref/fast/block.h"
#include "ref/fast/fast_frame.h"
#include "ref/tree/wide_tree.h"

#include <math.h>
#include <stdlib.h>

/* A leaf costs as much as a node, as all its triangles are tested together. */
static float leaf_cost(void *self, const uint32_t *prim, uint32_t count)
{
    struct block block;
    return block_make(*(const struct scene **)self, prim, count, &block) ? 1.0f : INFINITY;
}

/* --- nodes and blocks ----------------------------------------------------------------------------
 */

static uint64_t count_words(const struct wide_tree *wide, const struct bvh *bvh,
                            const struct scene *scene)
{
    uint64_t words = 0;
    for (uint32_t i = 0; i < wide->child_count; i++) {
        const struct wide_child *child = &wide->child[i];
        struct block block;
        if (child->count && block_make(scene, bvh->prim + child->first, child->count, &block))
            words += block_words(&block);
    }
    return words;
}

static uint32_t add_leaf(struct fast_tree *tree, const uint32_t *prim, uint32_t count,
                         const struct scene *scene, bool items)
{
    struct block block;
    uint32_t first = (uint32_t)tree->block_words;
    if (items)
        return FAST_LEAF | prim[0];
    (void)block_make(scene, prim, count, &block); /* fits: checked by leaf_cost */
    block_write(&block, tree->block + first);
    tree->block_words += block_words(&block);
    return FAST_LEAF | (block.vertex_count - 1) << FAST_LEAF_COUNT | first;
}

static void fill_node(struct fast_tree *tree, const struct wide_tree *wide, uint32_t index,
                      const struct bvh *bvh, const struct scene *scene, bool items)
{
    struct fast_node node = {.ref = {0}};
    for (uint32_t i = 0; i < FAST_WIDTH; i++) {
        if (i >= wide->node[index].count) {
            for (int k = 0; k < 3; k++)
                node.bound[0][k][i] = FRAME_MOST;
            continue;
        }
        const struct wide_child *child = &wide->child[wide->node[index].first + i];
        for (int k = 0; k < 3; k++) {
            node.bound[0][k][i] = frame_down(tree, k, child->bounds.lo[k]);
            node.bound[1][k][i] = frame_up(tree, k, child->bounds.hi[k]);
        }
        node.ref[i] = child->first;
        if (child->count)
            node.ref[i] = add_leaf(tree, bvh->prim + child->first, child->count, scene, items);
    }
    tree->node[index] = node;
}

static enum status fill(struct fast_tree *tree, const struct wide_tree *wide, const struct bvh *bvh,
                        const struct scene *scene, bool items, struct reason *reason)
{
    uint64_t words = items ? 0 : count_words(wide, bvh, scene);
    if (wide->stack_need > FAST_STACK)
        return fail(reason, STATUS_LIMIT,
                    "fast: the traversal stack holds %u entries, this tree needs %u; use another "
                    "builder",
                    FAST_STACK, wide->stack_need);
    if (words > FAST_LEAF_WORDS)
        return fail(reason, STATUS_LIMIT, "fast: leaves of %llu MB, at most %u MB fit",
                    (unsigned long long)(words >> 18), FAST_LEAF_WORDS >> 18);
    /* Kernels read whole vectors: a row of vertices may be read up to BLOCK_VERTICES words beyond
     * the last block. */
    tree->block = frame_pages((words + BLOCK_VERTICES) * sizeof *tree->block);
    tree->node = frame_pages(wide->node_count * sizeof *tree->node);
    if (!tree->block || !tree->node)
        return fail(reason, STATUS_MEMORY, "fast: no memory for %u nodes", wide->node_count);
    frame_set(tree, &wide->bounds);
    tree->node_count = wide->node_count;
    tree->stack_need = wide->stack_need;
    for (uint32_t i = 0; i < wide->node_count; i++)
        fill_node(tree, wide, i, bvh, scene, items);
    tree->packet_width =
        FAST_PACKET_TRIS * (float)sqrt(box_half_area(&tree->bounds) / scene->tri_count);
    tree->in_packets = tree->in_stream = true;
    tree->in_pairs = fast_bytes(tree) >> 20 >= FAST_PAIRS;
    return STATUS_OK;
}

static enum status make(const struct bvh *bvh, const struct scene *scene,
                        const struct wide_rule *rule, struct fast_tree *out, struct reason *reason)
{
    struct wide_tree wide;
    *out = (struct fast_tree){.node = NULL};
    enum status status = wide_tree_make(bvh, scene, rule, &wide, reason);
    if (!status && wide.node_count > 0)
        status = fill(out, &wide, bvh, scene, rule->leaf_most == 1, reason);
    wide_tree_free(&wide);
    if (status)
        fast_free(out);
    return status;
}

enum status fast_make(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                      struct reason *reason)
{
    const struct wide_rule rule = {.width = FAST_WIDTH,
                                   .leaf_most = BLOCK_TRIS,
                                   .node_cost = 1,
                                   .leaf_cost = leaf_cost,
                                   .self = &scene};
    return make(bvh, scene, &rule, out, reason);
}

enum status fast_make_items(const struct bvh *bvh, const struct scene *items, struct fast_tree *out,
                            struct reason *reason)
{
    const struct wide_rule rule = {.width = FAST_WIDTH, .leaf_most = 1, .node_cost = 1};
    return make(bvh, items, &rule, out, reason);
}

void fast_free(struct fast_tree *tree)
{
    free(tree->node);
    free(tree->small);
    free(tree->block);
    *tree = (struct fast_tree){.node = NULL};
}
