#include "ref/fast/small_tree.h"

#include "ref/fast/fast_frame.h"
#include "ref/tree/wide_tree.h"

#include <math.h>

#define Q_MOST     255u
#define WORDS_MOST 0x80000000u

/* A leaf costs as much as a node, as most leaves are tested in one piece. */
static float leaf_cost(void *self, const uint32_t *prim, uint32_t count)
{
    struct small_block block;
    if (!small_block_make(*(const struct scene **)self, prim, count, &block))
        return INFINITY;
    return 1.0f;
}

/* What a tree is made of. */
struct small_making {
    struct fast_tree *tree;
    const struct wide_tree *wide;
    const struct bvh *bvh;
    const struct scene *scene;
};

static uint64_t count_words(const struct small_making *m)
{
    uint64_t words = 0;
    for (uint32_t i = 0; i < m->wide->child_count; i++) {
        const struct wide_child *child = &m->wide->child[i];
        struct small_block block;
        if (child->count &&
            small_block_make(m->scene, m->bvh->prim + child->first, child->count, &block))
            words += small_block_words(&block);
    }
    return words;
}

/* Sets the bounds of all children along an axis. The base is the least lower code, or less where
 * the highest bound would be above FRAME_MOST + 1. */
static void set_bounds(struct fast_small_node *node, const struct wide_child *child, uint32_t count,
                       const struct fast_tree *tree, int k)
{
    uint32_t lower[FAST_WIDTH], upper[FAST_WIDTH], least = FRAME_MOST, most = 0, shift = 0;
    for (uint32_t i = 0; i < count; i++) {
        lower[i] = frame_down(tree, k, child[i].bounds.lo[k]);
        upper[i] = frame_up(tree, k, child[i].bounds.hi[k]);
        least = lower[i] < least ? lower[i] : least;
        most = upper[i] > most ? upper[i] : most;
    }
    while ((most - least) > Q_MOST << shift)
        shift++;
    const uint32_t rest = (1u << shift) - 1, span = ((most - least + rest) >> shift) << shift;
    if (least + span > FRAME_MOST)
        least = most > span ? most - span : 0;
    for (uint32_t i = 0; i < count; i++) {
        node->bound[0][k][i] = (uint8_t)((lower[i] - least) >> shift);
        node->bound[1][k][i] = (uint8_t)((upper[i] - least + rest) >> shift);
    }
    node->base[k] = (uint16_t)least;
    node->shifts |= (uint16_t)(shift << 4 * k);
}

static uint32_t add_leaf(const struct small_making *m, const struct wide_child *child)
{
    struct small_block block;
    uint32_t first = (uint32_t)m->tree->block_words;
    (void)small_block_make(m->scene, m->bvh->prim + child->first, child->count,
                           &block); /* fits: checked by leaf_cost */
    small_block_write(&block, m->tree->block + first);
    m->tree->block_words += small_block_words(&block);
    return first;
}

static void fill_node(const struct small_making *m, uint32_t index)
{
    const struct wide_node *from = &m->wide->node[index];
    const struct wide_child *child = &m->wide->child[from->first];
    struct fast_small_node node = {.shifts = (uint16_t)(from->count << 12)};
    bool any_node = false;
    node.first[1] = (uint32_t)m->tree->block_words;
    for (uint32_t i = 0; i < from->count; i++) {
        if (child[i].count) {
            node.ref[i] = (uint16_t)(SMALL_LEAF | (add_leaf(m, &child[i]) - node.first[1]));
            continue;
        }
        node.first[0] = any_node ? node.first[0] : child[i].first;
        node.ref[i] = (uint16_t)(child[i].first - node.first[0]);
        any_node = true;
    }
    for (int k = 0; k < 3; k++)
        set_bounds(&node, child, from->count, m->tree, k);
    m->tree->small[index] = node;
}

static enum status fill(const struct small_making *m, struct reason *reason)
{
    const uint64_t words = count_words(m);
    const struct wide_tree *wide = m->wide;
    struct fast_tree *tree = m->tree;
    if (wide->stack_need > FAST_STACK)
        return fail(reason, STATUS_LIMIT,
                    "fast_small: the traversal stack holds %u entries, this tree needs %u; use "
                    "another builder",
                    FAST_STACK, wide->stack_need);
    if (words > WORDS_MOST)
        return fail(reason, STATUS_LIMIT, "fast_small: leaves of %llu MB, at most %u MB fit",
                    (unsigned long long)(words >> 18), WORDS_MOST >> 18);
    tree->block = frame_pages((words + SMALL_BEYOND) * sizeof *tree->block);
    tree->small = frame_pages(wide->node_count * sizeof *tree->small);
    if (!tree->block || !tree->small)
        return fail(reason, STATUS_MEMORY, "fast_small: no memory for %u nodes", wide->node_count);
    frame_set(tree, &wide->bounds);
    tree->node_count = wide->node_count;
    tree->stack_need = wide->stack_need;
    for (uint32_t i = 0; i < wide->node_count; i++)
        fill_node(m, i);
    tree->in_stream = true;
    tree->in_pairs = fast_bytes(tree) >> 20 >= FAST_PAIRS;
    return STATUS_OK;
}

enum status fast_make_small(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                            struct reason *reason)
{
    const struct wide_rule rule = {.width = FAST_WIDTH,
                                   .leaf_most = SMALL_TRIS,
                                   .node_cost = 1,
                                   .leaf_cost = leaf_cost,
                                   .self = &scene};
    struct wide_tree wide;
    *out = (struct fast_tree){.node = NULL};
    const struct small_making m = {out, &wide, bvh, scene};
    enum status status = wide_tree_make(bvh, scene, &rule, &wide, reason);
    if (!status && wide.node_count > 0)
        status = fill(&m, reason);
    wide_tree_free(&wide);
    if (status)
        fast_free(out);
    return status;
}
