#include "ref/dual/dual.h"

#include "ref/dual/dual_cost.h"
#include "ref/packed/packed_walk.h"

#include <stdlib.h>

/* A node of the packed tree. Leaves have a count. */
struct dual_source {
    struct dual_part part;
    uint32_t child[2];
    uint32_t first, count;
};

struct dual_making {
    struct dual_source
        *source; /* one for each visit of a walk: children come after their parents */
    struct dual_tree *out;
    size_t room; /* words of out->word */
    bool carves_all;
};

/* --- the packed tree -------------------------------------------------------------------------- */

/* Boxes and work from the leaves up. Work is summed as cost * area: a child is met by as many of
 * the rays that meet its parent as its box has of the parent's area. */
static void sum_up(struct dual_source *source, const struct packed_walk *walk)
{
    for (uint32_t i = walk->visit_count; i-- > 0;) {
        struct dual_source *s = &source[i];
        double area = 0, below = 0;
        if (s->count > 0) {
            s->part.cost = DUAL_COST_TRI * s->count;
            continue;
        }
        const struct dual_part *fst = &source[s->child[0]].part, *snd = &source[s->child[1]].part;
        box_add_box(&s->part.box, &fst->box);
        box_add_box(&s->part.box, &snd->box);
        area = box_half_area_or_none(&s->part.box);
        below = dual_work(fst, &fst->box) + dual_work(snd, &snd->box);
        s->part.cost = DUAL_COST_STEP + (area > 0 ? below / area : fst->cost + snd->cost);
    }
}

static enum status take_nodes(const struct packed *packed, const struct packed_walk *walk,
                              struct dual_source *source, struct reason *reason)
{
    for (uint32_t i = 0; i < walk->visit_count; i++) {
        struct wide node;
        packed->layout->load(packed, walk->visit[i].ref, &node);
        source[i].part.box = walk->visit[i].box;
        if (node.child_count == 0) {
            source[i].first = node.item_first;
            source[i].count = node.item_count;
        }
        if (source[i].count >= DUAL_COUNT_MOST)
            return fail(reason, STATUS_LIMIT,
                        "a dual-split tree has at most %u items a leaf, not "
                        "%u",
                        DUAL_COUNT_MOST - 1, source[i].count);
        if (i > 0) { /* the first that is reached is the first child */
            struct dual_source *parent = &source[walk->visit[i].parent];
            parent->child[parent->child[0] ? 1 : 0] = i;
        }
    }
    sum_up(source, walk);
    return STATUS_OK;
}

/* --- words ------------------------------------------------------------------------------------ */

static enum status put(struct dual_making *m, uint32_t count, const uint32_t *word)
{
    struct dual_tree *out = m->out;
    size_t need = (size_t)out->word_count + count;
    if (need > DUAL_WORDS_MOST)
        return STATUS_LIMIT;
    if (array_reserve(&out->word, &m->room, need, sizeof *out->word))
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < count; i++)
        out->word[out->word_count++] = word[i];
    return STATUS_OK;
}

static enum status put_carves(struct dual_making *m, const struct dual_source *s, struct box *in)
{
    struct dual_carve carve;
    enum status status = STATUS_OK;
    while (!status && dual_carve_find(&s->part, m->carves_all, in, &carve)) {
        const uint32_t word[] = {DUAL_OTHER | DUAL_CARVES | carve.side[0] << 3 | carve.side[1] << 6,
                                 float_bits(carve.at[0]), float_bits(carve.at[1])};
        status = put(m, DUAL_NODE_WORDS, word);
        m->out->carve_count++;
    }
    return status;
}

/* Writes a node that is met in its implied box, and all below it. */
static enum status put_node(struct dual_making *m, const struct dual_source *s, struct box in,
                            uint32_t depth)
{
    enum status status = put_carves(m, s, &in);
    if (status)
        return status;
    if (s->count > 0) {
        const uint32_t leaf[] = {DUAL_OTHER | s->count << DUAL_COUNT_SHIFT, s->first};
        m->out->leaf_count++;
        m->out->depth = depth > m->out->depth ? depth : m->out->depth;
        return put(m, DUAL_LEAF_WORDS, leaf);
    }
    if (depth == DUAL_DEPTH_MOST)
        return STATUS_LIMIT;
    const struct dual_source *lower = &m->source[s->child[0]], *upper = &m->source[s->child[1]];
    const struct dual_split split = dual_split_find(&lower->part, &upper->part, &in);
    if (split.swapped) {
        lower = &m->source[s->child[1]];
        upper = &m->source[s->child[0]];
    }
    struct box below = in, above = in;
    below.hi[split.axis] = lower->part.box.hi[split.axis];
    above.lo[split.axis] = upper->part.box.lo[split.axis];
    const uint32_t at = m->out->word_count, word[] = {split.axis, float_bits(below.hi[split.axis]),
                                                      float_bits(above.lo[split.axis])};
    status = put(m, DUAL_NODE_WORDS, word);
    m->out->split_count++;
    if (!status)
        status = put_node(m, lower, below, depth + 1);
    if (!status)
        m->out->word[at] |= m->out->word_count << DUAL_SHIFT;
    return status ? status : put_node(m, upper, above, depth + 1);
}

static enum status failed(enum status status, const struct packed *packed, struct reason *reason)
{
    if (status == STATUS_MEMORY)
        return fail(reason, status, "no memory for a dual-split tree of %u records",
                    packed->node_count);
    return fail(reason, status,
                "a dual-split tree has at most %u levels and %u words, which %u records exceed",
                DUAL_DEPTH_MOST, DUAL_WORDS_MOST, packed->node_count);
}

static enum status make(const struct packed *packed, const struct packed_walk *walk,
                        struct dual_making *m, struct reason *reason)
{
    if (walk->repeats > 0 || walk->bad_refs > 0)
        return fail(reason, STATUS_LIMIT, "%s: record %u %s: a dual-split tree is made of a tree",
                    packed->layout->name, walk->repeats > 0 ? walk->repeat_ref : walk->bad_ref,
                    walk->repeats > 0 ? "is reached more than once" : "lacks a child");
    m->source = alloc_zeroed(walk->visit_count, sizeof *m->source);
    if (!m->source)
        return failed(STATUS_MEMORY, packed, reason);
    enum status status = take_nodes(packed, walk, m->source, reason);
    if (status)
        return status;
    m->out->box = m->source[0].part.box;
    status = put_node(m, m->source, m->out->box, 0);
    return status ? failed(status, packed, reason) : STATUS_OK;
}

enum status dual_make(const struct packed *packed, enum dual_carving carving, struct dual_tree *out,
                      struct reason *reason)
{
    struct packed_walk walk;
    struct dual_making m = {.out = out, .carves_all = carving == DUAL_ALL};
    *out = (struct dual_tree){0};
    if (packed->node_count == 0)
        return STATUS_OK;
    if (layout_is_wide(packed->layout))
        return fail(reason, STATUS_UNSUPPORTED, "%s: a dual-split tree needs a binary layout",
                    packed->layout->name);
    if (packed_walk_make(packed, &walk))
        return failed(STATUS_MEMORY, packed, reason);
    enum status status = make(packed, &walk, &m, reason);
    packed_walk_free(&walk);
    free(m.source);
    if (status)
        dual_free(out);
    return status;
}

void dual_free(struct dual_tree *tree)
{
    free(tree->word);
    *tree = (struct dual_tree){0};
}
