#include "ref/tree/bvh.h"

#include "ref/tree/cover.h"

#include <stdlib.h>
#include <string.h>

void bvh_free(struct bvh *bvh)
{
    free(bvh->node);
    free(bvh->prim);
    *bvh = (struct bvh){0};
}

bool bvh_items_differ(const struct bvh *bvh, uint32_t first, uint32_t count)
{
    for (uint32_t i = 1; i < count && bvh_is_split(bvh); i++)
        for (uint32_t k = 0; k < i; k++)
            if (bvh->prim[first + k] == bvh->prim[first + i])
                return false;
    return true;
}

static bool is_leaf(const struct bvh_node *node)
{
    return node->item_count > 0;
}

/* Children come after their parent, so one pass backwards is enough. */
struct box *bvh_exact_bounds(const struct bvh *bvh, const struct scene *scene)
{
    struct box *exact = alloc_zeroed(bvh->node_count, sizeof *exact);
    if (!exact)
        return NULL;
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        exact[i] = box_empty();
        for (uint32_t k = 0; k < node->item_count; k++) {
            struct box one = scene_tri_bounds(scene, bvh->prim[node->item_first + k]);
            box_add_box(&exact[i], &one);
        }
        if (!is_leaf(node)) {
            box_add_box(&exact[i], &exact[node->fst]);
            box_add_box(&exact[i], &exact[node->snd]);
        }
    }
    return exact;
}

/* Runs cover_check on a well-formed tree. */
static enum status check_cover(const struct bvh *bvh, const struct scene *scene,
                               struct cover_faults *out)
{
    *out = (struct cover_faults){0};
    struct cover_node *node = alloc_zeroed(bvh->node_count, sizeof *node);
    if (!node)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *from = &bvh->node[i];
        node[i].box = from->bounds;
        node[i].item_first = from->item_first;
        node[i].item_count = from->item_count;
        if (!is_leaf(from))
            node[from->fst].parent = node[from->snd].parent = i;
    }
    const struct cover_tree tree = {node, bvh->prim, bvh->node_count};
    enum status status = cover_check(&tree, scene, out);
    free(node);
    return status;
}

/* Counts with the exact bounds of each node, and a zero for each as its depth. */
static void count_into(const struct bvh *bvh, const struct box *exact, uint32_t *depth,
                       struct bvh_stats *out)
{
    const bool split = bvh_is_split(bvh);
    out->node_count = bvh->node_count;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        if (depth[i] > out->depth)
            out->depth = depth[i];
        if (node->item_count > out->largest_leaf)
            out->largest_leaf = node->item_count;
        if (is_leaf(node)) {
            out->leaf_count++;
            continue;
        }
        depth[node->fst] = depth[node->snd] = depth[i] + 1;
        if (!split && !box_contains_box(&node->bounds, &exact[i]))
            out->loose_count++;
    }
}

enum status bvh_count(const struct bvh *bvh, const struct scene *scene, struct bvh_stats *out,
                      struct reason *reason)
{
    struct cover_faults cover = {0};
    struct box *exact = bvh_exact_bounds(bvh, scene);
    uint32_t *depth = alloc_zeroed(bvh->node_count, sizeof *depth);
    enum status status = exact && depth ? STATUS_OK : STATUS_MEMORY;
    *out = (struct bvh_stats){0};
    if (!status && bvh_is_split(bvh))
        status = check_cover(bvh, scene, &cover);
    if (!status) {
        count_into(bvh, exact, depth, out);
        out->loose_count += cover.prims;
    } else {
        (void)fail(reason, status, "no memory to count the nodes of a tree");
    }
    free(exact);
    free(depth);
    return status;
}

/* Checks the triangles of a leaf; seen[prim] is 0, or 1 plus the last leaf that listed it. */
static enum status check_leaf(const struct bvh *bvh, uint32_t leaf, uint32_t *seen,
                              struct reason *reason)
{
    const struct bvh_node *node = &bvh->node[leaf];
    for (uint32_t i = node->item_first; i < node->item_first + node->item_count; i++) {
        uint32_t prim = bvh->prim[i];
        if (prim >= bvh->tri_count)
            return fail(reason, STATUS_INPUT, "tree item %u: triangle %u, but the scene has %u", i,
                        prim, bvh->tri_count);
        if (seen[prim] && (!bvh_is_split(bvh) || seen[prim] == leaf + 1))
            return fail(reason, STATUS_INPUT, "tree item %u: triangle %u is there twice", i, prim);
        seen[prim] = leaf + 1;
    }
    return STATUS_OK;
}

/* Checks the triangles of the leaves: consecutive ranges of prim, which contains every triangle. */
static enum status check_items(const struct bvh *bvh, uint32_t *seen, struct reason *reason)
{
    uint32_t emitted = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        if (node->item_first != emitted)
            return fail(reason, STATUS_INPUT,
                        "tree node %u: first item is %u, but %u items come before it", i,
                        node->item_first, emitted);
        if (node->item_count > bvh->prim_count - emitted)
            return fail(reason, STATUS_INPUT,
                        "tree node %u: items %u to %llu, but the tree has %u items", i, emitted,
                        (unsigned long long)emitted + node->item_count - 1, bvh->prim_count);
        emitted += node->item_count;
    }
    if (emitted != bvh->prim_count)
        return fail(reason, STATUS_INPUT, "the tree's leaves hold %u of its %u items", emitted,
                    bvh->prim_count);
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < bvh->node_count && !status; i++)
        status = check_leaf(bvh, i, seen, reason);
    for (uint32_t prim = 0; prim < bvh->tri_count && !status; prim++)
        if (!seen[prim])
            status = fail(reason, STATUS_INPUT, "triangle %u is in no leaf of the tree", prim);
    return status;
}

/* Checks the nodes from the last to the first; end[i] becomes the index after i's subtree. */
static enum status check_nodes(const struct bvh *bvh, uint32_t *end, struct reason *reason)
{
    uint32_t count = bvh->node_count;
    for (uint32_t i = count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        if (is_leaf(node)) {
            if (node->fst != 0 || node->snd != 0)
                return fail(reason, STATUS_INPUT, "tree node %u: a leaf with children %u and %u", i,
                            node->fst, node->snd);
            end[i] = i + 1;
            continue;
        }
        if (i + 1 >= count || node->fst != i + 1)
            return fail(reason, STATUS_INPUT,
                        "tree node %u: first child is %u, must be the next of %u nodes", i,
                        node->fst, count);
        if (end[i + 1] >= count || node->snd != end[i + 1])
            return fail(reason, STATUS_INPUT,
                        "tree node %u: second child is %u, must be node %u of %u, the first after "
                        "the first child's subtree",
                        i, node->snd, end[i + 1], count);
        end[i] = end[node->snd];
    }
    if (end[0] != count)
        return fail(reason, STATUS_INPUT, "tree node %u: not reached from the root", end[0]);
    return STATUS_OK;
}

enum status bvh_check_form(const struct bvh *bvh, const struct scene *scene, struct reason *reason)
{
    if (bvh->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "the tree holds %u triangles, the scene has %u",
                    bvh->tri_count, scene->tri_count);
    if (bvh->prim_count < bvh->tri_count)
        return fail(reason, STATUS_INPUT, "the tree holds %u items for %u triangles",
                    bvh->prim_count, bvh->tri_count);
    if (bvh->node_count == 0)
        return bvh->prim_count == 0
                   ? STATUS_OK
                   : fail(reason, STATUS_INPUT, "the tree has no node for %u triangles",
                          bvh->prim_count);
    uint32_t *end = alloc_zeroed(bvh->node_count, sizeof *end);
    uint32_t *seen = alloc_zeroed(bvh->tri_count, sizeof *seen);
    enum status status = STATUS_MEMORY;
    if (!end || !seen)
        (void)fail(reason, status, "no memory to check a tree of %u nodes", bvh->node_count);
    else if ((status = check_nodes(bvh, end, reason)) == STATUS_OK)
        status = check_items(bvh, seen, reason);
    free(end);
    free(seen);
    return status;
}

static enum status check_split(const struct bvh *bvh, const struct scene *scene,
                               struct reason *reason)
{
    struct cover_faults cover;
    if (check_cover(bvh, scene, &cover))
        return fail(reason, STATUS_MEMORY, "no memory to check a tree of %u nodes",
                    bvh->node_count);
    if (cover.prims)
        return fail(reason, STATUS_INPUT,
                    "tree node %u: a part of triangle %u is in no leaf's box below; %u triangles "
                    "have such parts",
                    cover.node, cover.prim, cover.prims);
    return STATUS_OK;
}

enum status bvh_check(const struct bvh *bvh, const struct scene *scene, struct reason *reason)
{
    enum status status = bvh_check_form(bvh, scene, reason);
    if (status)
        return status;
    if (bvh_is_split(bvh))
        return check_split(bvh, scene, reason);
    struct box *exact = bvh_exact_bounds(bvh, scene);
    if (!exact)
        return fail(reason, STATUS_MEMORY, "no memory to check a tree of %u nodes",
                    bvh->node_count);
    for (uint32_t i = 0; i < bvh->node_count && !status; i++) {
        const struct box *box = &bvh->node[i].bounds;
        for (int k = 0; k < 3 && !status; k++)
            if (!(box->lo[k] <= exact[i].lo[k] && exact[i].hi[k] <= box->hi[k]))
                status = fail(reason, STATUS_INPUT,
                              "tree node %u: %c bounds [%a, %a] do not contain its triangles' "
                              "[%a, %a]",
                              i, "xyz"[k], (double)box -> lo[k], (double)box -> hi[k],
                              (double)exact[i].lo[k], (double)exact[i].hi[k]);
    }
    free(exact);
    return status;
}
