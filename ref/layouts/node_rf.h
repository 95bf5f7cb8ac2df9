/* Reading of 16-byte records, struct node_rf: rf16, and RTRS's as published. A leaf is two records;
 * the second has eight slots. */
#ifndef NODE_RF_H
#define NODE_RF_H

#include "ref/layouts/common.h"

#define NODE_RF_WORDS (sizeof(struct node_rf) / 4)
#define NODE_RF_LEAF  0x80000000u /* a bit of the tag */
#define NODE_RF_SLOTS 8u

static inline uint32_t node_rf_tag(const struct packed *packed, uint32_t ref)
{
    return packed->word[NODE_RF_WORDS * ref + 3];
}

/* Loads record `ref`: either a leaf of `count` items, whose slot / 8 is its second record, or a
 * node with the children `first` and `second`. */
static inline void node_rf_load(const struct packed *packed, uint32_t ref, uint32_t count,
                                uint32_t first, uint32_t second, struct wide *out)
{
    bool leaf = node_rf_tag(packed, ref) & NODE_RF_LEAF;
    out->child_count = 0;
    out->item_first = (ref + 1) * NODE_RF_SLOTS;
    out->item_count = leaf ? count : 0;
    if (leaf)
        return;
    layout_add_child(packed, first, out);
    layout_add_child(packed, second, out);
}

/* Writes the records of node `i` to `word`; before[n] is the number of leaves before node n. */
typedef void node_rf_write(const struct bvh *bvh, uint32_t i, const uint32_t *before,
                           uint32_t *word);

/* Allocates one record per inner node and two per leaf, and calls `write` for each node. Errors: as
 * layout_alloc. */
static inline enum status node_rf_pack(const char *layout, const struct bvh *bvh,
                                       const uint32_t *before, node_rf_write *write,
                                       struct packed *out, struct reason *reason)
{
    uint64_t records = (uint64_t)bvh->node_count + before[bvh->node_count];
    enum status status = layout_alloc(layout, records, NODE_RF_WORDS, 0, out, reason);
    for (uint32_t i = 0; i < bvh->node_count && !status; i++)
        write(bvh, i, before, out->word + NODE_RF_WORDS * (size_t)(i + before[i]));
    return status;
}

/* As layout.box. */
static inline struct box node_rf_box(const struct packed *packed, uint32_t ref)
{
    return layout_unpack_bounds(packed->word + NODE_RF_WORDS * ref);
}

#endif
