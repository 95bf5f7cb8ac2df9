#include "ref/explain/tree.h"

#include "ref/explain/oriented.h"
#include "ref/explain/steps.h"
#include "ref/store.h"

#include <math.h>
#include <stdlib.h>

#define HALF_LEAST_NORMAL 0x1p-14f
#define HALF_TO_ZERO      0x1p-25f /* rounding to nearest gives 0 up to here */

static bool repaired(uint32_t repairs, enum repair repair)
{
    return (repairs >> repair & 1u) != 0;
}

/* Exact bounds, parents and leaves of the tree, whose form has been checked. */
static void measure_tree(struct explain_tree *tree)
{
    const struct bvh *bvh = tree->bvh;
    for (uint32_t i = 0; i < tree->scene->tri_count; i++)
        tree->leaf[i] = EXPLAIN_NONE;
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        tree->exact[i] = box_empty();
        tree->record[i] = EXPLAIN_NONE;
        if (i == 0)
            tree->parent[i] = EXPLAIN_NONE;
        for (uint32_t k = 0; k < node->item_count; k++) {
            uint32_t prim = bvh->prim[node->item_first + k];
            struct box one = scene_tri_bounds(tree->scene, prim);
            box_add_box(&tree->exact[i], &one);
            tree->leaf[prim] = i;
        }
        if (bvh_is_split(bvh)) /* a box need not have more than it has */
            tree->exact[i] = node->bounds;
        if (node->item_count > 0)
            continue;
        tree->parent[node->fst] = tree->parent[node->snd] = i;
        if (bvh_is_split(bvh))
            continue;
        box_add_box(&tree->exact[i], &tree->exact[node->fst]);
        box_add_box(&tree->exact[i], &tree->exact[node->snd]);
    }
}

/* Takes records in pre-order, a leaf being `leaf_records` of them. True if most nodes decode as
 * the kind they are. */
static bool map_in_order(struct explain_tree *tree, uint32_t leaf_records)
{
    uint64_t at = 0;
    uint32_t alike = 0;
    for (uint32_t i = 0; i < tree->bvh->node_count; i++) {
        bool leaf = tree->bvh->node[i].item_count > 0;
        if (at >= tree->packed->node_count)
            return false;
        struct wide wide;
        tree->record[i] = (uint32_t)at;
        tree->packed->layout->load(tree->packed, (uint32_t)at, &wide);
        alike += leaf == (wide.child_count == 0);
        at += leaf ? leaf_records : 1;
    }
    return at == tree->packed->node_count && alike > tree->bvh->node_count / 2;
}

/* Follows the decoded references, the i-th child being the tree's. */
static void map_by_walking(struct explain_tree *tree)
{
    const struct bvh *bvh = tree->bvh;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        tree->record[i] = EXPLAIN_NONE;
    if (packed_ref_valid(tree->packed, tree->packed->root))
        tree->record[0] = tree->packed->root;
    for (uint32_t i = 0; i < bvh->node_count; i++) { /* children come after their parent */
        struct wide wide;
        if (bvh->node[i].item_count > 0 || tree->record[i] == EXPLAIN_NONE)
            continue;
        tree->packed->layout->load(tree->packed, tree->record[i], &wide);
        if (wide.child_count != 2)
            continue;
        tree->record[bvh->node[i].fst] = wide.child[0];
        tree->record[bvh->node[i].snd] = wide.child[1];
    }
}

static enum status map_records(struct explain_tree *tree)
{
    for (uint32_t r = 0; r < tree->packed->ref_count; r++)
        tree->node[r] = EXPLAIN_NONE;
    if (layout_is_wide(tree->packed->layout))
        return explain_map_wide(tree);
    if (!map_in_order(tree, 1) && !map_in_order(tree, 2))
        map_by_walking(tree);
    for (uint32_t i = tree->bvh->node_count; i-- > 0;)
        if (tree->record[i] != EXPLAIN_NONE)
            tree->node[tree->record[i]] = i;
    return STATUS_OK;
}

/* The triangle that slot `slot` of a tree leaf decodes to. False if its record is no leaf. */
static bool stored_item(const struct explain_tree *tree, uint32_t leaf, uint32_t slot,
                        uint32_t *prim, uint32_t *slots)
{
    struct wide wide;
    *prim = ABI_NO_PRIM;
    *slots = 0;
    if (tree->record[leaf] == EXPLAIN_NONE)
        return false;
    tree->packed->layout->load(tree->packed, tree->record[leaf], &wide);
    if (wide.child_count > 0)
        return false;
    *slots = wide.item_count;
    if (slot < wide.item_count)
        *prim = packed_item(tree->packed, &wide, slot);
    if (*prim >= tree->scene->tri_count)
        *prim = ABI_NO_PRIM;
    return true;
}

/* Statistics of slots and numbers in the whole tree. */
static void count_items(struct explain_tree *tree)
{
    uint32_t same = 0, less = 0, zeros = 0;
    for (uint32_t i = 0; i < tree->bvh->node_count; i++) {
        const struct bvh_node *node = &tree->bvh->node[i];
        for (uint32_t s = 0; s < node->item_count && s < EXPLAIN_SLOTS; s++) {
            uint32_t prim, slots, own = tree->bvh->prim[node->item_first + s];
            if (!stored_item(tree, i, s, &prim, &slots))
                break;
            tree->slot_used[s]++;
            tree->slot_lost[s] += prim == ABI_NO_PRIM;
            zeros += prim == 0;
            same += prim == own;
            less += prim != ABI_NO_PRIM && prim + 1 == own;
        }
    }
    tree->shifted = less > same;
    tree->zero_twice = zeros > 1;
}

enum status explain_tree_make(const struct scene *scene, const struct bvh *bvh,
                              const struct packed *packed, struct explain_tree *out,
                              struct reason *reason)
{
    *out = (struct explain_tree){.scene = scene, .bvh = bvh, .packed = packed};
    out->exact = alloc_zeroed(bvh->node_count, sizeof *out->exact);
    out->record = alloc_zeroed(bvh->node_count, sizeof *out->record);
    out->parent = alloc_zeroed(bvh->node_count, sizeof *out->parent);
    out->node = alloc_zeroed(packed->ref_count, sizeof *out->node);
    out->leaf = alloc_zeroed(scene->tri_count, sizeof *out->leaf);
    enum status status = STATUS_MEMORY;
    if (out->exact && out->record && out->parent && out->node && out->leaf) {
        measure_tree(out);
        status = map_records(out);
        if (!status)
            status = explain_map_oriented(out);
    }
    if (status) {
        explain_tree_free(out);
        return fail(reason, status, "no memory to compare %u records with their tree",
                    packed->node_count);
    }
    count_items(out);
    return STATUS_OK;
}

void explain_tree_free(struct explain_tree *tree)
{
    free(tree->exact);
    free(tree->record);
    free(tree->parent);
    free(tree->node);
    free(tree->leaf);
    free(tree->box);
    free(tree->oriented);
    *tree = (struct explain_tree){0};
}

/* True if `prim` has more than 15 or 16 bits and `stored` is what such a field keeps of it. A
 * stored 0 that means "empty" reads as nothing. */
static bool is_truncated(const struct explain_tree *tree, uint32_t prim, uint32_t stored)
{
    static const uint32_t bits[] = {15, 16};
    for (size_t i = 0; i < ARRAY_COUNT(bits); i++) {
        uint32_t cut = prim & ((1u << bits[i]) - 1);
        if (cut == prim)
            continue;
        if (stored == (tree->shifted && cut > 0 ? cut - 1 : cut))
            return true;
        if (stored == ABI_NO_PRIM && cut == 0)
            return true;
    }
    return false;
}

enum item_fault explain_item_fault(const struct explain_tree *tree, uint32_t leaf, uint32_t slot,
                                   uint32_t *stored)
{
    uint32_t slots, own = tree->bvh->prim[tree->bvh->node[leaf].item_first + slot];
    if (!stored_item(tree, leaf, slot, stored, &slots) || *stored == own)
        return ITEM_OK;
    if (slot >= slots)
        return ITEM_NOT_READ;
    if (is_truncated(tree, own, *stored))
        return ITEM_TRUNCATED;
    if (*stored == ABI_NO_PRIM && slot < EXPLAIN_SLOTS && tree->slot_used[slot] > 1 &&
        tree->slot_lost[slot] == tree->slot_used[slot])
        return ITEM_NOT_READ;
    if (tree->shifted && (*stored + 1 == own || (own == 0 && *stored == ABI_NO_PRIM)))
        return ITEM_SHIFTED;
    if (*stored == ABI_NO_PRIM || (*stored == 0 && tree->zero_twice))
        return ITEM_SENTINEL;
    return ITEM_OTHER;
}

enum bound_fault explain_bound_fault(float decoded, float canonical, float exact, bool upper)
{
    float inside = upper ? -1.0f : 1.0f; /* direction into the box */
    if ((canonical - exact) * inside > 0)
        return BOUND_CUT;
    if (isnan(decoded))
        return BOUND_OVERFLOW;
    if (upper ? decoded >= canonical : decoded <= canonical)
        return BOUND_OK;
    if (isinf(decoded))
        return BOUND_OVERFLOW;
    if (decoded == 0.0f && fabsf(canonical) < HALF_LEAST_NORMAL && fabsf(canonical) > HALF_TO_ZERO)
        return BOUND_FLUSHED;
    return fabs(half_steps(canonical, decoded)) <= 1.0 ? BOUND_ROUNDED : BOUND_STORED;
}

static const enum repair bound_repair[] = {
    [BOUND_OK] = REPAIR_COUNT,
    [BOUND_OVERFLOW] = REPAIR_BOX_OVERFLOW,
    [BOUND_FLUSHED] = REPAIR_BOX_FLUSHED,
    [BOUND_ROUNDED] = REPAIR_BOX_ROUNDED,
    [BOUND_STORED] = REPAIR_BOX_STORED,
    [BOUND_CUT] = REPAIR_BOX_CUT,
};

static void repair_bound(uint32_t repairs, float *decoded, float canonical, float exact, bool upper)
{
    enum bound_fault fault = explain_bound_fault(*decoded, canonical, exact, upper);
    if (fault == BOUND_OK || !repaired(repairs, bound_repair[fault]))
        return;
    *decoded = fault == BOUND_CUT ? exact : canonical;
}

/* The box of the node `ref`, whose bytes decode to `box`. */
static struct box repaired_box(const struct explain_tree *tree, uint32_t repairs, uint32_t ref,
                               struct box box)
{
    uint32_t node = tree->node[ref];
    if (node == EXPLAIN_NONE || repairs == 0)
        return box;
    const struct box *canonical = &tree->bvh->node[node].bounds, *exact = &tree->exact[node];
    for (int k = 0; k < 3; k++) {
        repair_bound(repairs, &box.lo[k], canonical->lo[k], exact->lo[k], false);
        repair_bound(repairs, &box.hi[k], canonical->hi[k], exact->hi[k], true);
    }
    return box;
}

struct box explain_box(const struct explain_tree *tree, uint32_t repairs, uint32_t ref)
{
    return repaired_box(tree, repairs, ref, tree->packed->layout->box(tree->packed, ref));
}

/* The references that the children of an inner tree node should have. */
static bool true_children(const struct explain_tree *tree, uint32_t node, uint32_t ref[2])
{
    ref[0] = tree->record[tree->bvh->node[node].fst];
    ref[1] = tree->record[tree->bvh->node[node].snd];
    return ref[0] != EXPLAIN_NONE && ref[1] != EXPLAIN_NONE;
}

/* True if a field of 15 or 16 bits cannot hold `want` and `have` is what it keeps of it. */
static bool ref_truncated(uint32_t want, uint32_t have)
{
    return (want > 0x7FFFu && have == (want & 0x7FFFu)) ||
           (want > 0xFFFFu && have == (want & 0xFFFFu));
}

static enum ref_fault ref_fault(const struct explain_tree *tree, uint32_t node,
                                const struct wide *wide)
{
    bool leaf = tree->bvh->node[node].item_count > 0;
    uint32_t want[2];
    if (layout_is_wide(tree->packed->layout))
        return REF_OK; /* records are known by what is below them */
    if (leaf)
        return wide->child_count == 0 ? REF_OK : REF_OTHER;
    if (!true_children(tree, node, want))
        return REF_OK;
    if (wide->child_count == 2 && wide->child[0] == want[0] && wide->child[1] == want[1])
        return REF_OK;
    if (wide->child_count == 0) /* the topmost bit of a reference is the mark of a leaf */
        return want[0] > 0x7FFFu || want[1] > 0x7FFFu ? REF_TRUNCATED : REF_OTHER;
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t c = 0; c < wide->child_count; c++)
            if (ref_truncated(want[i], wide->child[c]))
                return REF_TRUNCATED;
    return REF_OTHER;
}

enum ref_fault explain_ref_fault(const struct explain_tree *tree, uint32_t node)
{
    struct wide wide;
    if (tree->record[node] == EXPLAIN_NONE)
        return REF_OK;
    tree->packed->layout->load(tree->packed, tree->record[node], &wide);
    return ref_fault(tree, node, &wide);
}

void explain_load(const struct explain_tree *tree, uint32_t repairs, uint32_t ref,
                  struct explain_node *out)
{
    struct wide *wide = &out->wide;
    tree->packed->layout->load(tree->packed, ref, wide);
    out->node = tree->node[ref];
    out->repairs = repairs;
    if (out->node != EXPLAIN_NONE && repairs != 0) {
        const struct bvh_node *node = &tree->bvh->node[out->node];
        enum ref_fault fault = ref_fault(tree, out->node, wide);
        uint32_t want[2];
        if ((fault == REF_TRUNCATED && repaired(repairs, REPAIR_REF_TRUNCATED)) ||
            (fault == REF_OTHER && repaired(repairs, REPAIR_REF))) {
            if (node->item_count > 0) {
                *wide = (struct wide){.item_first = EXPLAIN_NONE, .item_count = node->item_count};
            } else if (true_children(tree, out->node, want)) {
                *wide = (struct wide){.child_count = 2, .child = {want[0], want[1]}};
                for (int c = 0; c < 2; c++)
                    wide->box[c] = tree->packed->layout->box(tree->packed, want[c]);
            }
        } else if (node->item_count > wide->item_count && wide->child_count == 0 &&
                   repaired(repairs, REPAIR_ITEM_SLOT)) {
            wide->item_count = node->item_count;
        }
    }
    for (uint32_t c = 0; c < wide->child_count; c++)
        wide->box[c] = repaired_box(tree, repairs, wide->child[c], wide->box[c]);
}

uint32_t explain_item(const struct explain_tree *tree, const struct explain_node *leaf,
                      uint32_t slot)
{
    static const enum repair repair_of[] = {
        [ITEM_NOT_READ] = REPAIR_ITEM_SLOT,       [ITEM_SENTINEL] = REPAIR_ITEM_SENTINEL,
        [ITEM_TRUNCATED] = REPAIR_ITEM_TRUNCATED, [ITEM_SHIFTED] = REPAIR_ITEM_SHIFTED,
        [ITEM_OTHER] = REPAIR_ITEM_OTHER,
    };
    const struct bvh_node *node = leaf->node == EXPLAIN_NONE ? NULL : &tree->bvh->node[leaf->node];
    if (!node || slot >= node->item_count || leaf->repairs == 0) {
        if (leaf->wide.item_first == EXPLAIN_NONE)
            return ABI_NO_PRIM;
        return packed_item(tree->packed, &leaf->wide, slot);
    }
    uint32_t own = tree->bvh->prim[node->item_first + slot], stored;
    if (leaf->wide.item_first == EXPLAIN_NONE) /* the leaf itself was repaired */
        return own;
    enum item_fault fault = explain_item_fault(tree, leaf->node, slot, &stored);
    if (fault != ITEM_OK && repaired(leaf->repairs, repair_of[fault]))
        return own;
    return stored;
}
