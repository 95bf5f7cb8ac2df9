#include "ref/dual/dual.h"

#include "ref/dual/dual_cost.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdlib.h>

/* A leaf of the packed tree. */
struct dual_known {
    struct wide node;
    struct box box;
    bool found;
};

struct dual_checking {
    const struct dual_tree *tree;
    const struct packed *packed;
    const struct scene *scene;
    struct dual_known *known; /* by the first item */
    uint32_t known_count;
    uint32_t at; /* the next word */
    uint32_t splits, carves, leaves, depth;
    struct reason *reason;
};

static int by_first(const void *a, const void *b)
{
    const struct dual_known *x = a, *y = b;
    return order_numbers(x->node.item_first, y->node.item_first);
}

static enum status find_leaves(struct dual_checking *c)
{
    struct packed_walk walk;
    if (packed_walk_make(c->packed, &walk))
        return fail(c->reason, STATUS_MEMORY, "no memory to check a dual-split tree");
    c->known = alloc_zeroed(walk.visit_count, sizeof *c->known);
    for (uint32_t i = 0; i < walk.visit_count && c->known; i++) {
        struct dual_known *leaf = &c->known[c->known_count];
        c->packed->layout->load(c->packed, walk.visit[i].ref, &leaf->node);
        leaf->box = walk.visit[i].box;
        c->known_count += leaf->node.child_count == 0;
    }
    packed_walk_free(&walk);
    if (!c->known)
        return fail(c->reason, STATUS_MEMORY, "no memory to check a dual-split tree");
    qsort(c->known, c->known_count, sizeof *c->known, by_first);
    return STATUS_OK;
}

static enum status bad(const struct dual_checking *c, uint32_t word, const char *rule)
{
    return fail(c->reason, STATUS_INPUT, "dual-split tree: word %u: %s", word, rule);
}

static enum status check_leaf(struct dual_checking *c, const struct box *in, uint32_t depth)
{
    const uint32_t at = c->at, *word = c->tree->word + at;
    const struct dual_known key = {.node = {.item_first = word[1]}};
    struct dual_known *leaf = bsearch(&key, c->known, c->known_count, sizeof *c->known, by_first);
    c->leaves++;
    c->depth = depth > c->depth ? depth : c->depth;
    c->at += DUAL_LEAF_WORDS;
    if (!leaf || leaf->found || leaf->node.item_count != word[0] >> DUAL_COUNT_SHIFT)
        return bad(c, at, "no leaf of the packed tree, or one that was there before");
    leaf->found = true;
    if (!box_contains_box(in, &leaf->box))
        return bad(c, at, "a leaf's box is not in its implied box");
    for (uint32_t i = 0; i < leaf->node.item_count && !c->packed->split; i++) {
        uint32_t prim = packed_item(c->packed, &leaf->node, i);
        if (prim >= c->scene->tri_count)
            continue; /* an empty slot */
        const struct box tri = scene_tri_bounds(c->scene, prim);
        if (!box_contains_box(in, &tri))
            return bad(c, at, "a triangle is not in the implied box of its leaf");
    }
    return STATUS_OK;
}

/* What a plane leaves of a box. */
static void cut_box(struct box *in, uint32_t side, uint32_t word)
{
    const float at = float_from_bits(word);
    float *bound = dual_side(in, side);
    if (side < 3 ? at > *bound : at < *bound)
        *bound = at;
}

/* Goes through the carvings before the next node; `in` becomes what they leave. */
static enum status check_carvings(struct dual_checking *c, struct box *in)
{
    const struct dual_tree *tree = c->tree;
    while (tree->word_count - c->at >= DUAL_NODE_WORDS) {
        const uint32_t *word = tree->word + c->at;
        const uint32_t first = word[0] >> 3 & 7u, second = word[0] >> 6 & 7u;
        if ((word[0] & 7u) != (DUAL_OTHER | DUAL_CARVES))
            break;
        if (first >= DUAL_SIDES || second >= DUAL_SIDES || word[0] >> 9)
            return bad(c, c->at, "a carving has no such side");
        cut_box(in, first, word[1]);
        cut_box(in, second, word[2]);
        c->carves++;
        c->at += DUAL_NODE_WORDS;
    }
    return STATUS_OK;
}

/* Checks the node at the next word and all below it. */
static enum status check_node(struct dual_checking *c, struct box in, uint32_t depth)
{
    const struct dual_tree *tree = c->tree;
    if (check_carvings(c, &in))
        return STATUS_INPUT;
    const uint32_t at = c->at, left = tree->word_count - at, *word = tree->word + at;
    if (left < DUAL_LEAF_WORDS)
        return bad(c, at, "a node begins where the words end");
    if ((word[0] & 7u) == DUAL_OTHER)
        return check_leaf(c, &in, depth);
    if (left < DUAL_NODE_WORDS || (word[0] & 3u) == DUAL_OTHER)
        return bad(c, at, "a node begins where the words end");
    if (depth == DUAL_DEPTH_MOST)
        return bad(c, at, "too many splits above it");
    struct box below = in, above = in;
    c->at += DUAL_NODE_WORDS;
    c->splits++;
    cut_box(&below, 3 + (word[0] & 3u), word[1]);
    cut_box(&above, word[0] & 3u, word[2]);
    enum status status = check_node(c, below, depth + 1);
    if (!status && c->at != word[0] >> DUAL_SHIFT)
        return bad(c, at, "its upper child is not behind its lower one");
    return status ? status : check_node(c, above, depth + 1);
}

static enum status check_words(struct dual_checking *c)
{
    const struct dual_tree *tree = c->tree;
    enum status status = check_node(c, tree->box, 0);
    if (status)
        return status;
    if (c->at != tree->word_count)
        return bad(c, c->at, "words behind the last node");
    if (c->leaves != c->known_count)
        return bad(c, c->at, "a leaf of the packed tree is missing");
    if (c->splits != tree->split_count || c->carves != tree->carve_count ||
        c->leaves != tree->leaf_count || c->depth != tree->depth)
        return bad(c, c->at, "the counts are not those of the words");
    return STATUS_OK;
}

enum status dual_check(const struct dual_tree *tree, const struct packed *packed,
                       const struct scene *scene, struct reason *reason)
{
    struct dual_checking c = {.tree = tree, .packed = packed, .scene = scene, .reason = reason};
    if (tree->word_count == 0)
        return packed->node_count == 0 ? STATUS_OK : bad(&c, 0, "an empty tree of a scene");
    enum status status = find_leaves(&c);
    if (!status)
        status = check_words(&c);
    free(c.known);
    return status;
}
