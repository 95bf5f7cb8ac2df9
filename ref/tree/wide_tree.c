#include "ref/tree/wide_tree.h"

#include <math.h>
#include <stdlib.h>

#define ITEMS_MOST ((uint32_t)1 << 30)
#define LEAST_AREA 0x1p-20f /* of the root's */

/* A node of the binary tree whose leaves are divided into single items; in pre-order. */
struct tree_part {
    struct box bounds;
    uint32_t snd; /* fst is the next part */
    uint32_t first, count;
    bool leaf; /* cheapest as a leaf, if it becomes one root */
};

struct collapse {
    const struct bvh *bvh;
    const struct scene *scene;
    const struct wide_rule *rule;
    struct tree_part *part;
    uint32_t part_count;
    float *cost; /* rule->width values per part: its cost as at most 1, 2 .. roots */
    uint32_t *todo;
    size_t todo_count, todo_capacity;
    size_t node_capacity, child_capacity;
};

/* A subtree that is to become at most `budget` roots. */
struct share {
    uint32_t part, budget;
};

static enum status put_off(struct collapse *c, uint32_t value)
{
    enum status status =
        array_reserve(&c->todo, &c->todo_capacity, c->todo_count + 1, sizeof *c->todo);
    if (!status)
        c->todo[c->todo_count++] = value;
    return status;
}

/* --- single items ---------------------------------------------------------------------------- */

static struct box within(const struct box *a, const struct box *b)
{
    struct box out;
    for (int k = 0; k < 3; k++) {
        out.lo[k] = a->lo[k] > b->lo[k] ? a->lo[k] : b->lo[k];
        out.hi[k] = a->hi[k] < b->hi[k] ? a->hi[k] : b->hi[k];
        if (out.lo[k] > out.hi[k])
            return *b; /* the leaf's box is too small for its triangles: keep it */
    }
    return out;
}

static struct box items_bounds(const struct collapse *c, uint32_t first, uint32_t count,
                               const struct box *leaf)
{
    struct box all = box_empty();
    for (uint32_t i = 0; i < count; i++) {
        struct box tri = scene_tri_bounds(c->scene, c->bvh->prim[first + i]);
        struct box kept = within(&tri, leaf);
        box_add_box(&all, &kept);
    }
    return all;
}

/* Appends the subtree of a range of a leaf, 2 count - 1 parts, and returns their number. The depth
 * is the logarithm of the range. */
static uint32_t halve(struct collapse *c, uint32_t first, uint32_t count, const struct box *leaf,
                      bool whole)
{
    uint32_t at = c->part_count++;
    struct tree_part *part = &c->part[at];
    *part = (struct tree_part){.first = first, .count = count};
    part->bounds = whole ? *leaf : items_bounds(c, first, count, leaf);
    if (count > 1) {
        halve(c, first, count / 2, leaf, false);
        part->snd = c->part_count;
        halve(c, first + count / 2, count - count / 2, leaf, false);
    }
    return c->part_count - at;
}

static enum status take_apart(struct collapse *c)
{
    const struct bvh *bvh = c->bvh;
    uint32_t *place = alloc_zeroed(bvh->node_count, sizeof *place);
    c->part = alloc_zeroed(2 * (size_t)bvh->prim_count, sizeof *c->part);
    if (!place || !c->part) {
        free(place);
        return STATUS_MEMORY;
    }
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        place[i] = c->part_count;
        if (node->item_count)
            halve(c, node->item_first, node->item_count, &node->bounds, true);
        else
            c->part[c->part_count++] = (struct tree_part){.bounds = node->bounds};
    }
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        if (node->item_count)
            continue;
        struct tree_part *part = &c->part[place[i]];
        part->snd = place[node->snd];
        part->first = c->part[place[i] + 1].first;
        part->count = c->part[place[i] + 1].count + c->part[part->snd].count;
    }
    free(place);
    return STATUS_OK;
}

/* --- costs ------------------------------------------------------------------------------------ */

static const float *cost_of(const struct collapse *c, uint32_t part)
{
    return c->cost + (size_t)part * c->rule->width - 1; /* budgets count from 1 */
}

/* Finds the cheapest way to divide `budget` roots between the two children, and the share of the
 * first. */
static float divide(const struct collapse *c, uint32_t at, uint32_t budget, uint32_t *to_fst)
{
    const float *fst = cost_of(c, at + 1);
    const float *snd = cost_of(c, c->part[at].snd);
    float best = INFINITY;
    *to_fst = 1;
    for (uint32_t k = 1; k < budget; k++) {
        float cost = fst[k] + snd[budget - k];
        if (cost < best) {
            best = cost;
            *to_fst = k;
        }
    }
    return best;
}

static float leaf_cost(const struct collapse *c, const struct tree_part *part)
{
    const struct wide_rule *rule = c->rule;
    if (part->count > rule->leaf_most ||
        (part->count > 1 && !bvh_items_differ(c->bvh, part->first, part->count)))
        return INFINITY;
    return rule->leaf_cost ? rule->leaf_cost(rule->self, c->bvh->prim + part->first, part->count)
                           : (float)part->count;
}

static void find_costs(struct collapse *c)
{
    uint32_t width = c->rule->width, to_fst;
    double root = box_half_area(&c->part[0].bounds);
    for (uint32_t at = c->part_count; at-- > 0;) {
        struct tree_part *part = &c->part[at];
        float *cost = c->cost + (size_t)at * width - 1;
        float area = (root > 0 ? (float)(box_half_area(&part->bounds) / root) : 0) + LEAST_AREA;
        float own = leaf_cost(c, part);
        cost[1] = own * area;
        part->leaf = true;
        if (part->count > 1) {
            float inner = divide(c, at, width, &to_fst) + c->rule->node_cost * area;
            /* Decoded boxes may be so much larger than the root's that both costs are infinite. */
            part->leaf = own < INFINITY && cost[1] <= inner;
            cost[1] = part->leaf ? cost[1] : inner;
        }
        for (uint32_t roots = 2; roots <= width; roots++) {
            float cheapest = part->count > 1 ? divide(c, at, roots, &to_fst) : INFINITY;
            cost[roots] = cheapest < cost[roots - 1] ? cheapest : cost[roots - 1];
        }
    }
}

/* --- the wide tree ---------------------------------------------------------------------------- */

/* Finds the roots that the children of `at` become if they have a whole node, in order. */
static uint32_t find_roots(const struct collapse *c, uint32_t at, uint32_t root[WIDE_TREE_MOST])
{
    struct share todo[WIDE_TREE_MOST + 1];
    uint32_t waiting = 0, found = 0, to_fst;
    struct share next = {at, c->rule->width};
    bool split = true;
    for (;;) {
        const float *cost = cost_of(c, next.part);
        while (!split && next.budget > 1 && cost[next.budget] == cost[next.budget - 1])
            next.budget--;
        if (next.budget > 1) {
            (void)divide(c, next.part, next.budget, &to_fst);
            todo[waiting++] = (struct share){c->part[next.part].snd, next.budget - to_fst};
            next = (struct share){next.part + 1, to_fst};
        } else {
            root[found++] = next.part;
            if (waiting == 0)
                return found;
            next = todo[--waiting];
        }
        split = false;
    }
}

static enum status add_node(struct collapse *c, struct wide_tree *tree, uint32_t *index)
{
    enum status status = array_reserve(&tree->node, &c->node_capacity, (size_t)tree->node_count + 1,
                                       sizeof *tree->node);
    if (!status)
        *index = tree->node_count++;
    return status;
}

/* Fills in node `index` from the part `at`, and queues its children. */
static enum status add_children(struct collapse *c, struct wide_tree *tree, uint32_t index,
                                uint32_t at, uint32_t waiting)
{
    uint32_t root[WIDE_TREE_MOST] = {at};
    uint32_t inner[WIDE_TREE_MOST], inner_count = 0;
    uint32_t count = c->part[at].leaf ? 1 : find_roots(c, at, root);
    enum status status = array_reserve(&tree->child, &c->child_capacity,
                                       (size_t)tree->child_count + count, sizeof *tree->child);
    tree->node[index] = (struct wide_node){tree->child_count, count};
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct tree_part *part = &c->part[root[i]];
        struct wide_child *child = &tree->child[tree->child_count++];
        *child = (struct wide_child){part->bounds, part->first, part->leaf ? part->count : 0};
        if (part->leaf)
            continue;
        status = add_node(c, tree, &child->first);
        inner[inner_count++] = root[i];
    }
    waiting += count - 1;
    if (waiting > tree->stack_need)
        tree->stack_need = waiting;
    for (uint32_t i = inner_count; i-- > 0 && !status;) {
        status = put_off(c, tree->node_count - inner_count + i);
        if (!status)
            status = put_off(c, inner[i]);
        if (!status)
            status = put_off(c, waiting);
    }
    return status;
}

static enum status emit(struct collapse *c, struct wide_tree *tree)
{
    uint32_t root = 0;
    enum status status = add_node(c, tree, &root);
    if (!status)
        status = add_children(c, tree, 0, 0, 0);
    while (!status && c->todo_count > 0) {
        const uint32_t *todo = c->todo + (c->todo_count -= 3);
        status = add_children(c, tree, todo[0], todo[1], todo[2]);
    }
    return status;
}

enum status wide_tree_make(const struct bvh *bvh, const struct scene *scene,
                           const struct wide_rule *rule, struct wide_tree *out,
                           struct reason *reason)
{
    *out = (struct wide_tree){0};
    if (bvh->node_count == 0)
        return STATUS_OK;
    if (bvh->prim_count > ITEMS_MOST)
        return fail(reason, STATUS_LIMIT, "a wide tree holds at most 2^30 items, this one has %u",
                    bvh->prim_count);
    struct collapse c = {.bvh = bvh, .scene = scene, .rule = rule};
    enum status status = take_apart(&c);
    if (!status) {
        c.cost = alloc_zeroed(c.part_count, rule->width * sizeof *c.cost);
        status = c.cost ? STATUS_OK : STATUS_MEMORY;
    }
    if (!status) {
        find_costs(&c);
        out->bounds = c.part[0].bounds;
        status = emit(&c, out);
    }
    free(c.part);
    free(c.cost);
    free(c.todo);
    if (status) {
        wide_tree_free(out);
        return fail(reason, status, "no memory to collapse a tree of %u items", bvh->prim_count);
    }
    return STATUS_OK;
}

void wide_tree_free(struct wide_tree *tree)
{
    free(tree->node);
    free(tree->child);
    *tree = (struct wide_tree){0};
}
