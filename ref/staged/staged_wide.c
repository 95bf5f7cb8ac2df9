#include "ref/staged/staged_wide.h"

#include "ref/base/text.h"
#include "ref/staged/staged_inner.h"

#include <stdio.h>
#include <stdlib.h>

uint32_t staged_wide_nodes_most(uint32_t count, uint32_t width, uint32_t leaf_most)
{
    uint32_t lowest = leaf_most < width - 1 ? count / (leaf_most + 1) : 0;
    if (count == 0)
        return 0;
    uint32_t most = lowest + (count - 1 - leaf_most * lowest) / (width - 1);
    return most > 1 ? most : 1;
}

enum status staged_wide_alloc(uint32_t nodes, uint32_t children, uint32_t items,
                              struct staged_wide *out)
{
    *out = (struct staged_wide){.node_count = nodes, .child_count = children, .item_count = items};
    if (nodes == 0)
        return STATUS_OK;
    out->node = alloc_zeroed(nodes, sizeof *out->node);
    out->child = alloc_zeroed(children, sizeof *out->child);
    out->item = alloc_zeroed(items, sizeof *out->item);
    if (out->node && out->child && out->item)
        return STATUS_OK;
    staged_wide_free(out);
    return STATUS_MEMORY;
}

void staged_wide_free(struct staged_wide *wide)
{
    free(wide->node);
    free(wide->child);
    free(wide->item);
    *wide = (struct staged_wide){0};
}

/* --- the collapse ----------------------------------------------------------------------------- */

struct wide_job {
    const struct staged *staged;
    struct staged_frame frame;
    uint32_t width, leaf_most;
    uint32_t *size;  /* triangles of each inner node's subtree */
    uint32_t *stack; /* links */
    uint32_t *root;  /* of each wide node: its subtree's link */
    struct staged_wide *out;
};

static uint32_t size_of(const struct wide_job *job, uint32_t link)
{
    return link & STAGED_LEAF ? 1 : job->size[link];
}

/* Goes through a subtree, first halves first. Appends its triangles to `item`, if that is not NULL,
 * and its inner nodes, each before those below it, to `node`, likewise. Returns their numbers. */
static uint32_t walk(const struct wide_job *job, uint32_t link, uint32_t *item, uint32_t *node)
{
    const struct staged *staged = job->staged;
    uint32_t open = 0, items = 0, nodes = 0;
    job->stack[open++] = link;
    while (open > 0) {
        link = job->stack[--open];
        if (link & STAGED_LEAF) {
            if (item)
                item[items] = staged->order[link & ~STAGED_LEAF];
            items++;
            continue;
        }
        if (node)
            node[nodes++] = link;
        job->stack[open++] = staged->child[link][1];
        job->stack[open++] = staged->child[link][0];
    }
    return item ? items : nodes;
}

/* Half the area of a link's box. */
static int64_t area_of(const struct wide_job *job, uint32_t link)
{
    const uint32_t *box = staged_box(job->staged, link);
    int64_t side[3];
    for (int k = 0; k < 3; k++)
        side[k] = (int64_t)frame_coordinate(&job->frame, float_from_bits(box[3 + k])) -
                  frame_coordinate(&job->frame, float_from_bits(box[k]));
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* The slot to be opened next; `count`: none. */
static uint32_t largest(const struct wide_job *job, const uint32_t *slot, uint32_t count)
{
    uint32_t best = count;
    int64_t most = -1;
    for (uint32_t s = 0; s < count; s++) {
        if (size_of(job, slot[s]) <= job->leaf_most)
            continue;
        int64_t area = area_of(job, slot[s]);
        best = area > most ? s : best;
        most = area > most ? area : most;
    }
    return best;
}

/* Returns the number of slots of a subtree's node. */
static uint32_t open_slots(const struct wide_job *job, uint32_t link, uint32_t *slot)
{
    uint32_t count = 1, at = size_of(job, link) > job->leaf_most ? 0 : 1;
    slot[0] = link;
    while (at < count) {
        const uint32_t *half = job->staged->child[slot[at]];
        for (uint32_t s = count++; s > at + 1; s--)
            slot[s] = slot[s - 1];
        slot[at] = half[0];
        slot[at + 1] = half[1];
        at = count < job->width ? largest(job, slot, count) : count;
    }
    return count;
}

static void add_node(struct wide_job *job, uint32_t n)
{
    struct staged_wide *out = job->out;
    uint32_t slot[WIDE_TREE_MOST], count = open_slots(job, job->root[n], slot);
    out->node[n] = (struct wide_node){out->child_count, count};
    for (uint32_t s = 0; s < count; s++) {
        const uint32_t size = size_of(job, slot[s]);
        struct staged_child *child = &out->child[out->child_count++];
        if (size > job->leaf_most) {
            *child = (struct staged_child){slot[s], out->node_count, 0};
            job->root[out->node_count++] = slot[s];
        } else {
            *child = (struct staged_child){slot[s], out->item_count, size};
            out->item_count += walk(job, slot[s], out->item + out->item_count, NULL);
        }
    }
}

static void find_sizes(struct wide_job *job)
{
    /* The places of the roots are still free for the nodes in pre-order. */
    uint32_t nodes = walk(job, job->staged->root, NULL, job->root);
    while (nodes-- > 0) {
        const uint32_t at = job->root[nodes], *half = job->staged->child[at];
        job->size[at] = size_of(job, half[0]) + size_of(job, half[1]);
    }
}

static void collapse(struct wide_job *job)
{
    struct staged_wide *out = job->out;
    find_sizes(job);
    job->root[0] = job->staged->root;
    out->node_count = 1;
    out->child_count = out->item_count = 0;
    for (uint32_t n = 0; n < out->node_count; n++)
        add_node(job, n);
}

enum status staged_wide_make(const struct staged *staged, uint32_t width, uint32_t leaf_most,
                             struct staged_wide *out)
{
    const uint32_t n = staged->count, most = staged_wide_nodes_most(n, width, leaf_most);
    struct wide_job job = {.staged = staged, .width = width, .leaf_most = leaf_most, .out = out};
    *out = (struct staged_wide){0};
    if (n == 0)
        return STATUS_OK;
    job.frame = staged_frame_of(staged_box(staged, staged->root));
    job.size = alloc_zeroed(n, sizeof *job.size);
    job.stack = alloc_zeroed((size_t)n + 1, sizeof *job.stack);
    job.root = alloc_zeroed(n, sizeof *job.root);
    /* Every child is a leaf, which has an item, or a node. */
    enum status status = job.size && job.stack && job.root ? STATUS_OK : STATUS_MEMORY;
    if (!status)
        status = staged_wide_alloc(most, n + most, n, out);
    if (!status)
        collapse(&job);
    free(job.size);
    free(job.stack);
    free(job.root);
    return status;
}

/* --- what is made of it ----------------------------------------------------------------------- */

enum status staged_wide_tree(const struct staged_wide *wide, const struct staged *staged,
                             struct wide_tree *out)
{
    *out = (struct wide_tree){0};
    if (wide->node_count == 0)
        return STATUS_OK;
    uint32_t *waiting = alloc_zeroed(wide->node_count, sizeof *waiting);
    out->node = alloc_copy(wide->node, wide->node_count, sizeof *out->node);
    out->child = alloc_zeroed(wide->child_count, sizeof *out->child);
    if (!waiting || !out->node || !out->child) {
        free(waiting);
        wide_tree_free(out);
        return STATUS_MEMORY;
    }
    out->node_count = wide->node_count;
    out->child_count = wide->child_count;
    out->bounds = staged_box_of(staged, staged->root);
    for (uint32_t n = 0; n < wide->node_count; n++) {
        const struct wide_node *node = &wide->node[n];
        waiting[n] += node->count - 1;
        out->stack_need = waiting[n] > out->stack_need ? waiting[n] : out->stack_need;
        for (uint32_t c = node->first; c < node->first + node->count; c++) {
            const struct staged_child *child = &wide->child[c];
            out->child[c] =
                (struct wide_child){staged_box_of(staged, child->link), child->first, child->count};
            if (child->count == 0)
                waiting[child->first] = waiting[n];
        }
    }
    free(waiting);
    return STATUS_OK;
}

static void tell(const struct staged_wide *wide, int stage, uint32_t i, char *text, size_t bytes)
{
    const struct staged_child *child = &wide->child[i];
    if (stage == 0)
        text_append(text, bytes, "%u children from %u", wide->node[i].count, wide->node[i].first);
    else if (stage == 2)
        text_append(text, bytes, "triangle %u", wide->item[i]);
    else if (child->count == 0)
        text_append(text, bytes, "node %u", child->first);
    else
        text_append(text, bytes, "items %u from %u", child->count, child->first);
    if (stage == 1)
        text_append(text, bytes, " of %s %u", child->link & STAGED_LEAF ? "leaf" : "node",
                    child->link & ~STAGED_LEAF);
}

struct staged_difference staged_wide_compare(const struct staged_wide *mine,
                                             const struct staged_wide *other)
{
    const struct {
        const char *name;
        const void *mine, *other;
        size_t bytes;
        uint32_t count[2];
    } stages[] = {
        {"nodes",
         mine->node,
         other->node,
         sizeof *mine->node,
         {mine->node_count, other->node_count}},
        {"children",
         mine->child,
         other->child,
         sizeof *mine->child,
         {mine->child_count, other->child_count}},
        {"items",
         mine->item,
         other->item,
         sizeof *mine->item,
         {mine->item_count, other->item_count}},
    };
    struct staged_difference at = {0};
    for (int s = 0; s < (int)ARRAY_COUNT(stages); s++) {
        const uint32_t *count = stages[s].count, both = count[count[1] < count[0]];
        uint32_t more = count[0] + count[1] - 2 * both;
        at.element =
            staged_differing(stages[s].mine, stages[s].other, stages[s].bytes, both, &at.count);
        if (at.count == 0 && more == 0)
            continue;
        at.stage = stages[s].name;
        if (at.count > 0) {
            char text[2][72] = {"", ""};
            tell(mine, s, at.element, text[0], sizeof text[0]);
            tell(other, s, at.element, text[1], sizeof text[1]);
            snprintf(at.text, sizeof at.text, "%s, not %s", text[0], text[1]);
        } else {
            snprintf(at.text, sizeof at.text, "%u of them, not %u", count[0], count[1]);
        }
        at.count += more;
        return at;
    }
    return (struct staged_difference){0};
}
