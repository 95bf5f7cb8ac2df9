#include "ref/fast/small_tree.h"

#include "ref/fast/fast_frame.h"
#include "ref/fast/tiny_block.h"
#include "ref/tree/wide_tree.h"

#include <math.h>

#define Q_MOST     255u
#define WORDS_MOST 0x80000000u

/* A form of leaves: what a tree's blocks are.
 *   words   the words of a leaf of `count` triangles, or 0 if they do not fit in one
 *   write   writes it into words that are zero */
struct leaf_form {
    const char *engine;
    uint32_t tris; /* most in a leaf */
    uint32_t (*words)(const struct fast_tree *tree, const struct scene *scene, const uint32_t *prim,
                      uint32_t count);
    void (*write)(const struct fast_tree *tree, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *out);
};

/* What a tree is made of. */
struct small_making {
    struct fast_tree *tree;
    const struct wide_tree *wide;
    const struct bvh *bvh;
    const struct scene *scene;
    const struct leaf_form *form;
};

static uint32_t small_words(const struct fast_tree *tree, const struct scene *scene,
                            const uint32_t *prim, uint32_t count)
{
    struct small_block block;
    (void)tree;
    return small_block_make(scene, prim, count, &block) ? small_block_words(&block) : 0;
}

static void small_write(const struct fast_tree *tree, const struct scene *scene,
                        const uint32_t *prim, uint32_t count, uint32_t *out)
{
    struct small_block block;
    (void)tree;
    if (small_block_make(scene, prim, count, &block))
        small_block_write(&block, out);
}

static uint32_t tiny_words(const struct fast_tree *tree, const struct scene *scene,
                           const uint32_t *prim, uint32_t count)
{
    struct tiny_block block;
    return tiny_block_make(&tree->tiny, scene, prim, count, &block)
               ? tiny_block_words(&tree->tiny, &block)
               : 0;
}

static void tiny_write(const struct fast_tree *tree, const struct scene *scene,
                       const uint32_t *prim, uint32_t count, uint32_t *out)
{
    struct tiny_block block;
    if (tiny_block_make(&tree->tiny, scene, prim, count, &block))
        tiny_block_write(&tree->tiny, &block, out);
}

static const struct leaf_form small_form = {"fast_small", SMALL_TRIS, small_words, small_write};
static const struct leaf_form tiny_form = {"fast_small", TINY_TRIS, tiny_words, tiny_write};

/* A leaf costs as much as a node, as most leaves are tested in few pieces. */
static float leaf_cost(void *self, const uint32_t *prim, uint32_t count)
{
    const struct small_making *m = self;
    return m->form->words(m->tree, m->scene, prim, count) ? 1.0f : INFINITY;
}

static uint64_t count_words(const struct small_making *m)
{
    uint64_t words = 0;
    for (uint32_t i = 0; i < m->wide->child_count; i++) {
        const struct wide_child *child = &m->wide->child[i];
        if (child->count)
            words += m->form->words(m->tree, m->scene, m->bvh->prim + child->first, child->count);
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
    const uint32_t *prim = m->bvh->prim + child->first, first = (uint32_t)m->tree->block_words;
    m->form->write(m->tree, m->scene, prim, child->count, m->tree->block + first);
    m->tree->block_words += m->form->words(m->tree, m->scene, prim, child->count);
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
    const char *engine = m->form->engine;
    if (wide->stack_need > FAST_STACK)
        return fail(reason, STATUS_LIMIT,
                    "%s: the traversal stack holds %u entries, this tree needs %u; use another "
                    "builder",
                    engine, FAST_STACK, wide->stack_need);
    if (words > WORDS_MOST)
        return fail(reason, STATUS_LIMIT, "%s: leaves of %llu MB, at most %u MB fit", engine,
                    (unsigned long long)(words >> 18), WORDS_MOST >> 18);
    tree->block = frame_pages((words + TINY_BEYOND) * sizeof *tree->block);
    tree->small = frame_pages(wide->node_count * sizeof *tree->small);
    if (!tree->block || !tree->small)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u nodes", engine, wide->node_count);
    frame_set(tree, &wide->bounds);
    tree->node_count = wide->node_count;
    tree->stack_need = wide->stack_need;
    for (uint32_t i = 0; i < wide->node_count; i++)
        fill_node(m, i);
    tree->in_stream = true;
    tree->in_pairs = fast_bytes(tree) >> 20 >= FAST_PAIRS;
    return STATUS_OK;
}

/* Makes a tree of a form, whose own part of *out has been set. */
static enum status make(const struct bvh *bvh, const struct scene *scene,
                        const struct leaf_form *form, struct fast_tree *out, struct reason *reason)
{
    struct wide_tree wide;
    struct small_making m = {out, &wide, bvh, scene, form};
    const struct wide_rule rule = {.width = FAST_WIDTH,
                                   .leaf_most = form->tris,
                                   .node_cost = 1,
                                   .leaf_cost = leaf_cost,
                                   .self = &m};
    enum status status = wide_tree_make(bvh, scene, &rule, &wide, reason);
    if (!status && wide.node_count > 0)
        status = fill(&m, reason);
    wide_tree_free(&wide);
    if (status)
        fast_free(out);
    return status;
}

enum status fast_make_small(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                            struct reason *reason)
{
    *out = (struct fast_tree){.node = NULL};
    return make(bvh, scene, &small_form, out, reason);
}

enum status fast_make_tiny(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                           struct reason *reason)
{
    struct reason why = {""};
    *out = (struct fast_tree){.is_tiny = true};
    if (tiny_form_make(scene, &out->tiny, &why)) {
        *out = (struct fast_tree){.node = NULL};
        return fail(reason, STATUS_UNSUPPORTED, "fast_small: %.200s", why.text);
    }
    return make(bvh, scene, &tiny_form, out, reason);
}
