/* What the layouts of wide nodes share: the collapse of the tree, the frame of a node's quantised
 * planes, and how references become records and child slots. */
#ifndef WIDE_NODES_H
#define WIDE_NODES_H

#include "ref/layouts/common.h"
#include "ref/tree/wide_tree.h"

/* A child slot of a record, decoded. */
struct wide_slot {
    bool there;
    uint32_t first; /* inner: its reference; leaf: its first item slot */
    uint32_t count; /* of items; 0: inner */
    struct box box;
};

/* Decodes all slots of a record, which is in range. Never reads outside the words. */
typedef void wide_decode(const struct packed *packed, uint32_t record, struct wide_slot *slot);

/* Collapses `bvh` for the layout `self`: nodes of self->width children and leaves of up to
 * `leaf_most` items. Errors: STATUS_LIMIT a vertex or bound that is not finite, or beyond
 * `largest` in magnitude; as wide_tree_make. */
enum status wide_nodes_collapse(const struct layout *self, const struct bvh *bvh,
                                const struct scene *scene, uint32_t leaf_most, float node_cost,
                                float largest, struct wide_tree *out,
                                struct reason *reason) MUST_USE;

/* Has the storage write the items of every leaf, in the order in which the nodes name them, so that
 * those of one node follow each other, and sets the `first` of each leaf to where. Errors:
 * STATUS_LIMIT a place is not below `places`; as store_put. */
enum status wide_nodes_items(const struct layout *self, const struct bvh *bvh,
                             const struct scene *scene, uint32_t places, struct wide_tree *tree,
                             struct packed *out, struct reason *reason) MUST_USE;

/* A format of nodes whose record r is reference r and whose child slot s is reference node_count +
 * width * r + s. What layout->family points to, or the first member of what it points to, where the
 * layout has the functions wide_form_*. A layout that has only _load and _box wants `decode`. */
struct wide_form {
    wide_decode *decode;
    uint32_t leaf_most; /* items of a leaf, at most */
    float node_cost;    /* in tests of a triangle, see struct wide_rule */
    float largest;      /* of bounds, in magnitude */
    uint32_t places;    /* items, and so nodes, lie at places below it */
    /* Writes the boxes of all slots, NULL: no child, and with them the node's frame, if it has one;
     * the record's other words stay. */
    void (*put_boxes)(const struct box *const box[WIDE_MAX], uint32_t *word);
    /* Writes what the slots hold into a record that has its boxes and is zero otherwise. */
    void (*put_children)(const struct wide_child *child, uint32_t count, uint32_t *word);
};

/* layout->pack: the tree collapsed to nodes of layout->width children. Errors: STATUS_LIMIT a
 * vertex or bound that is not finite, or beyond `largest`, or an item beyond `places`; as
 * wide_tree_make, layout_alloc and store_put. */
enum status wide_form_pack(const struct layout *self, const struct bvh *bvh,
                           const struct scene *scene, struct packed *out,
                           struct reason *reason) MUST_USE;

/* layout->load and box; a child whose reference is out of range is dropped. */
void wide_form_load(const struct packed *packed, uint32_t ref, struct wide *out);
struct box wide_form_box(const struct packed *packed, uint32_t ref);

/* layout->rebound. Errors: STATUS_LIMIT a bound beyond `largest`. */
enum status wide_form_rebound(struct packed *packed, uint32_t ref, const struct box *own,
                              const struct wide *node, struct reason *reason) MUST_USE;

/* layout->item of those that keep distances between items. */
uint32_t wide_nodes_item(const struct packed *packed, uint32_t slot);

/* The parts of wide_form_load and _box: children from the slots of a record, where references
 * below `inner_refs` are nodes and slot s is reference slot_ref + s if it is a leaf; and the union
 * of the boxes that are there. */
void wide_nodes_children(const struct packed *packed, const struct wide_slot *slot,
                         uint32_t inner_refs, uint32_t slot_ref, struct wide *out);
struct box wide_nodes_union(const struct packed *packed, const struct wide_slot *slot);

/* What a record is written from, both by pack() and by rebound(): a box for each slot, NULL if it
 * has no child. Of node `n` of a tree; of a packed node whose children's new boxes `node` has,
 * slots as in wide_nodes_children; and their union. */
void wide_nodes_tree_boxes(const struct wide_tree *tree, uint32_t n,
                           const struct box *box[WIDE_MAX]);
void wide_nodes_boxes(const struct packed *packed, const struct wide_slot *slot,
                      uint32_t inner_refs, const struct wide *node,
                      const struct box *box[WIDE_MAX]);
struct box wide_nodes_frame(const struct box *const box[WIDE_MAX]);

/* Planes of one axis of a node: plane q, 0 to `most`, lies at origin + q * 2^exponent. Every one is
 * exactly a float32, zero or at least 2^-100 in magnitude, so that no decoder rounds or flushes. */
struct node_axis {
    float origin;
    int exponent;
};

#define NODE_AXIS_LARGEST 0x1p100f /* of bounds, in magnitude */

/* The finest such axis whose planes reach from at most lo to at least hi. lo <= hi, both at most
 * NODE_AXIS_LARGEST in magnitude; `most` is 1 to 255. */
struct node_axis node_axis_make(float lo, float hi, uint32_t most);

/* Plane q; the last plane that is at most x, and the first that is at least x. */
float node_axis_plane(const struct node_axis *axis, uint32_t q);
uint32_t node_axis_down(const struct node_axis *axis, float x);
uint32_t node_axis_up(const struct node_axis *axis, float x);

#endif
